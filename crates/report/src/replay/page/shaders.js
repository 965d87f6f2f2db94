// Programs for the graphics processor.

/** Returns the brightness of a face by its direction. */
const LIGHT = `
float lightOn(vec3 n) {
  return 0.62 + 0.28 * max(dot(n, normalize(vec3(0.5, -0.35, 0.8))), 0.0) + 0.10 * n.z;
}`;

/**
 * Computes the colours of a block's faces and edges. They are constant on a face, so they are computed only at its
 * few corners. If `ownRim` is set, light does not change the colour of the edges.
 */
const BLOCK_COLOURS = `
uniform vec3 markColour;
uniform vec3 pulledColour;
uniform float edgeShade;
flat out vec4 base;
flat out vec4 rim;
flat out float within;
void dress(vec4 paint, float marked, float light, float near) {
  bool ownRim = marked > 0.5;
  base = vec4(paint.rgb * light, paint.a);
  rim = vec4(marked > 1.5 ? pulledColour : ownRim ? markColour : base.rgb * edgeShade, paint.a);
  within = ownRim ? 0.84 : 0.91;
  if (paint.a < 1.0) {
    // Transparent blocks hide nothing, and are fainter at a distance.
    base.a *= smoothstep(3.0, 12.0, near) * mix(1.0, 0.45, smoothstep(15.0, 50.0, near));
    rim.a = 1.4 * base.a;
  }
}`;

/**
 * Returns whether a point on a face belongs to its edge, from 0 to 1. `second` is its distance from the middle of the
 * face, which is 1 at the edge.
 */
const EDGE = `
flat in float within;
float edgeAt(float second) {
  float soft = fwidth(second);
  return smoothstep(within - soft, within + soft, second);
}`;

const CUBE_CORNERS = `#version 300 es
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 centre;
layout(location = 3) in vec4 turn;
layout(location = 4) in vec4 colour;
layout(location = 5) in float mark;
uniform mat4 view;
uniform vec3 eye;
out vec2 onFace;
${LIGHT}
${BLOCK_COLOURS}
vec3 turned(vec3 v) {
  return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
}
void main() {
  // Position of the camera in the block's own axes. It can see at most one of two opposite faces.
  vec3 way = eye - centre;
  vec3 seen = way + 2.0 * cross(-turn.xyz, cross(-turn.xyz, way) + turn.w * way);
  vec3 side = vec3(seen.x < 0.0 ? -1.0 : 1.0, seen.y < 0.0 ? -1.0 : 1.0, seen.z < 0.0 ? -1.0 : 1.0);
  onFace = 2.0 * (normal.x > 0.5 ? corner.yz : normal.y > 0.5 ? corner.zx : corner.xy);
  dress(colour, mark, lightOn(turned(normal * side)), length(way));
  bool visible = dot(abs(seen), normal) > 0.5;
  gl_Position = visible ? view * vec4(centre + turned(corner * side), 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
}`;

const CUBE_PAINT = `#version 300 es
precision highp float;
in vec2 onFace;
flat in vec4 base;
flat in vec4 rim;
out vec4 colour;
${EDGE}
void main() {
  colour = mix(base, rim, edgeAt(max(abs(onFace.x), abs(onFace.y))));
}`;

/** Draws a small block as one point instead of twelve corners. Rays are traced within the point. */
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
flat out float ownRim;
${LIGHT}
${BLOCK_COLOURS}
vec3 turned(vec3 v, vec3 by) {
  return v + 2.0 * cross(by, cross(by, v) + turn.w * v);
}
void main() {
  vec3 way = eye - centre;
  // Position of the camera and rays of the picture, in the block's own axes.
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
  // Each face of a block has its own brightness.
  dress(colour, mark, 1.0, length(way));
  ownRim = mark > 0.5 ? 1.0 : 0.0;
  gl_Position = view * vec4(centre, 1.0);
  // Extent of the block from its centre: to the right, up, and towards the camera. The last one
  // makes it appear larger.
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
flat in vec4 base;
flat in vec4 rim;
flat in float ownRim;
uniform vec2 pixels;
uniform vec2 depths;
out vec4 colour;
${EDGE}
void main() {
  vec2 at = gl_FragCoord.xy / pixels * 2.0 - 1.0;
  vec3 ray = ahead + right * at.x + up * at.y;
  // Intersections of the ray with the planes of the visible faces. If the ray meets the block, the
  // last one is on it.
  vec3 side = vec3(from.x < 0.0 ? -1.0 : 1.0, from.y < 0.0 ? -1.0 : 1.0, from.z < 0.0 ? -1.0 : 1.0);
  vec3 far = (side * 0.5 - from) / ray;
  vec3 met = vec3(abs(from.x) > 0.5 ? far.x : -1.0, abs(from.y) > 0.5 ? far.y : -1.0, abs(from.z) > 0.5 ? far.z : -1.0);
  float most = max(met.x, max(met.y, met.z));
  vec3 a = abs(from + most * ray) * 2.0;
  float light = most == met.x ? lights.x : most == met.y ? lights.y : lights.z;
  // On a face, one of these is 1. On an edge, two of them are 1.
  float highest = max(a.x, max(a.y, a.z));
  float edge = edgeAt(a.x + a.y + a.z - highest - min(a.x, min(a.y, a.z)));
  vec4 lit = vec4(light, light, light, 1.0);
  colour = mix(base * lit, ownRim > 0.5 ? rim : rim * lit, edge);
  if (most <= 0.0 || highest > 1.00002) discard;
  gl_FragDepth = 0.5 + 0.5 * (depths.y / most - depths.x);
}`;

/**
 * Draws coloured lines and flat shapes. With `flat`, each shape has one colour, which is faster. With `smooth`, the
 * colour changes gradually.
 */
const plainCorners = colours => `#version 300 es
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 colour;
uniform mat4 view;
${colours} out vec4 paint;
void main() {
  paint = colour;
  gl_Position = view * vec4(corner, 1.0);
}`;

const plainPaint = colours => `#version 300 es
precision highp float;
${colours} in vec4 paint;
out vec4 colour;
void main() {
  colour = paint;
}`;
