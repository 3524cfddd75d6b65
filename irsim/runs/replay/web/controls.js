// Buttons, keys, pointer.

import { fit, pan, zoom } from "./camera.js";
import { $, element, setTerms } from "./dom.js";
import { objectAt } from "./draw.js";
import { unfold } from "./panel.js";
import { listenToMarks } from "./timeline.js";
import { valuesOf } from "./words.js";

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];
const SWITCHES = { f: "follow", l: "lidar", t: "trails", g: "goals", n: "names", b: "belief" };
const ZOOM = 1.3, CLICK = 4; // pixels a click may move
const MANY = 10; // steps
const TYPING = "select, textarea, [contenteditable], input:not([type=range])"; // where keys mean something else

/** Have a speed in the list, in its place. */
export function offerSpeed(speed) {
  const options = [...$("speed").options];
  if (options.some(({ value }) => Number(value) === speed)) return;
  const after = options.find(({ value }) => Number(value) > speed) ?? null;
  $("speed").add(element("option", { value: speed, textContent: `${speed}×` }), after);
}

export function listen(player, actions) {
  const { seek, toggle, goToEvent, flip, choose, setSpeed, theme, refresh } = actions;
  SPEEDS.forEach(offerSpeed);
  $("play").addEventListener("click", toggle);
  $("back").addEventListener("click", () => seek(Math.ceil(player.shown.at) - 1));
  $("ahead").addEventListener("click", () => seek(Math.floor(player.shown.at) + 1));
  $("time").addEventListener("input", () => seek(Number($("time").value)));
  $("speed").addEventListener("change", () => setSpeed(Number($("speed").value)));
  $("robot").addEventListener("change", () => choose(Number($("robot").value)));
  for (const name of Object.values(SWITCHES)) $(name).addEventListener("click", () => flip(name));
  $("more").addEventListener("click", () => unfold($("more").getAttribute("aria-expanded") !== "true"));
  $("theme").addEventListener("click", theme);
  $("help").addEventListener("click", () => $("keys").showModal());
  $("closer").addEventListener("click", () => zoomed(ZOOM));
  $("farther").addEventListener("click", () => zoomed(1 / ZOOM));
  $("fit").addEventListener("click", whole);
  listenToMarks(player, goToEvent, seek);
  document.addEventListener("keydown", onKey);
  listenToPointer(player, actions);

  function zoomed(factor) {
    zoom(player.camera, factor);
    refresh();
  }

  function whole() {
    player.shown.follow = false;
    fit(player.camera);
    refresh();
  }

  function onKey(event) {
    const { key, target } = event;
    if (!player.run || event.ctrlKey || event.altKey || event.metaKey || $("keys").open || target.closest?.(TYPING)) return;
    if (key === " " && target.tagName === "BUTTON") return;
    const many = event.shiftKey ? MANY : 1, { at } = player.shown, low = key.toLowerCase();
    const done = {
      " ": toggle,
      ArrowRight: () => seek(Math.floor(at + 1e-6) + many),
      ArrowLeft: () => seek(Math.ceil(at - 1e-6) - many),
      Home: () => seek(0),
      End: () => seek(player.run.rows - 1),
      "[": () => beside(-1),
      "]": () => beside(1),
      ",": () => faster(-1),
      ".": () => faster(1),
      "+": () => zoomed(ZOOM),
      "=": () => zoomed(ZOOM),
      "-": () => zoomed(1 / ZOOM),
      0: whole,
      d: theme,
      r: () => nextRobot(event.shiftKey ? -1 : 1),
      "?": () => $("keys").showModal(),
    }[key.length === 1 ? low : key] ?? (SWITCHES[low] && (() => flip(SWITCHES[low])));
    if (!done) return;
    event.preventDefault();
    done();
  }

  function beside(way) {
    const { events } = player.run, { at } = player.shown;
    const found = way > 0 ? events.find((e) => e.row > at + 1e-6) : events.findLast((e) => e.row < at - 1e-6);
    if (found) goToEvent(found);
  }

  function faster(way) {
    const { speed: now } = player.shown;
    const next = way > 0 ? SPEEDS.find((speed) => speed > now) : SPEEDS.findLast((speed) => speed < now);
    if (next) setSpeed(next);
  }

  function nextRobot(way) {
    const { robots } = player.run, { robot } = player.shown;
    if (!robots.length) return;
    const place = robots.indexOf(robot);
    choose(robots[place < 0 ? 0 : (place + way + robots.length) % robots.length]);
  }

}

function listenToPointer(player, { choose, refresh }) {
  const view = $("view"), held = new Map();
  let travelled = 0, spread = 0;

  view.addEventListener("pointerdown", (event) => {
    view.setPointerCapture(event.pointerId);
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
    travelled = 0;
    spread = spreadOf();
    view.classList.add("dragging");
  });
  view.addEventListener("pointermove", (event) => {
    if (!player.run) return;
    const before = held.get(event.pointerId);
    if (!before) {
      player.pointer = [event.offsetX, event.offsetY];
      showTip(player);
      return;
    }
    const dx = event.offsetX - before[0], dy = event.offsetY - before[1];
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
    travelled += Math.abs(dx) + Math.abs(dy);
    if (travelled < CLICK) return;
    player.pointer = null;
    if (held.size === 2) {
      const now = spreadOf(), points = [...held.values()];
      zoom(player.camera, now / spread, (points[0][0] + points[1][0]) / 2, (points[0][1] + points[1][1]) / 2);
      spread = now;
    } else {
      player.shown.follow = false;
      pan(player.camera, dx, dy);
    }
    refresh();
  });
  for (const kind of ["pointerup", "pointercancel"]) {
    view.addEventListener(kind, (event) => {
      held.delete(event.pointerId);
      spread = spreadOf();
      view.classList.toggle("dragging", held.size > 0);
      if (kind === "pointerup" && travelled < CLICK && player.run) choose(under(player, event.offsetX, event.offsetY, true));
    });
  }
  view.addEventListener("pointerleave", () => {
    player.pointer = null;
    showTip(player);
  });
  view.addEventListener("wheel", (event) => {
    if (!player.run) return;
    event.preventDefault();
    zoom(player.camera, Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event.offsetX, event.offsetY);
    refresh();
  }, { passive: false });

  function spreadOf() {
    const [a, b] = [...held.values()];
    return b ? Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1])) : 0;
  }
}

function under(player, x, y, moving = false) {
  const found = objectAt($("view").getContext("2d"), player.run, player.shown.at, player.camera, x, y);
  const object = player.run.objects[found];
  return moving && object && object.track < 0 && object.role !== "robot" ? -1 : found;
}

/** Values of what is under the pointer. */
export function showTip(player) {
  const tip = $("tip"), { pointer, run } = player;
  const found = run && pointer ? under(player, ...pointer) : -1;
  $("view").classList.toggle("over", found >= 0);
  tip.hidden = found < 0;
  if (found < 0) return;
  if (!tip.firstChild) tip.append(element("strong"), element("dl"));
  tip.firstChild.textContent = run.objects[found].name;
  setTerms(tip.lastChild, valuesOf(run, found, player.shown.at));
  const [x, y] = pointer, { width, height } = player.camera;
  const left = x + 16 + tip.offsetWidth > width ? x - 12 - tip.offsetWidth : x + 16;
  const top = y + 16 + tip.offsetHeight > height ? y - 12 - tip.offsetHeight : y + 16;
  tip.style.transform = `translate(${Math.max(2, left)}px, ${Math.max(2, top)}px)`;
}
