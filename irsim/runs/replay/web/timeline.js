// Events as marks over the scrubber: click one to go there.

import { $ } from "./dom.js";
import { isBetweenSteps } from "./run.js";
import { eventWords, ofRobot, seconds } from "./words.js";

const ROOMY = 7; // pixels per event
const INSET = 8, NEAR = 7; // pixels: half a thumb of the scrubber, and how close a click must be

const placeOf = (run, row, width) => INSET + ((width - 2 * INSET) * row) / Math.max(1, run.rows - 1);

export function drawMarks(run, colors, ratio) {
  const canvas = $("marks"), width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const order = { waypoint: 0, believed_arrival: 1, arrival: 2, contact_between_steps: 3, passed_through: 4, collision: 5 }, drawn = new Set();
  const crowded = run.events.length > width / ROOMY;
  for (const event of [...run.events].sort((a, b) => (order[a.kind] ?? 0) - (order[b.kind] ?? 0))) {
    const x = placeOf(run, event.row, width), y = height / 2 + 1, place = `${Math.round(x)} ${event.kind}`;
    if (drawn.has(place)) continue;
    drawn.add(place);
    context.globalAlpha = ofRobot(run, event) ? 1 : 0.45;
    context.beginPath();
    if (event.kind === "collision" || isBetweenSteps(event)) {
      context.fillStyle = context.strokeStyle = colors.danger;
      context.lineWidth = 1.5;
      if (crowded) context.rect(x - 0.75, y - 6, 1.5, 5);
      else for (const [dx, dy] of [[0, -6], [5, 0], [0, 6], [-5, 0]]) context.lineTo(x + dx, y + dy);
      if (!crowded && isBetweenSteps(event)) { // hollow: by default it counts as no collision
        context.closePath();
        context.stroke();
        continue;
      }
    } else {
      const believed = event.kind === "believed_arrival", arrival = believed || event.kind === "arrival";
      context.fillStyle = context.strokeStyle = arrival ? colors.good : colors.muted;
      context.lineWidth = 1.5;
      if (crowded) context.rect(x - 0.75, y + 1, 1.5, arrival ? 5 : 3);
      else context.arc(x, y, believed ? 3.25 : arrival ? 4 : 2, 0, 2 * Math.PI);
      if (!crowded && believed) { // hollow: only the robot takes it for an arrival
        context.stroke();
        continue;
      }
    }
    context.fill();
  }
}

/** The event under a pixel of the strip, or null. */
function eventNear(run, x, width) {
  let best = null, nearest = NEAR;
  for (const event of run.events) {
    const away = Math.abs(placeOf(run, event.row, width) - x) - (event.kind === "collision" || isBetweenSteps(event) ? 0.5 : 0);
    if (away < nearest) {
      nearest = away;
      best = event;
    }
  }
  return best;
}

export function listenToMarks(player, goToEvent, seek) {
  const canvas = $("marks");
  canvas.addEventListener("click", ({ offsetX }) => {
    const { run } = player;
    if (!run) return;
    const event = eventNear(run, offsetX, canvas.clientWidth);
    if (event) goToEvent(event);
    else seek(Math.round(((offsetX - INSET) / (canvas.clientWidth - 2 * INSET)) * (run.rows - 1)));
  });
  canvas.addEventListener("pointermove", ({ offsetX }) => {
    const event = player.run && eventNear(player.run, offsetX, canvas.clientWidth);
    canvas.title = event ? `${seconds(event.time)}: ${eventWords(player.run, event)}` : "";
  });
}
