// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary tree by the surface area heuristic in bins (Wald 2007), collapsed to four children per node
// (Wald, Benthin, Boulos 2008). Closest points by Ericson, "Real-Time Collision Detection", 5.1.5. Winding
// numbers by signed crossings of an axis-parallel ray with a half-open rule on projected vertices.
#include "medial/triangle_bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "medial/triangle_frame.hpp"

// Values of four lanes pass between inlined functions only: there is no calling convention to change.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace spheretree::medial {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr std::uint32_t kLeafSize = 4;  // one packet
constexpr std::size_t kBins = 16;
// Four-wide nodes, at most kMaxDepth levels of them: splits are forced to halve beyond half that depth.
constexpr std::size_t kMaxDepth = 96;
constexpr std::size_t kStackSize = 3 * kMaxDepth + 4;
// Must be inlined into each instruction set's copy of its caller.
#define SPHERETREE_INLINE inline __attribute__((always_inline))

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Vector3d closestOnSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double length = ab.squaredNorm();
  if (!(length > 0)) return a;
  return a + std::clamp((p - a).dot(ab) / length, 0.0, 1.0) * ab;
}

Vector3d closestOnEdges(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = closestOnSegment(p, a, b);
  const Vector3d bc = closestOnSegment(p, b, c);
  const Vector3d ca = closestOnSegment(p, c, a);
  const double dab = (p - ab).squaredNorm();
  const double dbc = (p - bc).squaredNorm();
  const double dca = (p - ca).squaredNorm();
  if (dab <= dbc && dab <= dca) return ab;
  return dbc <= dca ? bc : ca;
}

// A triangle whose doubled area is below this fraction of its squared longest edge has no usable normal in
// double precision: its edges stand for it.
constexpr double kSliver = 1e-12;
// Below this fraction, digits are kept with more care (triangle_frame.hpp).
constexpr double kThin = 1e-2;

Vector3d closestOnThin(const Vector3d& p, const std::array<Vector3d, 3>& corner) {
  const TriangleFrame frame(corner);
  const Vector3d from = p - corner[frame.first];
  const double s = from.dot(frame.along);
  const double t = from.dot(frame.across);
  const bool above = t >= 0 && frame.apex * t <= frame.width * s &&
                     (frame.length - frame.apex) * (t - frame.width) + frame.width * (s - frame.apex) <= 0;
  if (!above || !(frame.width > kSliver * frame.length))
    return closestOnEdges(p, corner[0], corner[1], corner[2]);
  return corner[frame.first] + s * frame.along + t * frame.across;
}

Vector3d closestOnTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a;
  const Vector3d ac = c - a;
  const Vector3d ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2;
  const double vb = d5 * d2 - d1 * d6;
  const double va = d3 * d6 - d5 * d4;
  const double sum = va + vb + vc;  // squared length of the normal, up to rounding
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  if (!(sum > kThin * kThin * longest * longest)) return closestOnThin(p, {a, b, c});
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + (d1 / (d1 - d3)) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 / (d2 - d6)) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
  }
  return a + (vb / sum) * ab + (vc / sum) * ac;
}

/// Sign of ax * by - ay * bx without rounding (short of underflow).
int orientation(double ax, double ay, double bx, double by) {
  const double left = ax * by;
  const double right = ay * bx;
  if (left > right) return 1;
  if (left < right) return -1;
  const double tail = std::fma(ax, by, -left) - std::fma(ay, bx, -right);
  return tail > 0 ? 1 : (tail < 0 ? -1 : 0);
}

/// Crossing of the projected edge (a -> b) with the half-line from the origin along +u, upwards +1, downwards
/// -1. A vertex on the line v = 0 counts as above it, a point on the edge itself as right of it.
int crossing(double au, double av, double bu, double bv) {
  if ((av >= 0) == (bv >= 0)) return 0;
  const int side = orientation(au, av, bu, bv);
  if (bv >= 0) return side > 0 ? 1 : 0;
  return side < 0 ? -1 : 0;
}

/// Whether the ray from the origin along +w meets the triangle: +1 leaving through it, -1 entering, 0 not.
int signedHit(const std::array<double, 3>& u, const std::array<double, 3>& v,
              const std::array<double, 3>& w) {
  int turns = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    turns += crossing(u[k], v[k], u[next], v[next]);
  }
  if (turns == 0) return 0;
  if (w[0] <= 0 && w[1] <= 0 && w[2] <= 0) return 0;
  if (w[0] > 0 && w[1] > 0 && w[2] > 0) return turns;
  // The plane meets the w axis at det(a, b, c) / (doubled projected area), which has the sign of `turns`.
  const double det = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                     w[2] * (u[0] * v[1] - u[1] * v[0]);
  return det * turns > 0 ? turns : 0;
}

double halfArea(const AlignedBox3d& box) {
  if (box.isEmpty()) return 0;
  const Vector3d s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

}  // namespace

struct TriangleBvh::Builder {
  struct Range {
    std::uint32_t first;
    std::uint32_t count;
    AlignedBox3d box;
    std::size_t depth;
  };

  std::vector<AlignedBox3d> boxes;
  std::vector<Vector3d> centers;
  std::vector<std::uint32_t> order;
  std::vector<Node> nodes;
  std::vector<Packet> packets;
  const TriangleMesh& source;

  explicit Builder(const TriangleMesh& mesh) : source(mesh) {
    const std::size_t n = mesh.triangles.size();
    boxes.resize(n);
    centers.resize(n);
    order.resize(n);
    for (std::uint32_t t = 0; t < n; ++t) {
      for (std::size_t k = 0; k < 3; ++k) boxes[t].extend(mesh.corner(t, k));
      centers[t] = 0.5 * boxes[t].min() + 0.5 * boxes[t].max();
      order[t] = t;
    }
  }

  AlignedBox3d boxOf(std::uint32_t first, std::uint32_t count) const {
    AlignedBox3d box;
    for (std::uint32_t i = first; i < first + count; ++i) box.extend(boxes[order[i]]);
    return box;
  }

  std::pair<Range, Range> cut(const Range& range, std::uint32_t leftCount) const {
    const std::uint32_t middle = range.first + leftCount;
    return {Range{range.first, leftCount, boxOf(range.first, leftCount), range.depth + 1},
            Range{middle, range.count - leftCount, boxOf(middle, range.count - leftCount), range.depth + 1}};
  }

  std::pair<Range, Range> halve(const Range& range, int axis) {
    const auto begin = order.begin() + range.first;
    const std::uint32_t half = range.count / 2;
    std::nth_element(begin, begin + half, begin + range.count, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(centers[a][axis], a) < std::pair(centers[b][axis], b);
    });
    return cut(range, half);
  }

  std::pair<Range, Range> split(const Range& range) {
    AlignedBox3d spread;
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) spread.extend(centers[order[i]]);
    int axis = 0;
    const double width = spread.sizes().maxCoeff(&axis);
    if (!(width > 0) || range.depth > kMaxDepth / 2) return halve(range, axis);

    std::array<AlignedBox3d, kBins> bins;
    std::array<std::uint32_t, kBins> counts{};
    const auto binOf = [&](std::uint32_t t) {
      const double x = (centers[t][axis] - spread.min()[axis]) / width * static_cast<double>(kBins);
      return std::min(kBins - 1, static_cast<std::size_t>(x));
    };
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      const std::size_t bin = binOf(order[i]);
      bins[bin].extend(boxes[order[i]]);
      ++counts[bin];
    }
    std::array<double, kBins> rightCost{};
    AlignedBox3d box;
    std::uint32_t count = 0;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      box.extend(bins[b]);
      count += counts[b];
      rightCost[b] = halfArea(box) * count;
    }
    box.setEmpty();
    count = 0;
    double best = kInfinity;
    std::size_t bestBin = 0;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      box.extend(bins[b]);
      count += counts[b];
      if (count == 0 || count == range.count) continue;
      const double cost = halfArea(box) * count + rightCost[b + 1];
      if (cost < best) {
        best = cost;
        bestBin = b;
      }
    }
    if (best == kInfinity) return halve(range, axis);
    const auto begin = order.begin() + range.first;
    const auto middle = std::stable_partition(begin, begin + range.count,
                                              [&](std::uint32_t t) { return binOf(t) <= bestBin; });
    return cut(range, static_cast<std::uint32_t>(middle - begin));
  }

  struct TurnedBox {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Vector3d low = Vector3d::Constant(kInfinity);
    Vector3d high = Vector3d::Constant(-kInfinity);
  };

  /// The box of a range along its mean normal and, across it, along its greatest spread.
  TurnedBox turnedBoxOf(const Range& range) const {
    TurnedBox box;
    Vector3d normal = Vector3d::Zero();
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      const Vector3d& a = source.corner(order[i], 0);
      normal += (source.corner(order[i], 1) - a).cross(source.corner(order[i], 2) - a);
    }
    const double length = normal.norm();
    if (length > 0 && std::isfinite(length)) {
      normal /= length;
      const Vector3d u = normal.unitOrthogonal();
      const Vector3d v = normal.cross(u);
      const Vector3d middle = range.box.center();
      double difference = 0;  // of the second moments along u and v
      double mixed = 0;       // twice the mixed moment
      forEachCorner(range, [&](const Vector3d& p) {
        const double pu = (p - middle).dot(u);
        const double pv = (p - middle).dot(v);
        difference += pu * pu - pv * pv;
        mixed += 2 * pu * pv;
      });
      const double spread = std::sqrt(difference * difference + mixed * mixed);
      const double doubledCosine = spread > 0 ? difference / spread : 1;
      const double cosine = std::sqrt(std::max(0.0, (1 + doubledCosine) / 2));
      const double sine = std::copysign(std::sqrt(std::max(0.0, (1 - doubledCosine) / 2)), mixed);
      box.axes.row(0) = normal;
      box.axes.row(1) = cosine * u + sine * v;
      box.axes.row(2) = cosine * v - sine * u;
    }
    forEachCorner(range, [&](const Vector3d& p) {
      const Vector3d q = box.axes * p;
      box.low = box.low.cwiseMin(q);
      box.high = box.high.cwiseMax(q);
    });
    // A dot product of three terms is off by a few ulps of the largest coordinate.
    constexpr double kGuard = 8 * std::numeric_limits<double>::epsilon();
    const double reach =
        std::max(range.box.min().cwiseAbs().maxCoeff(), range.box.max().cwiseAbs().maxCoeff());
    box.low.array() -= kGuard * reach;
    box.high.array() += kGuard * reach;
    return box;
  }

  template <class Visit>
  void forEachCorner(const Range& range, const Visit& visit) const {
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      for (std::size_t k = 0; k < 3; ++k) visit(source.corner(order[i], k));
    }
  }

  std::uint32_t buildPacket(const Range& range) {
    Packet packet;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const bool used = lane < range.count;
      const std::uint32_t t = order[range.first + (used ? lane : 0)];
      std::array<Vector3d, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) corner[k] = used ? source.corner(t, k) : Vector3d::Constant(kNaN);
      std::array<Vector3d, 3> edge;
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        edge[k] = corner[(k + 1) % 3] - corner[k];
        const double squared = edge[k].squaredNorm();
        longest = std::max(longest, squared);
        packet.inverseSquaredEdge[k][lane] = squared > 0 ? 1 / squared : 0;
      }
      Vector3d normal = edge[0].cross(-edge[2]);
      const double doubledArea = normal.norm();
      if (doubledArea > kThin * longest) {
        normal /= doubledArea;
      } else {
        const bool flat = used && doubledArea > kSliver * longest;
        normal = flat ? TriangleFrame(corner).normal() : Vector3d::Constant(kNaN);
      }
      packet.triangle[lane] = used ? t : std::numeric_limits<std::uint32_t>::max();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        packet.normal[axis][lane] = normal[static_cast<int>(axis)];
        for (std::size_t k = 0; k < 3; ++k) packet.corner[k][axis][lane] = corner[k][static_cast<int>(axis)];
      }
    }
    packets.push_back(packet);
    return static_cast<std::uint32_t>(packets.size() - 1);
  }

  std::uint32_t buildNode(const Range& range) {
    // Open the child with the largest box until there are four.
    std::vector<Range> children;
    if (range.count <= kLeafSize) {
      children.push_back(range);
    } else {
      auto [left, right] = split(range);
      children = {left, right};
      while (children.size() < kWidth) {
        std::size_t widest = children.size();
        for (std::size_t i = 0; i < children.size(); ++i) {
          if (children[i].count <= kLeafSize) continue;
          if (widest == children.size() || halfArea(children[i].box) > halfArea(children[widest].box))
            widest = i;
        }
        if (widest == children.size()) break;
        auto [a, b] = split(children[widest]);
        children[widest] = a;
        children.push_back(b);
      }
    }
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(Node{});
    for (std::size_t slot = 0; slot < kWidth; ++slot) {
      const bool used = slot < children.size();
      std::uint32_t child = 0;
      std::uint32_t count = 0;
      if (used) {
        const bool leaf = children[slot].count <= kLeafSize;
        child = leaf ? buildPacket(children[slot]) : buildNode(children[slot]);
        count = leaf ? children[slot].count : 0;
      }
      const TurnedBox turned = used ? turnedBoxOf(children[slot]) : TurnedBox{};
      Node& node = nodes[index];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = static_cast<int>(k);
        for (std::size_t c = 0; c < 3; ++c) node.axis[k][c][slot] = turned.axes(row, static_cast<int>(c));
        node.turnedLow[k][slot] = turned.low[row];
        node.turnedHigh[k][slot] = turned.high[row];
      }
      node.child[slot] = child;
      node.count[slot] = count;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        node.low[axis][slot] = used ? children[slot].box.min()[a] : kInfinity;
        node.high[axis][slot] = used ? children[slot].box.max()[a] : -kInfinity;
      }
    }
    return index;
  }
};

TriangleBvh::TriangleBvh(const TriangleMesh& mesh) : bounds_(boundsOf(mesh)) {
  Builder builder(mesh);
  builder.buildNode({0, static_cast<std::uint32_t>(mesh.triangles.size()), bounds_, 0});
  nodes_ = std::move(builder.nodes);
  packets_ = std::move(builder.packets);
}

/// The inner loops of closestPoint, written once on four lanes and compiled for each instruction set.
struct TriangleBvh::Kernels {
  typedef double Lanes __attribute__((vector_size(32)));
  typedef long long Mask __attribute__((vector_size(32)));

  static SPHERETREE_INLINE Lanes load(const Wide& from) {
    Lanes lanes;
    std::memcpy(&lanes, from.data(), sizeof lanes);
    return lanes;
  }
  static SPHERETREE_INLINE void store(Wide& to, const Lanes& lanes) {
    std::memcpy(to.data(), &lanes, sizeof lanes);
  }

  /// A lower bound of the squared distance to each of the four children of a node: to their turned boxes.
  static SPHERETREE_INLINE void lowerBounds(const Node& node, const Vector3d& point, Wide& out) {
    Lanes sum = {0, 0, 0, 0};
    const Lanes zero = {0, 0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes at = load(node.axis[k][0]) * point.x() + load(node.axis[k][1]) * point.y() +
                       load(node.axis[k][2]) * point.z();
      const Lanes below = load(node.turnedLow[k]) - at;
      const Lanes above = at - load(node.turnedHigh[k]);
      Lanes gap = below > above ? below : above;
      gap = gap > zero ? gap : zero;
      sum += gap * gap;
    }
    // The axes are orthonormal up to rounding only.
    constexpr double kShort = 1 - 1e-14;
    store(out, sum * kShort);
  }

  /// Squared distance to each of the four triangles of a packet: to the plane where the point projects into
  /// the triangle, otherwise to the nearest edge.
  static SPHERETREE_INLINE void triangleDistances(const Packet& packet, const Vector3d& point, Wide& out) {
    const Lanes zero = {0, 0, 0, 0};
    const Lanes one = {1, 1, 1, 1};
    Lanes corner[3][3];
    Lanes to[3][3];  // from each corner to the point
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corner[k][axis] = load(packet.corner[k][axis]);
        to[k][axis] = point[static_cast<int>(axis)] - corner[k][axis];
      }
    }
    const Lanes nx = load(packet.normal[0]);
    const Lanes ny = load(packet.normal[1]);
    const Lanes nz = load(packet.normal[2]);
    Lanes nearest = {kInfinity, kInfinity, kInfinity, kInfinity};
    Mask inPrism = {-1, -1, -1, -1};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const Lanes ex = corner[next][0] - corner[k][0];
      const Lanes ey = corner[next][1] - corner[k][1];
      const Lanes ez = corner[next][2] - corner[k][2];
      const Lanes px = to[k][0];
      const Lanes py = to[k][1];
      const Lanes pz = to[k][2];
      Lanes along = (px * ex + py * ey + pz * ez) * load(packet.inverseSquaredEdge[k]);
      along = along > zero ? along : zero;
      along = along < one ? along : one;
      const Lanes dx = px - along * ex;
      const Lanes dy = py - along * ey;
      const Lanes dz = pz - along * ez;
      const Lanes squared = dx * dx + dy * dy + dz * dz;
      nearest = squared < nearest ? squared : nearest;
      // cross(edge, normal) points out of the triangle.
      const Lanes outward = px * (ey * nz - ez * ny) + py * (ez * nx - ex * nz) + pz * (ex * ny - ey * nx);
      inPrism = inPrism & (outward <= zero);
    }
    const Lanes height = to[0][0] * nx + to[0][1] * ny + to[0][2] * nz;
    store(out, inPrism ? height * height : nearest);
  }

  template <bool kExact>
  static SPHERETREE_INLINE std::uint32_t closestTriangle(const TriangleBvh& bvh, const Vector3d& point,
                                                         Vector3d& closest) {
    struct Entry {
      double distance;
      std::uint32_t node;
    };
    Entry stack[kStackSize];
    std::size_t size = 0;
    stack[size++] = {0, 0};
    double best = kInfinity;
    std::uint32_t visited = 0;  // packets
    double share = 1;           // of `best`: what is farther cannot matter
    std::uint32_t bestTriangle = std::numeric_limits<std::uint32_t>::max();
    const Packet* bestPacket = nullptr;
    std::size_t bestLane = 0;
    while (size > 0) {
      const Entry entry = stack[--size];
      if (entry.distance > share * best) continue;
      if constexpr (!kExact) {
        if (visited > kManyPackets) share = 1 / (kRough * kRough);
      }
      const Node& node = bvh.nodes_[entry.node];
      Wide distance;
      lowerBounds(node, point, distance);
      // Nearest child first: sort four slots with a five-comparator network, farthest in front.
      std::uint32_t slot[kWidth] = {0, 1, 2, 3};
      constexpr std::size_t kNetwork[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
      for (const auto& [a, b] : kNetwork) {
        if (distance[slot[a]] < distance[slot[b]]) std::swap(slot[a], slot[b]);
      }
      // This node's own triangles before any farther node, so that what they find prunes the others.
      for (std::size_t k = kWidth; k-- > 0;) {
        const std::uint32_t s = slot[k];
        if (node.count[s] == 0 || distance[s] > share * best) continue;
        const Packet& packet = bvh.packets_[node.child[s]];
        if constexpr (!kExact) ++visited;
        Wide squared;
        triangleDistances(packet, point, squared);
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
          if (squared[lane] < best || (squared[lane] == best && packet.triangle[lane] < bestTriangle)) {
            best = squared[lane];
            bestTriangle = packet.triangle[lane];
            bestPacket = &packet;
            bestLane = lane;
          }
        }
      }
      for (const std::uint32_t s : slot) {
        if (node.count[s] != 0 || !(distance[s] <= share * best) || distance[s] == kInfinity) continue;
        stack[size++] = {distance[s], node.child[s]};
      }
    }
    const auto cornerOf = [&](std::size_t k) {
      const auto& c = bestPacket->corner[k];
      return Vector3d(c[0][bestLane], c[1][bestLane], c[2][bestLane]);
    };
    closest = closestOnTriangle(point, cornerOf(0), cornerOf(1), cornerOf(2));
    return bestTriangle;
  }

  template <bool kExact>
  static std::uint32_t baseline(const TriangleBvh& bvh, const Vector3d& point, Vector3d& closest) {
    return closestTriangle<kExact>(bvh, point, closest);
  }
#if defined(__x86_64__)
  template <bool kExact>
  __attribute__((target("avx2"))) static std::uint32_t avx2(const TriangleBvh& bvh, const Vector3d& point,
                                                            Vector3d& closest) {
    return closestTriangle<kExact>(bvh, point, closest);
  }
#endif

  using Function = std::uint32_t (*)(const TriangleBvh&, const Vector3d&, Vector3d&);
  template <bool kExact>
  static ClosestPoint search(const TriangleBvh& bvh, const Vector3d& point) {
    static const Function kernel = [] {
#if defined(__x86_64__)
      if (__builtin_cpu_supports("avx2")) return &avx2<kExact>;
#endif
      return &baseline<kExact>;
    }();
    ClosestPoint closest;
    closest.triangle = kernel(bvh, point, closest.point);
    closest.distance = (closest.point - point).norm();
    return closest;
  }
};

ClosestPoint TriangleBvh::closestPoint(const Vector3d& point) const {
  return Kernels::search<true>(*this, point);
}

ClosestPoint TriangleBvh::roughlyClosestPoint(const Vector3d& point) const {
  return Kernels::search<false>(*this, point);
}

int TriangleBvh::windingNumber(const Vector3d& point) const {
  if (!bounds_.contains(point)) return 0;
  // The shortest way out of the bounding box crosses the fewest triangles.
  std::size_t axis = 0;
  bool forward = true;
  double shortest = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const double up = bounds_.max()[static_cast<int>(k)] - point[static_cast<int>(k)];
    const double down = point[static_cast<int>(k)] - bounds_.min()[static_cast<int>(k)];
    if (up < shortest) {
      shortest = up;
      axis = k;
      forward = true;
    }
    if (down < shortest) {
      shortest = down;
      axis = k;
      forward = false;
    }
  }
  const std::size_t uAxis = (axis + 1) % 3;
  const std::size_t vAxis = (axis + 2) % 3;
  const double pu = point[static_cast<int>(uAxis)];
  const double pv = point[static_cast<int>(vAxis)];
  const double pw = point[static_cast<int>(axis)];
  const double sign = forward ? 1 : -1;

  std::uint32_t stack[kStackSize];
  std::size_t size = 0;
  stack[size++] = 0;
  int winding = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    for (std::size_t s = 0; s < kWidth; ++s) {
      if (node.low[uAxis][s] > pu || node.high[uAxis][s] < pu) continue;
      if (node.low[vAxis][s] > pv || node.high[vAxis][s] < pv) continue;
      if (forward ? node.high[axis][s] < pw : node.low[axis][s] > pw) continue;
      if (node.count[s] == 0) {
        stack[size++] = node.child[s];
        continue;
      }
      const Packet& packet = packets_[node.child[s]];
      for (std::size_t lane = 0; lane < node.count[s]; ++lane) {
        std::array<double, 3> u{};
        std::array<double, 3> v{};
        std::array<double, 3> w{};
        for (std::size_t k = 0; k < 3; ++k) {
          u[k] = packet.corner[k][uAxis][lane] - pu;
          v[k] = packet.corner[k][vAxis][lane] - pv;
          w[k] = sign * (packet.corner[k][axis][lane] - pw);
        }
        winding += signedHit(u, v, w) * (forward ? 1 : -1);
      }
    }
  }
  return winding;
}

std::vector<std::uint32_t> TriangleBvh::trianglesNear(const AlignedBox3d& box) const {
  std::vector<std::uint32_t> found;
  std::uint32_t stack[kStackSize];
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    for (std::size_t s = 0; s < kWidth; ++s) {
      bool meets = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        meets = meets && node.low[axis][s] <= box.max()[a] && node.high[axis][s] >= box.min()[a];
      }
      if (!meets) continue;
      if (node.count[s] == 0) {
        stack[size++] = node.child[s];
        continue;
      }
      const Packet& packet = packets_[node.child[s]];
      for (std::size_t lane = 0; lane < node.count[s]; ++lane) {
        AlignedBox3d own;
        for (const auto& c : packet.corner) own.extend(Vector3d(c[0][lane], c[1][lane], c[2][lane]));
        if (own.intersects(box)) found.push_back(packet.triangle[lane]);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace spheretree::medial
