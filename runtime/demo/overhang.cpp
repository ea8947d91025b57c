// SPDX-License-Identifier: MIT
//
// Points spread over each ball by the golden angle; the closest point of the mesh after C. Ericson, Real-Time
// Collision Detection, 5.1.5; outside is where the face of the closest point looks to.
#include "overhang.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "matrix.hpp"

namespace crowded_room {

using spheretree::Vec3;

namespace {

constexpr int kSamples = 48;  // per ball: 30 degrees from each other

struct Face {
  Vec3 a;
  Vec3 b;
  Vec3 c;
  Vec3 normal;
  Vec3 middle;
  float reach = 0;  // of the corners from the middle
};

std::vector<Face> facesOf(const Mesh& mesh) {
  std::vector<Face> faces;
  for (const auto& [i, j, k] : mesh.triangles) {
    Face face{mesh.vertices[i].place, mesh.vertices[j].place, mesh.vertices[k].place, {}, {}};
    face.normal = unit(cross(face.b - face.a, face.c - face.a));
    face.middle = (1.0F / 3) * (face.a + face.b + face.c);
    for (const Vec3 corner : {face.a, face.b, face.c})
      face.reach = std::max(face.reach, length(corner - face.middle));
    faces.push_back(face);
  }
  return faces;
}

Vec3 closestOf(const Face& face, Vec3 p) {
  const Vec3 ab = face.b - face.a;
  const Vec3 ac = face.c - face.a;
  const float d1 = dot(ab, p - face.a);
  const float d2 = dot(ac, p - face.a);
  if (d1 <= 0 && d2 <= 0) return face.a;
  const float d3 = dot(ab, p - face.b);
  const float d4 = dot(ac, p - face.b);
  if (d3 >= 0 && d4 <= d3) return face.b;
  const float onAb = d1 * d4 - d3 * d2;
  if (onAb <= 0 && d1 >= 0 && d3 <= 0) return face.a + (d1 / (d1 - d3)) * ab;
  const float d5 = dot(ab, p - face.c);
  const float d6 = dot(ac, p - face.c);
  if (d6 >= 0 && d5 <= d6) return face.c;
  const float onAc = d5 * d2 - d1 * d6;
  if (onAc <= 0 && d2 >= 0 && d6 <= 0) return face.a + (d2 / (d2 - d6)) * ac;
  const float onBc = d3 * d6 - d5 * d4;
  if (onBc <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return face.b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (face.c - face.b);
  const float whole = 1 / (onBc + onAc + onAb);
  return face.a + (onAc * whole) * ab + (onAb * whole) * ac;
}

/// Distance from the mesh, 0 inside.
float distanceOutside(std::span<const Face> faces, Vec3 p) {
  float best = std::numeric_limits<float>::max();
  float side = 0;  // how squarely the closest face is looked at
  for (const Face& face : faces) {
    if (length(p - face.middle) - face.reach > best) continue;
    const Vec3 away = p - closestOf(face, p);
    const float distance = length(away);
    const float squarely = dot(away, face.normal);
    // At an edge two faces are as close; the one that is looked at more squarely knows the side.
    const bool same = std::abs(distance - best) <= 1e-6F;
    if (same ? std::abs(squarely) > std::abs(side) : distance < best) {
      best = distance;
      side = squarely;
    }
  }
  return side > 0 ? best : 0;
}

}  // namespace

std::vector<float> overhangsOf(std::span<const spheretree::Node> balls, const Mesh& mesh) {
  const std::vector<Face> faces = facesOf(mesh);
  const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0F));
  std::vector<float> overhangs;
  for (const spheretree::Node& node : balls) {
    float most = 0;
    for (int sample = 0; sample < kSamples; ++sample) {
      const float z = 1 - 2 * (static_cast<float>(sample) + 0.5F) / kSamples;
      const float ring = std::sqrt(1 - z * z);
      const float turn = golden * static_cast<float>(sample);
      const Vec3 direction{ring * std::cos(turn), ring * std::sin(turn), z};
      most = std::max(most, distanceOutside(faces, node.ball.center + node.ball.radius * direction));
    }
    overhangs.push_back(most);
  }
  return overhangs;
}

}  // namespace crowded_room
