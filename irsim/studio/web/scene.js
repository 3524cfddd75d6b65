// Objects under the pointer: choose, drag, rotate, drag their goals; the scene follows, and the text on release.

import { toPixels, toWorld } from "./camera.js";
import { $ } from "./dom.js";
import { makeDrawing, objectAt } from "./draw.js";
import { actions, player } from "./player.js";
import { goalAt, poseAt } from "./run.js";

const SNAP = 0.05, TURN = Math.PI / 12, NEAR = 11; // metres, radians, pixels
const HANDLE = 26; // pixels from the edge of a body to the handle that turns it
const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const round = (value, digits = 2) => Number(value.toFixed(digits));

export const scene = { places: [], chosen: -1, drag: null };

/** Where the handle is that turns the chosen object, in pixels; null if there is none. */
function handle() {
  const { run, camera, shown } = player, place = scene.places[scene.chosen];
  if (!run || shown.at !== 0 || !place?.pose) return null;
  const { x, y, heading } = poseAt(run, scene.chosen, 0), reach = run.reach[run.objects[scene.chosen].shape] ?? 0;
  const [px, py] = toPixels(camera, x, y), away = reach * camera.scale + HANDLE;
  return [px + away * Math.cos(heading), py - away * Math.sin(heading), px, py];
}

/** Draw the handle of the chosen object on top of a frame. */
export function drawChosen(context, ratio) {
  const at = handle();
  if (!at) return;
  const [x, y, px, py] = at;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.strokeStyle = context.fillStyle = player.colors.accent ?? player.colors.ink;
  context.lineWidth = 1.5;
  context.setLineDash([3, 3]);
  context.beginPath();
  context.moveTo(px, py);
  context.lineTo(x, y);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(x, y, 5, 0, 2 * Math.PI);
  context.fill();
}

/** What can be dragged at a pixel: { kind, index, … } or null. */
function under(px, py) {
  const { run, camera, shown } = player;
  if (!run || shown.at !== 0) return null;
  const turn = handle();
  if (turn && Math.hypot(turn[0] - px, turn[1] - py) < NEAR) return { kind: "turn", index: scene.chosen };
  const index = objectAt($("view").getContext("2d"), run, 0, camera, px, py);
  if (index >= 0) return { kind: "move", index };
  for (const object of run.objects) {
    const goal = scene.places[object.index]?.goals?.length ? goalAt(run, object.index, 0) : null;
    if (!goal) continue;
    const [x, y] = toPixels(camera, goal.x, goal.y);
    if (Math.hypot(x - px, y - py) < NEAR) return { kind: "goal", index: object.index, goal: { ...goal } };
  }
  return null;
}

function moveTo(index, x, y, heading) {
  const { run } = player, { track } = run.objects[index];
  if (track >= 0) {
    const i = track * run.stride;
    [run.x[i], run.y[i], run.heading[i]] = [x, y, heading];
  } else {
    run.objects[index].pose = [x, y, heading];
    player.drawing = makeDrawing();
  }
  actions.refresh();
}

/** Listen to the pointer before the player does; `edit(edits)` writes into the text, `picked(index)` says what is chosen. */
export function listenToScene({ edit, picked, refuse, remove, duplicate }) {
  const view = $("view");

  view.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const target = under(event.offsetX, event.offsetY);
    if (!target) return;
    event.stopImmediatePropagation();
    view.setPointerCapture(event.pointerId);
    view.focus();
    choose(target.index);
    const start = toWorld(player.camera, event.offsetX, event.offsetY);
    scene.drag = { ...target, start, pose: poseAt(player.run, target.index, 0), moved: false, at: [event.offsetX, event.offsetY] };
  }, true);

  view.addEventListener("pointermove", (event) => {
    const { drag } = scene;
    if (!drag) {
      view.classList.toggle("movable", Boolean(event.buttons === 0 && under(event.offsetX, event.offsetY)));
      return;
    }
    event.stopImmediatePropagation();
    if (!drag.moved && Math.hypot(event.offsetX - drag.at[0], event.offsetY - drag.at[1]) < 4) return;
    const place = scene.places[drag.index];
    if (!place?.pose) {
      refuse(drag.index, place?.why ?? "it is not written in the text");
      scene.drag = null;
      return;
    }
    drag.moved = true;
    const now = toWorld(player.camera, event.offsetX, event.offsetY), grid = event.ctrlKey ? 0.01 : SNAP;
    const snapped = (value) => round(Math.round(value / grid) * grid);
    const { x, y, heading } = drag.pose;
    if (drag.kind === "goal") {
      drag.to = [snapped(drag.goal.x + now.x - drag.start.x), snapped(drag.goal.y + now.y - drag.start.y)];
      moveGoal(drag);
    } else if (drag.kind === "turn") {
      const free = Math.atan2(now.y - y, now.x - x);
      drag.to = [x, y, round(event.shiftKey ? Math.round(free / TURN) * TURN : free)];
      moveTo(drag.index, ...drag.to);
    } else {
      drag.to = [snapped(x + now.x - drag.start.x), snapped(y + now.y - drag.start.y), heading];
      moveTo(drag.index, ...drag.to);
    }
  }, true);

  for (const kind of ["pointerup", "pointercancel"]) {
    view.addEventListener(kind, (event) => {
      const { drag } = scene;
      if (!drag) return;
      event.stopImmediatePropagation();
      scene.drag = null;
      if (!drag.moved || !drag.to) return;
      if (kind === "pointercancel") moveTo(drag.index, drag.pose.x, drag.pose.y, drag.pose.heading);
      else edit([change(drag)]);
    }, true);
  }

  document.addEventListener("keydown", (event) => {
    const { drag } = scene;
    if (event.key === "Escape" && drag) {
      scene.drag = null;
      moveTo(drag.index, drag.pose.x, drag.pose.y, drag.pose.heading);
      event.preventDefault();
      event.stopImmediatePropagation();
    }
  }, true);

  view.addEventListener("keydown", (event) => {
    const place = scene.places[scene.chosen], way = WAYS[event.key], { ctrlKey, metaKey, altKey, shiftKey } = event;
    if (!place || player.run.rows > 1 || altKey) return;
    const control = ctrlKey || metaKey;
    if (!control && (event.key === "Delete" || event.key === "Backspace")) remove();
    else if (control && event.key.toLowerCase() === "d") duplicate();
    else if (!control && way && place.pose) nudge(way, (shiftKey ? 10 : 1) * SNAP);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  function nudge([right, up], by) {
    const { x, y, heading } = poseAt(player.run, scene.chosen, 0), to = [round(x + right * by), round(y + up * by)];
    moveTo(scene.chosen, ...to, heading);
    edit([{ action: "numbers", path: scene.places[scene.chosen].pose, value: to }]);
  }

  function choose(index) {
    scene.chosen = index;
    actions.choose(index);
    picked(index);
  }
}

function moveGoal({ index, to }) {
  const { run } = player, goal = goalAt(run, index, 0);
  [goal.x, goal.y] = to;
  actions.refresh();
}

function change({ kind, index, to, goal }) {
  const place = scene.places[index];
  if (kind !== "goal") return { action: "numbers", path: place.pose, value: kind === "turn" ? to : to.slice(0, 2) };
  return { action: "numbers", path: place.goals[0], value: to };
}
