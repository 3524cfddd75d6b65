// Scans of one robot: as recorded, or computed here by casting beams against the shapes that are drawn.

import { castCells } from "./cells.js";
import { isAbsent, poseAt } from "./run.js";

const ROW_PARTS = 1000; // as in data.py

/** { x, y, ends: Float32Array [x, y, …], hit: Uint8Array, recorded } of a lidar at a moment. */
export function scanAt(run, lidar, at) {
  const moment = lidar.ranges ? Math.floor(at) : at, measured = lidar.measured?.[moment] ?? -1;
  // Data that came late were seen from where the robot was then.
  const pose = poseAt(run, lidar.object, measured < 0 ? moment : measured / ROW_PARTS), [px, py, turn] = lidar.pose;
  const c = Math.cos(pose.heading), s = Math.sin(pose.heading);
  const x = pose.x + c * px - s * py, y = pose.y + s * px + c * py, heading = pose.heading + turn;
  const ends = new Float32Array(2 * lidar.beams), hit = new Uint8Array(lidar.beams);
  const near = lidar.ranges ? null : nearby(run, lidar, moment, x, y);
  for (let beam = 0; beam < lidar.beams; beam++) {
    const angle = heading + lidar.first + beam * lidar.between, dx = Math.cos(angle), dy = Math.sin(angle);
    const range = near ? cast(run, near, x, y, dx, dy, lidar.range_max) : recorded(run, lidar, beam, moment);
    hit[beam] = range < lidar.range_max && range >= lidar.range_min;
    const length = Math.min(range, lidar.range_max);
    ends[2 * beam] = x + length * dx;
    ends[2 * beam + 1] = y + length * dy;
  }
  const whole = Math.abs(lidar.between) * lidar.beams > 2 * Math.PI - 0.1;
  return { x, y, ends, hit, whole, reach: lidar.range_max, recorded: !near };
}

function recorded(run, lidar, beam, row) {
  return lidar.ranges[beam * run.rows + row] * lidar.quantum;
}

/** What a beam of this lidar can meet, in place. */
function nearby(run, lidar, at, x, y) {
  const found = [];
  run.objects.forEach((object, index) => {
    if (index === lidar.object || !object.seen || object.shape < 0 || isAbsent(run, object, at)) return;
    const pose = poseAt(run, index, at, {});
    const radius = run.reach[object.shape], reach = lidar.range_max + radius;
    if ((pose.x - x) ** 2 + (pose.y - y) ** 2 <= reach * reach) {
      const c = Math.cos(pose.heading), s = Math.sin(pose.heading);
      found.push({ shape: run.head.shapes[object.shape], x: pose.x, y: pose.y, c, s, radius });
    }
  });
  return found;
}

function cast(run, near, x, y, dx, dy, reach) {
  let best = run.cells ? castCells(run.cells, x, y, dx, dy, reach) : reach;
  for (const { shape, x: cx, y: cy, c, s, radius } of near) {
    const rx = cx - x, ry = cy - y, along = rx * dx + ry * dy, aside = rx * dy - ry * dx;
    if (Math.abs(aside) > radius || along < -radius || along - radius > best) continue;
    // In the frame of the object.
    const ox = -(c * rx + s * ry), oy = s * rx - c * ry, ux = c * dx + s * dy, uy = c * dy - s * dx;
    best = Math.min(best, castShape(shape, ox, oy, ux, uy));
  }
  return best;
}

function castShape({ circle, rings, line }, ox, oy, ux, uy) {
  if (circle) return castCircle(circle, ox, oy, ux, uy);
  let best = Infinity;
  for (const ring of rings ?? []) best = Math.min(best, castLine(ring, true, ox, oy, ux, uy));
  return line ? Math.min(best, castLine(line, false, ox, oy, ux, uy)) : best;
}

function castCircle([cx, cy, radius], ox, oy, ux, uy) {
  const rx = cx - ox, ry = cy - oy, along = rx * ux + ry * uy, aside = rx * uy - ry * ux;
  const half = radius * radius - aside * aside;
  if (half < 0) return Infinity;
  const first = along - Math.sqrt(half), second = along + Math.sqrt(half);
  return first >= 0 ? first : second >= 0 ? second : Infinity;
}

function castLine(flat, closed, ox, oy, ux, uy) {
  let best = Infinity;
  const count = flat.length / 2;
  for (let i = closed ? 0 : 1; i < count; i++) {
    const j = i ? i - 1 : count - 1, ax = flat[2 * j] - ox, ay = flat[2 * j + 1] - oy;
    const ex = flat[2 * i] - flat[2 * j], ey = flat[2 * i + 1] - flat[2 * j + 1], cross = ux * ey - uy * ex;
    if (Math.abs(cross) < 1e-12) continue;
    const along = (ax * ey - ay * ex) / cross, part = (ax * uy - ay * ux) / cross;
    if (along >= 0 && part >= 0 && part <= 1 && along < best) best = along;
  }
  return best;
}
