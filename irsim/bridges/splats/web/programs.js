// Programs of WebGL 2: splats as ellipses on the screen, and solids with light from above.

export const SPLAT_VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D data;
uniform mat4 view;
uniform vec2 size;
uniform float focal, near, far, hidden, cut;
layout(location = 0) in uint which;
out vec4 tint;
out vec2 place;
uvec4 at(uint texel) { return texelFetch(data, ivec2(int(texel & 2047u), int(texel >> 11u)), 0); }
void main() {
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  uvec4 first = at(which * 3u);
  vec4 upper = uintBitsToFloat(at(which * 3u + 1u)), lower = uintBitsToFloat(at(which * 3u + 2u));
  vec3 center = uintBitsToFloat(first.xyz);
  vec3 camera = (view * vec4(center, 1.0)).xyz;
  float depth = -camera.z;
  if (depth < max(near, hidden) || center.z > cut) return;
  vec2 slope = size / (2.0 * focal);
  vec2 tangent = clamp(camera.xy / depth, -1.3 * slope, 1.3 * slope);
  mat3 cover = mat3(upper.x, upper.y, upper.z, upper.y, upper.w, lower.x, upper.z, lower.x, lower.y);
  mat3 turn = mat3(view);
  mat3 seen = turn * cover * transpose(turn);
  vec3 across = vec3(1.0, 0.0, tangent.x) * (focal / depth), down = vec3(0.0, 1.0, tangent.y) * (focal / depth);
  float xx = dot(across, seen * across) + 0.3, xy = dot(across, seen * down), yy = dot(down, seen * down) + 0.3;
  tint = vec4(uvec4(first.w, first.w >> 8u, first.w >> 16u, first.w >> 24u) & 255u) / 255.0;
  tint.a = min(tint.a, 0.99);
  float reach = sqrt(2.0 * log(max(255.0 * tint.a, 1.0)));
  if (reach <= 0.0) return;
  float middle = 0.5 * (xx + yy), apart = length(vec2(0.5 * (xx - yy), xy));
  float large = middle + apart, small = max(middle - apart, 0.05);
  vec2 axis = apart < 1e-6 ? vec2(1.0, 0.0) : normalize(abs(xx - yy) + abs(xy) < 1e-6 ? vec2(1.0, 0.0)
    : xx > yy ? vec2(large - yy, xy) : vec2(xy, large - xx));
  place = (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0) * reach;
  vec2 offset = place.x * min(sqrt(large), 2048.0) * axis + place.y * min(sqrt(small), 2048.0) * vec2(-axis.y, axis.x);
  vec2 middle_ndc = camera.xy / depth * focal * 2.0 / size;
  if (any(greaterThan(abs(middle_ndc) - abs(reach * sqrt(large) * 2.0 / size), vec2(1.0)))) return;
  float z = ((far + near) - 2.0 * far * near / depth) / (far - near);
  gl_Position = vec4(middle_ndc + offset * 2.0 / size, z, 1.0);
}`;

export const SPLAT_FRAGMENT = `#version 300 es
precision highp float;
in vec4 tint;
in vec2 place;
out vec4 color;
void main() {
  float alpha = tint.a * exp(-0.5 * dot(place, place));
  if (alpha < 1.0 / 255.0) discard;
  color = vec4(tint.rgb * alpha, alpha);
}`;

export const SOLID_VERTEX = `#version 300 es
precision highp float;
uniform mat4 view, projection, model;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 facing;
void main() {
  facing = mat3(model) * normal;
  gl_Position = projection * view * model * vec4(position, 1.0);
}`;

export const SOLID_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 paint;
in vec3 facing;
out vec4 color;
void main() {
  float light = 0.62 + 0.38 * dot(normalize(facing), normalize(vec3(0.35, -0.25, 0.9)));
  color = vec4(paint * clamp(light, 0.0, 1.0), 1.0);
}`;

export function compile(gl, vertex, fragment, names) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "no program");
  return { program, at: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) };
}
