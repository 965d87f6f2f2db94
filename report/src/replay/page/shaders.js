// What the graphics processor does.

const CUBE_CORNERS = `#version 300 es
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 centre;
layout(location = 3) in vec4 turn;
layout(location = 4) in vec4 colour;
layout(location = 5) in float mark;
uniform mat4 view;
out vec3 place;
out vec3 outward;
out vec4 paint;
out float marked;
out float near;
uniform vec3 eye;
vec3 turned(vec3 v) {
  return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
}
void main() {
  // The eye, in the block's own directions: of each pair of faces, it can see one at most.
  vec3 way = eye - centre;
  vec3 seen = way + 2.0 * cross(-turn.xyz, cross(-turn.xyz, way) + turn.w * way);
  vec3 side = vec3(seen.x < 0.0 ? -1.0 : 1.0, seen.y < 0.0 ? -1.0 : 1.0, seen.z < 0.0 ? -1.0 : 1.0);
  place = corner * side;
  outward = turned(normal * side);
  paint = colour;
  marked = mark;
  near = length(way);
  bool visible = dot(abs(seen), normal) > 0.5;
  gl_Position = visible ? view * vec4(centre + turned(place), 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
}`;

const CUBE_PAINT = `#version 300 es
precision highp float;
in vec3 place;
in vec3 outward;
in vec4 paint;
in float marked;
in float near;
uniform vec3 markColour;
uniform vec3 pulledColour;
uniform float edgeShade;
out vec4 colour;
void main() {
  vec3 n = normalize(outward);
  float light = 0.62 + 0.28 * max(dot(n, normalize(vec3(0.5, -0.35, 0.8))), 0.0) + 0.10 * n.z;
  // On a face one of these is 1; at an edge the second is, too.
  vec3 a = abs(place) * 2.0;
  float second = a.x + a.y + a.z - max(a.x, max(a.y, a.z)) - min(a.x, min(a.y, a.z));
  float soft = fwidth(second);
  float wide = marked > 0.5 ? 0.16 : 0.09;
  float edge = smoothstep(1.0 - wide - soft, 1.0 - wide + soft, second);
  vec3 base = paint.rgb * light;
  vec3 rim = marked > 1.5 ? pulledColour : marked > 0.5 ? markColour : base * edgeShade;
  float opacity = paint.a;
  // What lets light through does not stand in the way, and is fainter far off.
  if (opacity < 1.0) opacity *= (1.0 + 0.4 * edge) * smoothstep(3.0, 12.0, near) * mix(1.0, 0.45, smoothstep(15.0, 50.0, near));
  colour = vec4(mix(base, rim, edge), opacity);
}`;

/** Coloured lines, and flat shapes. */
const PLAIN_CORNERS = `#version 300 es
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 colour;
uniform mat4 view;
out vec4 paint;
void main() {
  paint = colour;
  gl_Position = view * vec4(corner, 1.0);
}`;

const PLAIN_PAINT = `#version 300 es
precision highp float;
in vec4 paint;
out vec4 colour;
void main() {
  colour = paint;
}`;
