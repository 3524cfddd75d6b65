// Paths as tubes, and objects as prisms over their footprints.

import { compile, SOLID_FRAGMENT, SOLID_VERTEX } from "./programs.js";
import { cross, subtract, unitVector } from "./math.js";

const SIDES = 8;

// Corners with their normals, three for each triangle.
export function tube(points, radius) {
  const found = [];
  const kept = points.filter((p, i) => i === 0 || Math.hypot(...subtract(p, points[i - 1])) > 1e-4);
  const rings = kept.map((point, i) => {
    const along = unitVector(subtract(kept[Math.min(i + 1, kept.length - 1)], kept[Math.max(i - 1, 0)]));
    const side = unitVector(cross([0, 0, 1], along)), up = cross(along, side);
    return Array.from({ length: SIDES }, (_, k) => {
      const [c, s] = [Math.cos((2 * Math.PI * k) / SIDES), Math.sin((2 * Math.PI * k) / SIDES)];
      const out = [0, 1, 2].map((d) => c * side[d] + s * up[d]);
      return [...[0, 1, 2].map((d) => point[d] + radius * out[d]), ...out];
    });
  });
  for (let i = 0; i + 1 < rings.length; i++) {
    for (let k = 0; k < SIDES; k++) {
      const [a, b, c, d] = [rings[i][k], rings[i][(k + 1) % SIDES], rings[i + 1][k], rings[i + 1][(k + 1) % SIDES]];
      found.push(...a, ...c, ...b, ...b, ...c, ...d);
    }
  }
  return found;
}

// `parts` are lists of triangles of the ground and of outlines; both come from Python.
export function prism({ outlines, triangles }, low, high) {
  const found = [];
  for (const outline of outlines) {
    for (let i = 0; i + 1 < outline.length; i++) {
      const [p, q] = [outline[i], outline[i + 1]];
      const out = unitVector([q[1] - p[1], p[0] - q[0], 0]);
      const [a, b, c, d] = [[...p, low], [...q, low], [...p, high], [...q, high]].map((corner) => [...corner, ...out]);
      found.push(...a, ...b, ...c, ...c, ...b, ...d);
    }
  }
  for (const corner of triangles) found.push(...corner, high, 0, 0, 1);
  return found;
}

export function solidLayer(gl) {
  const { program, at } = compile(gl, SOLID_VERTEX, SOLID_FRAGMENT, ["view", "projection", "model", "paint"]);
  return {
    make(corners) {
      const list = gl.createVertexArray();
      gl.bindVertexArray(list);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
      for (const place of [0, 1]) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, 12 * place);
      }
      return { list, count: corners.length / 6 };
    },
    draw(shape, paint, [x, y, yaw], { view, projection }) {
      gl.useProgram(program);
      gl.bindVertexArray(shape.list);
      const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
      gl.uniformMatrix4fv(at.view, false, view);
      gl.uniformMatrix4fv(at.projection, false, projection);
      gl.uniformMatrix4fv(at.model, false, [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, x, y, 0, 1]);
      gl.uniform3fv(at.paint, paint);
      gl.drawArrays(gl.TRIANGLES, 0, shape.count);
    },
  };
}
