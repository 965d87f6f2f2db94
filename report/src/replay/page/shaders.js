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

/** How bright a face is, by its direction. */
const LIGHT = `
float lightOn(vec3 n) {
  return 0.62 + 0.28 * max(dot(n, normalize(vec3(0.5, -0.35, 0.8))), 0.0) + 0.10 * n.z;
}`;

/** The colour of a place on a block, by the light on its face. */
const BLOCK_PAINT = `
uniform vec3 markColour;
uniform vec3 pulledColour;
uniform float edgeShade;
out vec4 colour;
void painted(vec3 place, float light, vec4 paint, float marked, float near) {
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

const CUBE_PAINT = `#version 300 es
precision highp float;
in vec3 place;
in vec3 outward;
in vec4 paint;
in float marked;
in float near;
${LIGHT}
${BLOCK_PAINT}
void main() {
  painted(place, lightOn(normalize(outward)), paint, marked, near);
}`;

/** A small block as a point, within which rays meet it: one corner instead of twelve. */
const POINT_CORNERS = `#version 300 es
layout(location = 2) in vec3 centre;
layout(location = 3) in vec4 turn;
layout(location = 4) in vec4 colour;
layout(location = 5) in float mark;
uniform mat4 view;
uniform vec3 eye;
uniform mat3 basis;
uniform vec2 lens;
uniform vec2 pixels;
flat out vec3 from;
flat out vec3 ahead;
flat out vec3 right;
flat out vec3 up;
flat out vec3 lights;
flat out vec4 paint;
flat out float marked;
flat out float near;
${LIGHT}
vec3 turned(vec3 v, vec3 by) {
  return v + 2.0 * cross(by, cross(by, v) + turn.w * v);
}
void main() {
  vec3 way = eye - centre;
  // The eye, and the rays of the picture, in the block's own directions.
  from = turned(way, -turn.xyz);
  vec3[3] own = vec3[3](turned(basis[0], -turn.xyz), turned(basis[1], -turn.xyz), turned(basis[2], -turn.xyz));
  right = own[0] * lens.x;
  up = own[1] * lens.y;
  ahead = -own[2];
  vec3 side = vec3(from.x < 0.0 ? -1.0 : 1.0, from.y < 0.0 ? -1.0 : 1.0, from.z < 0.0 ? -1.0 : 1.0);
  for (int axis = 0; axis < 3; axis++) {
    vec3 normal = vec3(0.0);
    normal[axis] = side[axis];
    lights[axis] = lightOn(turned(normal, turn.xyz));
  }
  paint = colour;
  marked = mark;
  near = length(way);
  gl_Position = view * vec4(centre, 1.0);
  // How far it reaches from its centre: to the right, up, and to the eye, which makes it larger.
  vec3 reach = vec3(dot(abs(own[0]), vec3(0.5)), dot(abs(own[1]), vec3(0.5)), dot(abs(own[2]), vec3(0.5)));
  vec2 off = abs(gl_Position.xy / gl_Position.w) * lens;
  vec2 most = (reach.xy + off * reach.z) / (gl_Position.w - reach.z) / lens * pixels;
  gl_PointSize = max(most.x, most.y) + 1.0;
}`;

const POINT_PAINT = `#version 300 es
precision highp float;
flat in vec3 from;
flat in vec3 ahead;
flat in vec3 right;
flat in vec3 up;
flat in vec3 lights;
flat in vec4 paint;
flat in float marked;
flat in float near;
uniform vec2 pixels;
uniform vec2 depths;
${BLOCK_PAINT}
void main() {
  vec2 at = gl_FragCoord.xy / pixels * 2.0 - 1.0;
  vec3 ray = ahead + right * at.x + up * at.y;
  // Where the ray meets the planes of the faces that the eye can see: the last of them is the one, if it meets the block.
  vec3 side = vec3(from.x < 0.0 ? -1.0 : 1.0, from.y < 0.0 ? -1.0 : 1.0, from.z < 0.0 ? -1.0 : 1.0);
  vec3 far = (side * 0.5 - from) / ray;
  vec3 met = vec3(abs(from.x) > 0.5 ? far.x : -1.0, abs(from.y) > 0.5 ? far.y : -1.0, abs(from.z) > 0.5 ? far.z : -1.0);
  float most = max(met.x, max(met.y, met.z));
  vec3 place = from + most * ray;
  float light = most == met.x ? lights.x : most == met.y ? lights.y : lights.z;
  painted(place, light, paint, marked, near);
  if (most <= 0.0 || max(abs(place.x), max(abs(place.y), abs(place.z))) > 0.50001) discard;
  gl_FragDepth = 0.5 + 0.5 * (depths.y / most - depths.x);
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
