// SPDX-License-Identifier: MIT
//
// One light model for everything: a sun with a shadow map, a sky that is brighter above than below, a thin
// haze that says how far away things are. Colours are linear inside and leave through a filmic curve (Hable's
// rational form as fitted by K. Narkowicz) and the sRGB power.
//
// A ball is a square that just covers its outline as seen from the eye; the fragment shader intersects the
// ray with the ball and writes the depth of the hit, so balls meet each other and everything else exactly
// (S. Gumhold, Splatting illuminated ellipsoids with depth correction, 2003, for the special case of a ball).
#include "shaders.hpp"

namespace crowded_room::shaders {
namespace {

constexpr const char* kVersion = "#version 330 core\n";

// Must match Renderer's SceneBlock.
constexpr const char* kScene = R"(
layout(std140) uniform Scene {
  mat4 viewProjection;   // of the eye, or of the sun while the shadow map is drawn
  mat4 sunProjection;    // room to the unit cube of the shadow map
  vec4 viewer;           // w = 1: place of the eye; w = 0: direction towards it, far away
  vec4 sun;              // unit, towards the sun; w = 1 with shadows, 0 without
  vec4 room;             // size of the room; w: distance of its grid lines
  vec4 avatar;           // place; w: radius
};
)";

constexpr const char* kInstance = R"(
layout(location = 0) in vec4 placeAndScale;
layout(location = 1) in vec4 instanceColor;
layout(location = 2) in float instanceGlow;
)";

constexpr const char* kShading = R"(
uniform sampler2DShadow shadowMap;
const vec3 kSunLight = vec3(1.50, 1.38, 1.20);
const vec3 kSky = vec3(0.36, 0.45, 0.60);
const vec3 kGround = vec3(0.20, 0.18, 0.17);
const vec3 kHaze = vec3(0.36, 0.43, 0.52);
const vec3 kGlow = vec3(1.0, 0.30, 0.04);  // as it is seen
out vec4 fragment;

float lit(vec3 place, vec3 normal) {
  if (sun.w == 0.0) return 1.0;
  vec3 at = (sunProjection * vec4(place + 0.12 * normal, 1.0)).xyz;
  vec2 texel = 1.0 / vec2(textureSize(shadowMap, 0));
  float sum = 0.0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) sum += texture(shadowMap, at + vec3((vec2(i, j) - 0.5) * texel * 1.5, -0.0010));
  return 0.25 * sum;
}

vec3 leave(vec3 color, float away) {
  color = mix(kHaze, color, exp(-0.0022 * away));
  color = color * (2.51 * color + 0.03) / (color * (2.43 * color + 0.59) + 0.14);
  return pow(clamp(color, 0.0, 1.0), vec3(1.0 / 2.2));
}

vec3 linear(vec3 color) { return pow(color, vec3(2.2)); }

void shade(vec3 place, vec3 normal, vec3 color, float glow, float gloss) {
  vec3 toEye = viewer.xyz - place;
  float away = length(toEye);
  toEye /= away;
  float straight = max(dot(normal, sun.xyz), 0.0);
  float light = straight > 0.0 ? straight * lit(place, normal) : 0.0;
  // Less of the sky is seen close to the floor.
  float open = mix(0.62, 1.0, smoothstep(0.0, 4.0, place.y + 2.0 * normal.y));
  vec3 around = mix(kGround, kSky, 0.5 + 0.5 * normal.y) * open;
  float shine = pow(max(dot(normal, normalize(sun.xyz + toEye)), 0.0), 48.0) * gloss * light;
  float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 4.0);
  vec3 outgoing = color * (kSunLight * light + around) + kSunLight * shine + 0.18 * rim * kSky;
  // Over the haze, so that a collision is seen from afar; full for most of its time, then gone quickly.
  vec3 hot = kGlow * (0.70 + 0.30 * max(dot(normal, toEye), 0.0)) + vec3(0.25, 0.2, 0.1) * light;
  fragment = vec4(mix(leave(outgoing, away), hot, smoothstep(0.0, 0.55, glow)), 1.0);
}
)";

constexpr const char* kMeshVertex = R"(
layout(location = 3) in vec3 corner;
layout(location = 4) in vec3 cornerNormal;
out vec3 place;
out vec3 normal;
flat out vec3 color;
flat out float glow;
void main() {
  place = placeAndScale.xyz + placeAndScale.w * corner;
  normal = cornerNormal;
  color = instanceColor.rgb;
  glow = instanceGlow;
  gl_Position = viewProjection * vec4(place, 1.0);
}
)";

constexpr const char* kMeshFragment = R"(
in vec3 place;
in vec3 normal;
flat in vec3 color;
flat in float glow;
void main() { shade(place, normalize(normal), linear(color), glow, 0.35); }
)";

constexpr const char* kNoFragment = "void main() {}\n";

// Six corners per ball; the ball's number comes from the number of the vertex.
constexpr const char* kBallVertex = R"(
uniform samplerBuffer balls;
uniform samplerBuffer ballColors;
out vec3 place;
flat out vec4 ball;
flat out vec3 color;
flat out float glow;
const vec2 kCorners[6] = vec2[6](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1));
void main() {
  vec4 own = texelFetch(balls, gl_VertexID / 6);
  vec4 paint = texelFetch(ballColors, gl_VertexID / 6);
  ball = vec4(placeAndScale.xyz + placeAndScale.w * own.xyz, placeAndScale.w * own.w);
  color = mix(instanceColor.rgb, paint.rgb, paint.a);
  glow = instanceGlow;
  vec3 towards = viewer.w == 0.0 ? viewer.xyz : viewer.xyz - ball.xyz;
  float away = length(towards);
  towards /= away;
  float half_ = ball.w;
  vec3 middle = ball.xyz;
  if (viewer.w != 0.0) {  // the circle in which the cone from the eye touches the ball
    float sine = min(ball.w / away, 0.999);
    middle += towards * (ball.w * sine);
    half_ *= sqrt(1.0 - sine * sine);
  }
  vec3 side = normalize(abs(towards.y) < 0.9 ? cross(vec3(0, 1, 0), towards) : cross(vec3(1, 0, 0), towards));
  vec3 up = cross(towards, side);
  vec2 corner = kCorners[gl_VertexID % 6] * half_;
  place = middle + corner.x * side + corner.y * up;
  gl_Position = viewProjection * vec4(place, 1.0);
}
)";

constexpr const char* kBallHit = R"(
in vec3 place;
flat in vec4 ball;
flat in vec3 color;
flat in float glow;
vec3 hit() {
  vec3 ray = viewer.w == 0.0 ? -viewer.xyz : normalize(place - viewer.xyz);
  vec3 towards = ball.xyz - place;
  float along = dot(towards, ray);
  vec3 beside = towards - along * ray;
  float inside = ball.w * ball.w - dot(beside, beside);
  if (inside < 0.0) discard;
  vec3 at = place + (along - sqrt(inside)) * ray;
  vec4 clip = viewProjection * vec4(at, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  return at;
}
)";

constexpr const char* kBallFragment = R"(
void main() {
  vec3 at = hit();
  shade(at, (at - ball.xyz) / ball.w, linear(color), glow, 0.35);
}
)";

constexpr const char* kBallShadowFragment = "void main() { hit(); }\n";

// Thirty-six corners: six sides of the room, seen from inside only.
constexpr const char* kRoomVertex = R"(
out vec3 place;
flat out vec3 normal;
void main() {
  const vec2 kCorners[6] =
      vec2[6](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1));
  int side = gl_VertexID / 6;
  int axis = side / 2;
  vec3 inwards = vec3(0.0);
  inwards[axis] = side % 2 == 0 ? 1.0 : -1.0;
  vec3 u = vec3(0.0);
  u[(axis + 1) % 3] = 1.0;
  vec3 v = cross(inwards, u);
  vec2 corner = kCorners[gl_VertexID % 6];
  place = (0.5 + 0.5 * (-inwards + corner.x * u + corner.y * v)) * room.xyz;
  normal = inwards;
  gl_Position = viewProjection * vec4(place, 1.0);
}
)";

constexpr const char* kRoomFragment = R"(
in vec3 place;
flat in vec3 normal;
float line(vec2 at, float step_, float width) {
  vec2 cell = at / step_;
  vec2 soft = fwidth(cell);
  vec2 near = abs(fract(cell - 0.5) - 0.5);
  vec2 on = 1.0 - smoothstep(vec2(0.0), soft * 1.5, near - width / step_);
  // Where lines are finer than pixels, their mean.
  on = mix(on, vec2(2.0 * width / step_), smoothstep(0.2, 0.6, soft));
  return max(on.x, on.y);
}
void main() {
  vec3 away = min(place, room.xyz - place);
  vec3 other = mix(away, vec3(1e9), abs(normal));
  float corner = min(other.x, min(other.y, other.z));
  vec2 at = abs(normal.y) > 0.5 ? place.xz : abs(normal.x) > 0.5 ? place.zy : place.xy;
  vec3 color = normal.y > 0.5 ? vec3(0.50, 0.515, 0.53) : vec3(0.42, 0.48, 0.55);
  color *= 1.0 - 0.34 * line(at, room.w, 0.035) - 0.14 * line(at, room.w / 5.0, 0.015);
  color *= mix(0.70, 1.0, smoothstep(0.0, 5.0, corner));
  if (normal.y > 0.5) {  // where the avatar stands above the floor
    float from = length(place.xz - avatar.xz);
    float soft = fwidth(from);
    float ring = 1.0 - smoothstep(0.10, 0.10 + 1.5 * soft, abs(from - 1.6 * avatar.w));
    color = mix(color, vec3(0.70, 0.01, 0.22), 0.85 * ring);
  }
  vec3 toEye = viewer.xyz - place;
  float straight = max(dot(normal, sun.xyz), 0.0);
  vec3 around = mix(vec3(0.34), kSky, 0.5 + 0.5 * normal.y);
  float light = straight > 0.0 ? straight * lit(place, normal) : 0.12;
  fragment = vec4(leave(color * (0.75 * kSunLight * light + around), length(toEye)), 1.0);
}
)";

template <class... Parts>
std::string join(Parts... parts) {
  std::string text = kVersion;
  (text.append(parts), ...);
  return text;
}

}  // namespace

Sources mesh() {
  return {join(kScene, kInstance, kMeshVertex), join(kScene, kShading, kMeshFragment)};
}

Sources meshShadow() {
  return {join(kScene, kInstance, kMeshVertex), join(kNoFragment)};
}

Sources balls() {
  return {join(kScene, kInstance, kBallVertex), join(kScene, kShading, kBallHit, kBallFragment)};
}

Sources ballsShadow() {
  return {join(kScene, kInstance, kBallVertex), join(kScene, kBallHit, kBallShadowFragment)};
}

Sources room() {
  return {join(kScene, kRoomVertex), join(kScene, kShading, kRoomFragment)};
}

}  // namespace crowded_room::shaders
