// Signs of robots, people, goals and contacts. GLYPHS has their shapes, as pictures have them.

import { inMetres, toPixels } from "./camera.js";
import { GLYPHS, shade } from "./colors.js";
import { ARRIVED, COLLIDED, courseAt, flagsAt, isAbsent, isBetweenSteps, poseAt, STOPPED, waits } from "./run.js";
import { ofRobot } from "./words.js";

const DIAGONAL = Math.SQRT1_2;
const NAME_FONT = `bold ${GLYPHS.sizes.name}px system-ui, sans-serif`;

/** 0 for few robots, 1 for some, 2 for many. */
export const crowding = ({ robots }) => (robots.length > GLYPHS.crowd.few) + (robots.length > GLYPHS.crowd.many);

const boxes = new WeakMap();

/** Half length and half width of the shape of an object, its middle, and whether it is a disc around its position. */
function boxOf(run, object) {
  const shape = run.head.shapes[object.shape];
  if (!boxes.has(shape)) {
    const { circle, rings, line } = shape, flat = [...(rings ?? []), line ?? []].flat();
    const [xs, ys] = [0, 1].map((axis) => (circle ? [circle[axis] - circle[2], circle[axis] + circle[2]] : flat.filter((_, i) => i % 2 === axis)));
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const round = Boolean(circle) && Math.hypot(circle[0], circle[1]) < 1e-9;
    boxes.set(shape, { length: (right - left) / 2, width: (high - low) / 2, x: (left + right) / 2, y: (low + high) / 2, round });
  }
  return boxes.get(shape);
}

/** Radius [m] that an object has in the view, which may be larger than its own so that it is seen. */
function radiusOf(run, object, camera) {
  const { robot, person } = GLYPHS.sizes;
  const least = object.kind === "robot" ? robot * GLYPHS.smaller[crowding(run)] : object.kind === "person" ? person : 3;
  return Math.max(object.radius, least / camera.scale);
}

/** Outline of a body in its own frame as it is drawn, and how far it gets ahead. */
export function bodyPath(run, object, camera) {
  const box = boxOf(run, object);
  if (!box.round) return { path: run.paths[object.shape], reach: box.x + box.length };
  const path = new Path2D(), reach = radiusOf(run, object, camera);
  path.arc(0, 0, reach, 0, 2 * Math.PI);
  return { path, reach };
}

function polygon(context, points, size, x = 0, y = 0) {
  context.beginPath();
  for (const [px, py] of points) context.lineTo(x + px * size, y + py * size);
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

function stroke(context, camera, color, width) {
  context.strokeStyle = color;
  context.lineWidth = width / camera.scale;
  context.stroke();
}

function turned(context, camera, ratio, { x, y }, heading) {
  inMetres(context, camera, ratio);
  context.translate(x, y);
  context.rotate(heading);
  context.lineJoin = context.lineCap = "round";
}

/** What has become of a robot at a moment: arrived, collided, stopped, or nothing. */
function stateOf(run, object, at) {
  const flags = flagsAt(run, object.index, at);
  if (object.kind !== "robot") return "";
  if (flags & ARRIVED) return "arrived";
  if (!(flags & STOPPED)) return "";
  const hit = run.events.some(({ kind, row, object: one, partner }) => kind === "collision" && row <= at && [one, partner].includes(object.index));
  return hit ? "collided" : "stopped";
}

/** A body that moves: robots have a dart, people have head and shoulders. */
export function drawMover(context, run, object, at, camera, colors, ratio) {
  const pose = poseAt(run, object.index, at), radius = radiusOf(run, object, camera);
  const pale = (waits(run, object, at) ? 0.4 : 1) * object.alpha;
  context.globalAlpha = pale;
  if (object.kind === "person" && boxOf(run, object).round) {
    turned(context, camera, ratio, pose, courseAt(run, object.index, at, pose.heading));
    drawPerson(context, object, radius, camera, colors, pale);
  } else {
    const course = object.motion ? courseAt(run, object.index, at, pose.heading) : pose.heading;
    drawOutline(context, run, object, pose, course, radius, at, camera, colors, ratio, pale);
  }
  context.globalAlpha = 1;
}

function drawPerson(context, object, radius, camera, colors, pale) {
  const small = radius * camera.scale < GLYPHS.smallPerson, glyph = GLYPHS.people[small ? "small" : "large"];
  const fill = shade(colors, object, "fill"), head = colors["person-head"];
  if (!small) {
    disc(context, 0, 0, radius);
    context.fillStyle = fill;
    context.globalAlpha = pale * GLYPHS.footprint.fill;
    context.fill();
    context.globalAlpha = pale * GLYPHS.footprint.rim;
    stroke(context, camera, fill, GLYPHS.edges.person);
    context.globalAlpha = pale;
  }
  context.beginPath();
  context.ellipse(-glyph.behind * radius, 0, glyph.along * radius, glyph.across * radius, 0, 0, 2 * Math.PI);
  for (const [color, share] of [[head, 1], [fill, glyph.own]]) {
    context.globalAlpha = pale * share;
    context.fillStyle = color;
    context.fill();
  }
  context.globalAlpha = pale;
  stroke(context, camera, colors.paper, glyph.rims[0]);
  disc(context, glyph.ahead * radius, 0, glyph.head * radius);
  context.fillStyle = head;
  context.fill();
  stroke(context, camera, colors.paper, glyph.rims[1]);
}

function drawOutline(context, run, object, pose, course, radius, at, camera, colors, ratio, pale) {
  const box = boxOf(run, object), robot = object.kind === "robot", { edges } = GLYPHS;
  const round = box.round || radius > object.radius, { line } = run.head.shapes[object.shape];
  const arrived = stateOf(run, object, at) === "arrived", fill = shade(colors, object, "fill"), edge = shade(colors, object, "edge");
  turned(context, camera, ratio, pose, pose.heading);
  const path = round ? new Path2D() : run.paths[object.shape];
  if (round) path.arc(0, 0, radius, 0, 2 * Math.PI);
  const rim = (color, width) => {
    context.strokeStyle = color;
    context.lineWidth = width / camera.scale;
    context.stroke(path);
  };
  if (line && !round) {
    rim(fill, edges.line);
    return;
  }
  if (robot) rim(colors.paper, 2 * (round ? edges.round_halo : edges.other_halo) + edges.robot);
  for (const [color, share] of [[colors.paper, arrived ? 1 : 0], [fill, arrived ? GLYPHS.arrived : 1]]) {
    context.globalAlpha = pale * share;
    context.fillStyle = color;
    if (share) context.fill(path, "evenodd");
  }
  context.globalAlpha = pale;
  rim(robot ? edge : colors.paper, robot ? edges.robot : edges.person);
  if (!robot && !object.arrow) return;
  turned(context, camera, ratio, pose, course);
  const flat = round ? 1 : Math.min(1, box.length / box.width), size = round ? radius : box.width * flat;
  const { of_half_length: long, of_half_width: wide } = GLYPHS.longTip;
  const [[tip], ...back] = GLYPHS.dart, ahead = round ? tip : Math.min(long * box.length, wide * box.width) / box.width;
  polygon(context, [[ahead, 0], ...back], size, round ? 0 : box.x, round ? 0 : box.y);
  context.fillStyle = arrived ? edge : shade(colors, object, "dart");
  context.fill();
}

/** Middle and radius [m] of the circle around what is drawn of a body. */
function aroundOf(run, object, at, camera) {
  const pose = poseAt(run, object.index, at), box = boxOf(run, object), own = radiusOf(run, object, camera);
  const c = Math.cos(pose.heading), s = Math.sin(pose.heading);
  const rim = box.round || own > object.radius ? own : Math.hypot(box.length, box.width);
  return { x: pose.x + c * box.x - s * box.y, y: pose.y + s * box.x + c * box.y, rim };
}

/** Rings and badges on the rim of a robot, which is picked or not. */
export function drawState(context, run, object, at, picked, camera, colors, ratio) {
  const state = stateOf(run, object, at), u = 1 / camera.scale, { rings } = GLYPHS, { x, y, rim } = aroundOf(run, object, at, camera);
  inMetres(context, camera, ratio);
  const ring = ({ gap, width }, color) => {
    disc(context, x, y, rim + gap * u);
    stroke(context, camera, color, width);
  };
  if (picked) ring(rings.picked, colors.accent);
  if (flagsAt(run, object.index, at) & COLLIDED || state === "collided") ring(rings.collided, colors.danger);
  if (!state) return;
  const color = { arrived: colors.good, collided: colors.danger, stopped: colors.warn }[state];
  if (crowding(run) > 1) {
    ring(rings.crowded, color);
    return;
  }
  const r = GLYPHS.sizes.badge * u, cx = x + DIAGONAL * rim, cy = y + DIAGONAL * rim;
  disc(context, cx, cy, r);
  context.fillStyle = color;
  context.fill();
  stroke(context, camera, colors.paper, GLYPHS.rim);
  context.lineCap = context.lineJoin = "round";
  for (const points of GLYPHS.badges[state]) {
    polygon(context, points, r, cx, cy);
    stroke(context, camera, colors["on-accent"], GLYPHS.badgeLine * GLYPHS.sizes.badge);
  }
}

/** A goal: a ring with a dot; where there are many robots, an open dot. */
export function drawGoal(context, run, object, goal, picked, camera, colors, ratio) {
  const color = shade(colors, object, "edge"), [least, width] = GLYPHS.sizes.goal, box = boxOf(run, object);
  const open = crowding(run) > 0 && !picked, radius = open ? GLYPHS.goal.open / 2 / camera.scale : Math.max(Math.min(box.length, box.width), least / camera.scale);
  inMetres(context, camera, ratio);
  disc(context, goal.x, goal.y, radius);
  context.fillStyle = open ? colors.paper : color;
  context.globalAlpha = open ? 1 : GLYPHS.goal.fill;
  context.fill();
  context.globalAlpha = 1;
  stroke(context, camera, color, width);
  if (open) return;
  disc(context, goal.x, goal.y, GLYPHS.goal.dot * radius);
  context.fillStyle = color;
  context.fill();
}

/** Stars where robots have touched something so far, with their times while there are few; small ones of others. */
export function drawContacts(context, run, at, camera, colors, ratio) {
  const level = crowding(run), large = level > 1 ? GLYPHS.stars.crowded : GLYPHS.sizes.star;
  const so = run.events.filter((event) => event.row <= at + 1e-6 && (event.kind === "collision" || isBetweenSteps(event)));
  const own = so.filter((event) => ofRobot(run, event));
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.lineJoin = "round";
  for (const event of [...so.filter((event) => !own.includes(event)), ...own]) {
    const [x, y] = toPixels(camera, event.x, event.y), robot = own.includes(event);
    polygon(context, GLYPHS.star, robot ? large : Math.min(GLYPHS.stars.others, large), x, y);
    context.closePath();
    context.fillStyle = robot ? colors.danger : colors.muted;
    context.strokeStyle = colors.paper;
    context.lineWidth = 2 * GLYPHS.rim;
    context.stroke();
    context.fill();
    if (!robot || level > 1 || own.length > GLYPHS.crowd.timed) continue;
    write(context, `${event.time.toFixed(1)} s`, x, y + large + GLYPHS.name.gap, colors.danger, colors, "top");
  }
}

/** A bold text with a halo, in the middle of a place of the view. */
export function write(context, text, x, y, color, colors, baseline = "bottom", align = "center") {
  context.font = NAME_FONT;
  context.textAlign = align;
  context.textBaseline = baseline;
  context.lineJoin = "round";
  context.lineWidth = GLYPHS.name.halo;
  context.strokeStyle = colors.paper;
  context.strokeText(text, x, y);
  context.fillStyle = color;
  context.fillText(text, x, y);
  context.textAlign = "left";
}

/** Half the size of an object with its rings and its badge [px]. */
function extentOf(run, object, at, picked, camera) {
  const rim = aroundOf(run, object, at, camera).rim * camera.scale, { rings } = GLYPHS, badged = crowding(run) < 2 && stateOf(run, object, at);
  const ring = picked ? rings.picked : flagsAt(run, object.index, at) & COLLIDED ? rings.collided : { gap: 0, width: 0 };
  return Math.max(rim + ring.gap + ring.width / 2, badged ? DIAGONAL * rim + GLYPHS.sizes.badge : 0);
}

/** Name an object: above it, and a picked one beside it, on the side that has more room. */
export function drawName(context, run, object, at, picked, camera, colors) {
  const middle = aroundOf(run, object, at, camera), [x, y] = toPixels(camera, middle.x, middle.y);
  if (x < 0 || y < 0 || x > camera.width || y > camera.height) return;
  const away = extentOf(run, object, at, picked, camera) + GLYPHS.name.gap, color = shade(colors, object, "name");
  const text = crowding(run) > 0 && !picked ? object.name.replace(/^robot_(?=\d+$)/, "r") : object.name;
  if (!picked) {
    write(context, text, x, y - away, color, colors);
    return;
  }
  context.font = NAME_FONT;
  const length = context.measureText(text).width, half = GLYPHS.sizes.name / 2;
  const isFree = (side) => {
    const [from, to] = side > 0 ? [x + away, x + away + length] : [x - away - length, x - away];
    return from >= 0 && to <= camera.width && !run.movers.some((other) => {
      if (other === object || other.shape < 0 || isAbsent(run, other, at)) return false;
      const own = aroundOf(run, other, at, camera), [ox, oy] = toPixels(camera, own.x, own.y), reach = own.rim * camera.scale;
      return ox + reach > from && ox - reach < to && Math.abs(oy - y) < reach + half;
    });
  };
  const side = [1, -1].find(isFree) ?? (x + away + length <= camera.width ? 1 : -1);
  write(context, text, x + side * away, y, color, colors, "middle", side > 0 ? "left" : "right");
}
