// Marks of contacts that begin and end within one step.

import { toPixels } from "./camera.js";
import { isBetweenSteps, timeOfRow } from "./run.js";

const SHOWN = 3; // seconds for which a mark stays

/** Places of the latest contacts within a step. */
export function drawContacts(context, run, at, camera, colors, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.lineJoin = "miter";
  for (const event of run.events) {
    if (event.row > at + 1e-6) break;
    if (!isBetweenSteps(event) || timeOfRow(run, at) - event.time > SHOWN) continue;
    const [x, y] = toPixels(camera, event.x, event.y);
    context.beginPath();
    for (const [dx, dy] of [[0, -8], [7, 0], [0, 8], [-7, 0]]) context.lineTo(x + dx, y + dy);
    context.closePath();
    for (const [color, width] of [[colors.paper, 4], [colors.danger, 2]]) {
      context.strokeStyle = color;
      context.lineWidth = width;
      context.stroke();
    }
  }
}
