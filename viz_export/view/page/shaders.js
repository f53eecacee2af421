// Programs of the graphics processor. Bodies' places, turns and states stand in textures by body number, so that a
// frame is two uploads whatever is drawn. Spheres are squares that cover them; each pixel finds where its ray meets the
// ball.

const lightChunk = `
uniform vec4 clipPlane;  // in axes of the camera: what lies beyond is cut off; w > 1e29: nothing is
const vec3 lamp = vec3(-0.3532, 0.5102, 0.7849);    // (-0.45, 0.65, 1), unit
const vec3 half_way = vec3(-0.1869, 0.2700, 0.9445);  // between lamp and eye
vec3 lit(vec3 base, vec3 n) {
  float shine = max(dot(n, half_way), 0.0);
  shine *= shine;
  shine *= shine;
  shine *= shine;
  shine *= shine;
  shine *= shine;
  float light = 0.42 + 0.08 * n.y + 0.62 * max(dot(n, lamp), 0.0);
  return base * light * (0.82 + 0.18 * n.z) + vec3(0.10 * shine);
}
bool beyond(vec3 p) { return clipPlane.w < 1e29 && dot(clipPlane.xyz, p) > clipPlane.w; }
`;

const colourChunk = `
uniform sampler2D table;
uniform vec3 wallColour;
uniform vec3 groundColour;
uniform float lifted;    // 1: dark page
vec3 baseColour(float value) {
  if (value < -2.5) return groundColour;
  if (value < -1.5) return wallColour;
  return texelFetch(table, ivec2(int(clamp(value, 0.0, 1.0) * 255.0 + 0.5), 0), 0).rgb;
}
`;

const bodyChunk = `
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform highp sampler2D places;
uniform highp sampler2D states;
uniform int width;
uniform float pass;  // 0: bodies that hide what is behind them, 1: the others
in float body;
vec4 stateOf(ivec2 at) { return texelFetch(states, at, 0); }
bool unseen(vec4 place, vec4 state) {
  return place.w < -1e29 || state.y <= 0.0 || (state.y > 0.995 ? 0.0 : 1.0) != pass;
}
ivec2 entry() { int k = int(body + 0.5); return ivec2(k % width, k / width); }
`;

const shaders = {
  // The outline of a ball is the unit circle of its square; within it the ball is taken as seen from its own direction.
  sphereVertex: `#version 300 es
precision highp float;
precision highp int;
${bodyChunk}
${colourChunk}
in vec3 position;
out vec2 corner;
flat out vec4 ball;    // centre and radius
flat out mat3 frame;   // across, up, towards the eye
flat out vec4 look;    // colour and opacity
void main() {
  ivec2 at = entry();
  vec4 place = texelFetch(places, at, 0);
  vec4 state = stateOf(at);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (unseen(place, state)) return;
  vec3 c = (viewMatrix * vec4(place.xyz, 1.0)).xyz;
  float far = length(c);
  float r = state.x;
  if (far <= r * 1.001) return;
  vec3 n = -c / far;
  vec3 u = normalize(cross(vec3(0.0, 1.0, 0.0), n));
  frame = mat3(u, cross(n, u), n);
  corner = position.xy;
  ball = vec4(c, r);
  look = vec4(baseColour(place.w), state.y);
  float reach = r * far / sqrt(far * far - r * r);
  gl_Position = projectionMatrix * vec4(c + reach * (position.x * frame[0] + position.y * frame[1]), 1.0);
}`,
  sphereFragment: `#version 300 es
precision highp float;
${lightChunk}
uniform mat4 projectionMatrix;
in vec2 corner;
flat in vec4 ball;
flat in mat3 frame;
flat in vec4 look;
out vec4 colour;
void main() {
  float rest = 1.0 - dot(corner, corner);
  if (rest < 0.0) discard;
  float height = sqrt(rest);
  vec3 n = frame * vec3(corner, height);
  vec3 hit = ball.xyz + ball.w * n;
  if (beyond(hit)) {
    float facing = -dot(clipPlane.xyz, frame[2]);
    float way = (clipPlane.w - dot(clipPlane.xyz, hit)) / facing;
    if (facing >= 0.0 || way > 2.0 * height * ball.w) discard;
    hit -= way * frame[2];
    n = clipPlane.xyz;
  }
  gl_FragDepth = 0.5 - 0.5 * (projectionMatrix[2][2] + projectionMatrix[3][2] / hit.z);
  colour = vec4(lit(look.rgb, n), look.a);
}`,
  meshVertex: `#version 300 es
precision highp float;
precision highp int;
${bodyChunk}
uniform highp sampler2D turns;
uniform float outlined;
in vec3 position;
in vec3 normal;  // of a half-space's lines: none for its outline, which is seen from both sides
out vec3 seen;
out vec3 outward;
flat out vec2 look;
vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
void main() {
  ivec2 at = entry();
  vec4 place = texelFetch(places, at, 0);
  vec4 state = stateOf(at);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  bool plane = state.z > 0.5;
  if (!plane && unseen(place, state)) return;
  vec4 q = texelFetch(turns, at, 0);
  vec4 p = viewMatrix * vec4(turned(q, position * state.x) + place.xyz, 1.0);
  seen = p.xyz;
  outward = mat3(viewMatrix) * turned(q, normal);
  float away = dot(outward, seen);
  if (plane && away > 0.0) state.y = min(state.y, 0.06);  // from within it lets all else through
  if (plane && (unseen(place, state) || (outlined > 0.5 && away < 0.0))) return;
  look = vec2(place.w, state.y);
  gl_Position = projectionMatrix * p;
}`,
  meshFragment: `#version 300 es
precision highp float;
precision highp int;
${lightChunk}
${colourChunk}
uniform float outlined;
in vec3 seen;
in vec3 outward;
flat in vec2 look;
out vec4 colour;
void main() {
  if (beyond(seen)) discard;
  if (outlined > 0.5) {
    vec3 base = baseColour(look.x);
    bool dark = dot(base, vec3(0.3, 0.6, 0.1)) < 0.3;  // edges stand out from their faces
    vec3 ruled = look.y > 0.995 ? vec3(0.45, 0.48, 0.54) : vec3(0.25, 0.28, 0.34);
    vec3 line = look.x < -1.5 ? mix(ruled, vec3(0.62, 0.66, 0.72), lifted)
      : dark ? mix(base, vec3(1.0), 0.45) : 0.4 * base;
    colour = vec4(line, look.y < 0.1 ? 0.3 : max(0.45, look.y));
    return;
  }
  vec3 n = normalize(outward);
  vec3 facet = cross(dFdx(seen), dFdy(seen));
  if (dot(n, facet) * dot(facet, seen) > 0.0) n = -n;  // seen from behind
  float beyond_outline = dot(n, seen);  // of the curved surface that the facet stands for
  if (beyond_outline > 0.0) n = normalize(n - beyond_outline / dot(seen, seen) * seen);
  vec3 c = lit(baseColour(look.x), n);
  if (!gl_FrontFacing && look.y > 0.995) c *= 0.72;
  colour = vec4(c, look.y);
}`,
  lineVertex: `#version 300 es
precision highp float;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
in vec3 position;  // x: across, y: along, z: 1 widens to a head
in vec3 from;
in vec3 to;
in vec2 size;      // width [m], value in [0, 1] or -2
out vec3 seen;
out float across;
flat out float value;
void main() {
  vec3 a = (viewMatrix * vec4(from, 1.0)).xyz;
  vec3 b = (viewMatrix * vec4(to, 1.0)).xyz;
  vec3 p = mix(a, b, position.y);
  float far = length(b - a);  // unit first: squares of products of very small lengths are no numbers
  vec3 side = far > 0.0 ? cross((b - a) / far, normalize(p)) : vec3(0.0);
  float length_of_side = length(side);
  side = length_of_side > 0.0 ? side / length_of_side : vec3(1.0, 0.0, 0.0);
  seen = p + side * position.x * size.x * (1.0 + position.z);
  across = position.x;
  value = size.y;
  gl_Position = projectionMatrix * vec4(seen, 1.0);
}`,
  lineFragment: `#version 300 es
precision highp float;
precision highp int;
${lightChunk}
${colourChunk}
in vec3 seen;
in float across;
flat in float value;
out vec4 colour;
void main() {
  if (beyond(seen)) discard;
  float height = sqrt(max(0.0, 1.0 - 0.9 * across * across));
  vec3 base = value < -1.5 ? mix(vec3(0.2), vec3(0.85), lifted) : baseColour(value);
  colour = vec4(base * (0.55 + 0.45 * height), 1.0);
}`,
};
