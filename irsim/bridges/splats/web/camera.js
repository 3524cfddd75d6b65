// Where the eye is: turned by hand around a target, behind a robot, or on it.

import { lookAt } from "./math.js";

export function orbit(canvas, start, changed) {
  const state = { target: [...start.target], distance: start.distance, azimuth: start.azimuth, elevation: start.elevation };
  const fingers = new Map();
  function move(dx, dy, shift) {
    if (!shift) {
      state.azimuth -= dx * 0.006;
      state.elevation = Math.min(1.57, Math.max(-0.3, state.elevation + dy * 0.006));
    } else {
      const by = (state.distance / canvas.clientHeight) * 1.2, [c, s] = [Math.cos(state.azimuth), Math.sin(state.azimuth)];
      state.target[0] += (dx * s - dy * c) * by;
      state.target[1] += (-dx * c - dy * s) * by;
    }
    changed();
  }
  const zoom = (factor) => {
    state.distance = Math.min(500, Math.max(0.2, state.distance * factor));
    changed();
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (fingers.size === 2) {
      const [other] = [...fingers.entries()].filter(([id]) => id !== event.pointerId).map(([, value]) => value);
      const apart = (a) => Math.hypot(a.clientX - other.clientX, a.clientY - other.clientY) || 1;
      zoom(apart(before) / apart(event));
      move(dx / 2, dy / 2, true);
    } else move(dx, dy, event.shiftKey || event.buttons === 2);
    fingers.set(event.pointerId, event);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(event.deltaY * 0.001));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] }[event.key];
    if (step) move(...step, event.shiftKey);
    else if (event.key === "+") zoom(0.9);
    else if (event.key === "-") zoom(1 / 0.9);
    else return;
    event.preventDefault();
  });
  return state;
}

export function freeView({ target, distance, azimuth, elevation }) {
  const [c, s] = [Math.cos(elevation), Math.sin(elevation)];
  return lookAt([
    target[0] - distance * c * Math.cos(azimuth), target[1] - distance * c * Math.sin(azimuth), target[2] + distance * s,
  ], target);
}

export function carriedView([x, y, yaw], kind, height) {
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  if (kind === "robot") return lookAt([x, y, height], [x + c, y + s, height]);
  return lookAt([x - 2.5 * c, y - 2.5 * s, height + 1.2], [x + c, y + s, 0.4]);
}
