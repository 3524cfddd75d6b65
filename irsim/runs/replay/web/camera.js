// From metres (y up) to pixels (y down): a scale and the point of the world in the middle.

const CLOSEST = 4000, BORDER = 26; // pixels per metre, pixels

export function makeCamera(world) {
  return { world, x: 0, y: 0, scale: 1, width: 1, height: 1, fitted: true };
}

export function fit(camera) {
  const [left, right, bottom, top] = camera.world;
  camera.x = (left + right) / 2;
  camera.y = (bottom + top) / 2;
  camera.scale = fittingScale(camera);
  camera.fitted = true;
}

function fittingScale({ world: [left, right, bottom, top], width, height }) {
  const room = (size) => Math.max(40, size - 2 * BORDER);
  return Math.min(room(width) / Math.max(right - left, 1e-3), room(height) / Math.max(top - bottom, 1e-3));
}

export function resize(camera, width, height) {
  camera.width = width;
  camera.height = height;
  if (camera.fitted) fit(camera);
}

/** Zoom by a factor, the point under pixel (px, py) staying where it is. */
export function zoom(camera, factor, px = camera.width / 2, py = camera.height / 2) {
  const before = toWorld(camera, px, py), least = fittingScale(camera) / 8;
  camera.scale = Math.min(CLOSEST, Math.max(least, camera.scale * factor));
  const after = toWorld(camera, px, py);
  camera.x += before.x - after.x;
  camera.y += before.y - after.y;
  camera.fitted = false;
}

export function pan(camera, dx, dy) {
  camera.x -= dx / camera.scale;
  camera.y += dy / camera.scale;
  camera.fitted = false;
}

export function centre(camera, x, y) {
  camera.x = x;
  camera.y = y;
  camera.fitted = false;
}

export function toWorld({ x, y, scale, width, height }, px, py) {
  return { x: x + (px - width / 2) / scale, y: y - (py - height / 2) / scale };
}

export function toPixels({ x, y, scale, width, height }, wx, wy) {
  return [width / 2 + (wx - x) * scale, height / 2 - (wy - y) * scale];
}

/** Let a context draw in metres. */
export function inMetres(context, { x, y, scale, width, height }, ratio) {
  const s = scale * ratio;
  context.setTransform(s, 0, 0, -s, ratio * (width / 2) - x * s, ratio * (height / 2) + y * s);
}
