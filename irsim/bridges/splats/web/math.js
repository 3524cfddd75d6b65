// Matrices as columns one after the other, as WebGL takes them. The world is that of irsim: x, y on the ground, z up.

export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export function unitVector(a) {
  const length = Math.hypot(...a) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
}

// World to camera: the camera looks along -z, x is to its right and y up.
export function lookAt(eye, target) {
  const back = unitVector(subtract(eye, target));
  const level = Math.abs(back[2]) > 0.9999 ? [0, 1, 0] : [0, 0, 1];
  const right = unitVector(cross(level, back));
  const up = cross(back, right);
  return new Float32Array([
    right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
  ]);
}

export function perspective(focal, width, height, near, far) {
  return new Float32Array([
    (2 * focal) / width, 0, 0, 0, 0, (2 * focal) / height, 0, 0,
    0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
  ]);
}
