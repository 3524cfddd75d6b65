// One frame: paper, what stands, trails, goals, the scan, what moves, names, the chosen robot.

import { drawBeliefs, drawSeen } from "./beliefs.js";
import { inMetres, toPixels, toWorld } from "./camera.js";
import { cellImage } from "./cells.js";
import { GLYPHS, rgbOf, shade } from "./colors.js";
import { crowding, drawContacts, drawGoal, drawMover, drawName, drawState } from "./glyphs.js";
import { makeLayer, showLayer, showTrails } from "./layer.js";
import { ARRIVED, flagsAt, goalAt, hasLeft, isAbsent, isMover, poseAt, rowOfTime } from "./run.js";
import { scanAt } from "./scan.js";

const DENSE = 2.5; // pixels between points of a trail
const RECENT = 3; // seconds of a trail that stand out
const STEPS = [1, 2, 5];
const AHEAD = 500; // points of the way that is still to come

export function makeDrawing() {
  return { ground: makeLayer(), trails: makeLayer(), way: makeLayer(), image: null, scan: null };
}

/** Draw everything; `most` points of trails at a time. Returns whether all of them are there. */
export function drawFrame(context, drawing, run, shown, camera, colors, ratio, most) {
  const { at } = shown, row = Math.floor(at);
  let whole = true;
  const { width, height } = context.canvas;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = colors.outside;
  context.fillRect(0, 0, width, height);
  const key = `${colors.paper}${run.head.run_id}`;
  showLayer(drawing.ground, context, camera, ratio, key, (target, own) => {
    drawGround(target, drawing, run, own, colors, ratio);
  });
  if (shown.trails) {
    const faint = Math.max(0.14, 0.5 / (1 + run.movers.length / 25));
    const left = run.objects.filter((object) => hasLeft(run, object, at)).length; // without a trail from then on
    whole = showTrails(drawing.trails, context, camera, ratio, `${key} ${left}`, row, run.movers.length, faint, most,
      (target, own, from, to) => drawTrails(target, run, at, own, colors, ratio, from, to, 1.6));
    context.globalAlpha = 0.75;
    drawTrails(context, run, at, camera, colors, ratio, Math.floor(rowOfTime(run, run.time[row] - RECENT)), row, 2);
    context.globalAlpha = 1;
  }
  if (shown.robot >= 0 && !drawWay(context, drawing, run, shown, camera, colors, ratio, key, most)) whole = false;
  if (shown.goals) drawGoals(context, run, shown, camera, colors, ratio);
  if (shown.lidar && shown.robot >= 0) drawScans(context, drawing, run, shown, camera, colors, ratio);
  const present = run.movers.filter((object) => object.shape >= 0 && !isAbsent(run, object, at));
  for (const object of present) if (object.kind !== "robot") drawMover(context, run, object, at, camera, colors, ratio);
  for (const object of present) if (object.kind === "robot") drawMover(context, run, object, at, camera, colors, ratio);
  if (shown.belief) drawBeliefs(context, run, at, camera, colors, ratio);
  if (shown.belief && shown.robot >= 0) drawSeen(context, run, shown.robot, at, camera, colors, ratio);
  drawContacts(context, run, at, camera, colors, ratio);
  for (const object of present) drawState(context, run, object, at, object.index === shown.robot, camera, colors, ratio);
  if (shown.names) drawNames(context, run, at, shown.robot, camera, colors, ratio);
  drawScale(context, camera, colors, ratio);
  return whole;
}

function drawGround(context, drawing, run, camera, colors, ratio) {
  const [left, right, bottom, top] = run.head.world;
  inMetres(context, camera, ratio);
  context.fillStyle = colors.paper;
  context.fillRect(left, bottom, right - left, top - bottom);
  drawGrid(context, run.head.world, camera, colors);
  if (run.cells) {
    const { left: x, right: to, bottom: low, top: high } = run.cells, tone = colors.rock;
    if (drawing.image?.tone !== tone) drawing.image = { tone, canvas: cellImage(run.cells, rgbOf(tone)) };
    context.imageSmoothingEnabled = camera.scale * ratio * run.cells.dx < 1.5;
    context.save();
    context.translate(x, high);
    context.scale(1, -1);
    context.drawImage(drawing.image.canvas, 0, 0, to - x, high - low);
    context.restore();
  }
  drawZones(context, run, camera, colors);
  context.strokeStyle = colors.line;
  context.lineWidth = 1.5 / camera.scale;
  context.strokeRect(left, bottom, right - left, top - bottom);
  for (const object of run.objects) {
    if (!isMover(object) && object.shape >= 0 && !object.from) {
      paintShape(context, run, object, poseAt(run, object.index, 0), camera, ratio, shade(colors, object, "fill"), 1, object.shape >= 0 && run.head.shapes[object.shape].line ? colors.wall : shade(colors, object, "edge"), 1.2);
    }
  }
}

/** Lines and areas that are watched: areas pale with a dashed edge. */
function drawZones(context, { zones }, camera, colors) {
  const px = 1 / camera.scale;
  for (const { path, line, colors: own } of zones) {
    context.fillStyle = context.strokeStyle = own[colors.theme];
    context.lineWidth = (line ? 2.5 : 1) * px;
    if (!line) {
      context.globalAlpha = 0.09;
      context.fill(path, "evenodd");
      context.setLineDash([5 * px, 4 * px]);
    }
    context.globalAlpha = 0.85;
    context.stroke(path);
    context.setLineDash([]);
    context.globalAlpha = 1;
  }
}

/** Metres between two lines that are at least so many pixels apart. */
function spacing(camera, pixels) {
  const least = pixels / camera.scale, ten = 10 ** Math.floor(Math.log10(least));
  return ten * (STEPS.find((step) => step * ten >= least) ?? 10);
}

function drawGrid(context, [left, right, bottom, top], camera, colors) {
  const gap = spacing(camera, 44);
  context.beginPath();
  for (let x = Math.ceil(left / gap) * gap; x < right; x += gap) {
    context.moveTo(x, bottom);
    context.lineTo(x, top);
  }
  for (let y = Math.ceil(bottom / gap) * gap; y < top; y += gap) {
    context.moveTo(left, y);
    context.lineTo(right, y);
  }
  context.strokeStyle = colors.grid;
  context.lineWidth = 1 / camera.scale;
  context.stroke();
}

function paintShape(context, run, object, pose, camera, ratio, color, alpha, edge = color, width = 1) {
  const shape = run.head.shapes[object.shape], path = run.paths[object.shape];
  place(context, camera, ratio, pose);
  if (!shape.line) {
    context.globalAlpha = alpha * object.alpha;
    context.fillStyle = color;
    context.fill(path, "evenodd");
  }
  context.globalAlpha = Math.max(alpha, 0.5);
  context.strokeStyle = edge;
  context.lineWidth = (shape.line ? Math.max(width, 2) : width) / camera.scale;
  context.lineJoin = "round";
  context.stroke(path);
  context.globalAlpha = 1;
}

function place(context, camera, ratio, pose) {
  inMetres(context, camera, ratio);
  context.translate(pose.x, pose.y);
  context.rotate(pose.heading);
}

/** The trails between two rows, of all that have not left the world at the moment `at`. */
function drawTrails(context, run, at, camera, colors, ratio, from, to, width) {
  inMetres(context, camera, ratio);
  context.lineWidth = width / camera.scale;
  context.lineJoin = "round";
  context.lineCap = "round";
  let points = 0;
  for (const object of run.objects) {
    if (object.track < 0 || object.first >= to || hasLeft(run, object, at)) continue;
    context.beginPath();
    points += trace(context, run, object.track, Math.max(object.first, from), to, DENSE / camera.scale);
    context.strokeStyle = shade(colors, object, "edge");
    context.stroke();
  }
  return points;
}

/** A line through the rows of a track, without points that are closer together than can be seen; how many it has. */
function trace(context, run, track, from, to, dense, most = Infinity) {
  const base = track * run.stride, limit = dense * dense;
  let points = 0;
  let px = run.x[base + from], py = run.y[base + from];
  context.moveTo(px, py);
  for (let row = from + 1; row <= to; row++) {
    const x = run.x[base + row], y = run.y[base + row], dx = x - px, dy = y - py;
    if (row < to && dx * dx + dy * dy < limit) continue;
    context.lineTo(x, y);
    px = x;
    py = y;
    if (++points >= most) break;
  }
  return points;
}

/** The chosen robot's way: behind it in full, ahead of it dotted, as far as eyes can follow. */
function drawWay(context, drawing, run, shown, camera, colors, ratio, key, most) {
  const object = run.objects[shown.robot], row = Math.floor(shown.at);
  if (object.track < 0 || !shown.trails || isAbsent(run, object, shown.at)) return true;
  const color = shade(colors, object, "edge"), { way } = drawing;
  const whole = showTrails(way, context, camera, ratio, `${key} ${shown.robot}`, row, 1, 1, most, (target, own, from, to) => {
    inMetres(target, own, ratio);
    beginWay(target, color, 2.6 / own.scale);
    const points = object.first < to ? trace(target, run, object.track, Math.max(object.first, from), to, 1 / own.scale) : 0;
    target.stroke();
    return points;
  });
  inMetres(context, camera, ratio);
  beginWay(context, color, 2.6 / camera.scale);
  trace(context, run, object.track, row, row, 1);
  const pose = poseAt(run, shown.robot, shown.at);
  context.lineTo(pose.x, pose.y);
  context.stroke();
  beginWay(context, color, 2 / camera.scale);
  context.setLineDash([0.1 / camera.scale, 5 / camera.scale]);
  trace(context, run, object.track, row, run.rows - 1, 1 / camera.scale, AHEAD);
  context.stroke();
  context.setLineDash([]);
  return whole;
}

function beginWay(context, color, width) {
  context.strokeStyle = color;
  context.lineCap = "round";
  context.lineJoin = "round";
  context.lineWidth = width;
  context.beginPath();
}

function drawGoals(context, run, shown, camera, colors, ratio) {
  for (const object of run.objects) {
    if (!object.goal || object.shape < 0 || isAbsent(run, object, shown.at)) continue;
    const goal = goalAt(run, object.index, shown.at);
    if (!goal) continue;
    const picked = object.index === shown.robot, px = 1 / camera.scale;
    if (flagsAt(run, object.index, shown.at) & ARRIVED || (crowding(run) > 1 && !picked)) continue;
    drawGoal(context, run, object, goal, picked, camera, colors, ratio);
    if (!picked) continue;
    const pose = poseAt(run, object.index, shown.at);
    context.beginPath();
    context.moveTo(pose.x, pose.y);
    context.lineTo(goal.x, goal.y);
    context.setLineDash([2 * px, 6 * px]);
    context.strokeStyle = shade(colors, object, "edge");
    context.lineWidth = px;
    context.stroke();
    context.setLineDash([]);
  }
}

function drawScans(context, drawing, run, shown, camera, colors, ratio) {
  if (isAbsent(run, run.objects[shown.robot], shown.at)) return;
  const key = `${run.head.run_id} ${shown.robot} ${shown.at}`;
  if (drawing.scan?.key !== key) {
    drawing.scan = { key, all: (run.lidars.get(shown.robot) ?? []).map((lidar) => scanAt(run, lidar, shown.at)) };
  }
  inMetres(context, camera, ratio);
  const px = 1 / camera.scale, color = shade(colors, run.objects[shown.robot], "edge"), { glow, sizes } = GLYPHS;
  const [red, green, blue] = rgbOf(color), tint = (alpha) => `rgba(${red}, ${green}, ${blue}, ${alpha})`;
  for (const { x, y, ends, hit, whole, reach } of drawing.scan.all) {
    const area = context.createRadialGradient(x, y, 0, x, y, reach), most = glow[colors.theme];
    for (const [at, share] of [[0, 1], [1 - glow.soft, 1 - glow.fall * (1 - glow.soft)], [1, 0]]) area.addColorStop(at, tint(most * share));
    context.beginPath();
    if (!whole) context.moveTo(x, y);
    for (let i = 0; i < hit.length; i++) context.lineTo(ends[2 * i], ends[2 * i + 1]);
    context.fillStyle = area;
    context.fill();
    context.beginPath();
    const dot = (sizes.hit / 2) * px;
    for (let i = 0; i < hit.length; i++) {
      if (!hit[i]) continue;
      context.moveTo(ends[2 * i] + dot, ends[2 * i + 1]);
      context.arc(ends[2 * i], ends[2 * i + 1], dot, 0, 2 * Math.PI);
    }
    context.fillStyle = color;
    context.fill();
  }
}

function drawNames(context, run, at, picked, camera, colors, ratio) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "bottom";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = colors.paper;
  context.fillStyle = colors.ink;
  for (const { name, at: corner, colors: own } of run.zones) {
    const [x, y] = toPixels(camera, ...corner);
    context.fillStyle = own[colors.theme];
    context.strokeText(name, x, y - 2);
    context.fillText(name, x, y - 2);
  }
  for (const object of run.objects) {
    if (!isMover(object) || object.shape < 0 || isAbsent(run, object, at)) continue;
    if (object.role !== "robot" && object.index !== picked) continue;
    drawName(context, run, object, at, object.index === picked, camera, colors);
  }
}

function drawScale(context, camera, colors, ratio) {
  const metres = spacing(camera, 60), length = metres * camera.scale, x = 14, y = camera.height - 14;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = colors.card;
  context.globalAlpha = 0.8;
  context.fillRect(x - 6, y - 20, length + 12, 26);
  context.globalAlpha = 1;
  context.strokeStyle = context.fillStyle = colors.muted;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - 5);
  context.lineTo(x, y);
  context.lineTo(x + length, y);
  context.lineTo(x + length, y - 5);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "bottom";
  context.fillText(`${+metres.toPrecision(3)} m`, x + 5, y - 2);
}

/** Index of what is under a pixel, robots first, or -1. */
export function objectAt(context, run, at, camera, px, py) {
  const point = toWorld(camera, px, py), slack = 8 / camera.scale;
  let best = -1, nearest = Infinity;
  for (const object of run.objects) {
    if (object.shape < 0 || isAbsent(run, object, at)) continue;
    const pose = poseAt(run, object.index, at), dx = point.x - pose.x, dy = point.y - pose.y;
    const away = Math.hypot(dx, dy);
    const moves = object.track >= 0 || object.role === "robot";
    if (away > run.reach[object.shape] + slack) continue;
    if (!(moves && away < slack) && !inside(context, run, object, pose, dx, dy, slack)) continue;
    const rank = away + (moves ? 0 : 1e6) + (object.role === "robot" ? 0 : 1e3);
    if (rank < nearest) {
      nearest = rank;
      best = object.index;
    }
  }
  return best;
}

function inside(context, run, object, pose, dx, dy, slack) {
  const c = Math.cos(pose.heading), s = Math.sin(pose.heading), x = c * dx + s * dy, y = c * dy - s * dx;
  const path = run.paths[object.shape];
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.lineWidth = slack;
  return (!run.head.shapes[object.shape].line && context.isPointInPath(path, x, y, "evenodd")) || context.isPointInStroke(path, x, y);
}
