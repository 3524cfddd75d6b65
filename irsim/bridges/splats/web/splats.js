// Splats on the graphics card: a texture with three texels each, and the order in which they are drawn.

import { compile, SPLAT_FRAGMENT, SPLAT_VERTEX } from "./programs.js";

const WIDTH = 2048;

// Center and color; xx, xy, xz, yy; yz, zz of the covariance.
function texels({ center, scale, rotation, color }, range, height) {
  const words = new Uint32Array(4 * WIDTH * height), floats = new Float32Array(words.buffer);
  const count = center.length / 3, [low, step] = range;
  for (let i = 0; i < count; i++) {
    const at = 12 * i;
    let [w, x, y, z] = [rotation[4 * i], rotation[4 * i + 1], rotation[4 * i + 2], rotation[4 * i + 3]];
    const length = Math.hypot(w, x, y, z) || 1;
    [w, x, y, z] = [w / length, x / length, y / length, z / length];
    const [a, b, c] = [0, 1, 2].map((k) => Math.exp(low + step * scale[3 * i + k]));
    const m = [
      a * (1 - 2 * (y * y + z * z)), b * 2 * (x * y - w * z), c * 2 * (x * z + w * y),
      a * 2 * (x * y + w * z), b * (1 - 2 * (x * x + z * z)), c * 2 * (y * z - w * x),
      a * 2 * (x * z - w * y), b * 2 * (y * z + w * x), c * (1 - 2 * (x * x + y * y)),
    ];
    const product = (r, s) => m[3 * r] * m[3 * s] + m[3 * r + 1] * m[3 * s + 1] + m[3 * r + 2] * m[3 * s + 2];
    floats.set(center.subarray(3 * i, 3 * i + 3), at);
    words[at + 3] = color[4 * i] | (color[4 * i + 1] << 8) | (color[4 * i + 2] << 16) | (color[4 * i + 3] << 24);
    floats.set([product(0, 0), product(0, 1), product(0, 2), product(1, 1), product(1, 2), product(2, 2)], at + 4);
  }
  return words;
}

export function splatLayer(gl, columns, range) {
  const count = columns.center.length / 3, height = Math.max(1, Math.ceil((3 * count) / WIDTH));
  if (height > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("there are too many splats for this device");
  const names = ["data", "view", "size", "focal", "near", "far", "hidden", "cut"];
  const { program, at } = compile(gl, SPLAT_VERTEX, SPLAT_FRAGMENT, names);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32UI, WIDTH, height, 0, gl.RGBA_INTEGER, gl.UNSIGNED_INT,
    texels(columns, range, height));
  const list = gl.createVertexArray(), buffer = gl.createBuffer();
  gl.bindVertexArray(list);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 0);
  gl.vertexAttribDivisor(0, 1);
  let drawn = 0;
  return {
    order(indices) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, indices, gl.DYNAMIC_DRAW);
      drawn = indices.length;
    },
    draw({ view, focal, width, height: rows, near, far, hidden, cut }) {
      gl.useProgram(program);
      gl.bindVertexArray(list);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(at.data, 0);
      gl.uniformMatrix4fv(at.view, false, view);
      gl.uniform2f(at.size, width, rows);
      gl.uniform1f(at.focal, focal);
      gl.uniform1f(at.near, near);
      gl.uniform1f(at.far, far);
      gl.uniform1f(at.hidden, hidden);
      gl.uniform1f(at.cut, cut);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, drawn);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
    },
  };
}
