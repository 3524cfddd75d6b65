// What robots believe: where they take themselves to be, and what the detectors of the chosen one report.

import { inMetres } from "./camera.js";
import { GLYPHS, shade } from "./colors.js";
import { bodyPath } from "./glyphs.js";
import { beliefAt, isAbsent, poseAt, seenAt } from "./run.js";

const APART = 2; // pixels from which on a line joins both poses
const DASHES = [4, 3], RING_DASHES = [2.5, 2], RING = 5; // pixels

/** Whether a run has beliefs or tracks to show. */
export const hasBeliefs = (run) => run.detectors.length > 0 || run.objects.some(({ belief }) => belief >= 0);

/** Dashed outlines where robots believe to be, joined to where they are. */
export function drawBeliefs(context, run, at, camera, colors, ratio) {
  const px = 1 / camera.scale;
  for (const object of run.objects) {
    if (object.belief < 0 || object.shape < 0 || isAbsent(run, object, at)) continue;
    const pose = poseAt(run, object.index, at), belief = beliefAt(run, object.index, at), { path, reach } = bodyPath(run, object, camera);
    inMetres(context, camera, ratio);
    context.strokeStyle = shade(colors, object, "edge");
    context.lineWidth = px;
    if (Math.hypot(belief.x - pose.x, belief.y - pose.y) > APART * px) {
      context.beginPath();
      context.moveTo(pose.x, pose.y);
      context.lineTo(belief.x, belief.y);
      context.stroke();
    }
    context.translate(belief.x, belief.y);
    context.rotate(belief.heading);
    context.lineWidth = 1.4 * px;
    context.setLineDash(DASHES.map((length) => length * px));
    context.stroke(path);
    context.setLineDash([]);
    context.beginPath(); // where it believes to look
    context.moveTo(reach / 2, 0);
    context.lineTo(reach, 0);
    context.stroke();
  }
}

/** Rings where the detectors of a robot see others from where it is; dashed ones follow nothing. */
export function drawSeen(context, run, robot, at, camera, colors, ratio) {
  const object = run.objects[robot], px = 1 / camera.scale;
  if (isAbsent(run, object, at)) return;
  const pose = poseAt(run, robot, Math.floor(at)), c = Math.cos(pose.heading), s = Math.sin(pose.heading);
  inMetres(context, camera, ratio);
  for (const { x, y, object: followed } of seenAt(run, robot, at)) {
    context.beginPath();
    context.arc(pose.x + c * x - s * y, pose.y + s * x + c * y, RING * px, 0, 2 * Math.PI);
    for (const [color, width] of [[colors.paper, 1.5 + 2 * GLYPHS.rim], [shade(colors, object, "edge"), 1.5]]) {
      context.setLineDash(followed < 0 ? RING_DASHES.map((length) => length * px) : []);
      context.strokeStyle = color;
      context.lineWidth = width * px;
      context.stroke();
    }
  }
  context.setLineDash([]);
}
