// SPDX-License-Identifier: GPL-3.0-or-later
//
// Orientation in two steps. Neighbours agree: a walk over the edges that have exactly two triangles. Shells
// point outwards: a shell with negative volume is a cavity when it lies in another shell, inside out
// otherwise. "In" is the winding number, summed from solid angles (A. van Oosterom and J. Strackee, IEEE
// Trans. Biomed. Eng. 30, 1983), so that shells may overlap and cross.

#include "io/mesh_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "io/mesh_topology.hpp"

namespace spheretree::io {
namespace {

using Triangle = medial::TriangleMesh::Triangle;

// Points of a shell that are looked at to tell a cavity from a shell that is inside out. One would do if
// shells never crossed; a cavity that breaks through its shell has most of its points inside.
constexpr std::size_t kWitnesses = 8;
// Winding numbers of points off the surface are whole; halves belong to points on it.
constexpr double kInside = 0.75;

void turn(Triangle& triangle) {
  std::swap(triangle[1], triangle[2]);
}

double areaOf(const medial::TriangleMesh& mesh, std::size_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm() / 2;
}

/// Sums the neighbours over edges with exactly two triangles.
struct Neighbours {
  struct Link {
    std::uint32_t triangle;
    bool agree;  ///< they run along the edge in opposite directions
  };
  std::vector<Link> links;
  std::vector<std::size_t> begin;  ///< per triangle, and the end

  explicit Neighbours(const medial::TriangleMesh& mesh) : begin(mesh.triangles.size() + 1, 0) {
    const std::vector<EdgeUse> uses = sortedEdgeUses(mesh);
    std::vector<std::pair<std::uint32_t, Link>> all;
    for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
      const std::span<const EdgeUse> edge = firstEdge(rest);
      rest = rest.subspan(edge.size());
      if (edge.size() != 2) continue;
      const bool agree = edge[0].forward != edge[1].forward;
      all.push_back({edge[0].triangle, {edge[1].triangle, agree}});
      all.push_back({edge[1].triangle, {edge[0].triangle, agree}});
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    links.reserve(all.size());
    for (const auto& [triangle, link] : all) {
      links.push_back(link);
      ++begin[triangle + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
  }

  [[nodiscard]] std::span<const Link> of(std::uint32_t triangle) const {
    return std::span(links).subspan(begin[triangle], begin[triangle + 1] - begin[triangle]);
  }
};

/// A closed part of a mesh.
struct Shell {
  std::vector<std::uint32_t> triangles;
  Eigen::AlignedBox3d bounds;
  double volume = 0;
  double area = 0;

  [[nodiscard]] bool flat() const { return isFlat({volume, area, bounds.diagonal().norm()}); }
};

/// Groups triangles into least parts that are closed by themselves: patches over edges with two triangles,
/// or, where such a patch is not closed, all that is connected over any edge.
std::vector<std::uint32_t> shellOfTriangles(const medial::TriangleMesh& mesh) {
  const std::vector<EdgeUse> uses = sortedEdgeUses(mesh);
  DisjointSets patches(mesh.triangles.size());
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    if (edge.size() == 2) patches.unite(edge[0].triangle, edge[1].triangle);
    rest = rest.subspan(edge.size());
  }
  // A patch is closed when its uses of every edge cancel out.
  std::vector<char> open(mesh.triangles.size(), 0);
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    rest = rest.subspan(edge.size());
    if (edge.size() == 2) continue;
    for (const EdgeUse& use : edge) {
      const std::uint32_t patch = patches.find(use.triangle);
      int balance = 0;
      for (const EdgeUse& other : edge)
        if (patches.find(other.triangle) == patch) balance += other.forward ? 1 : -1;
      if (balance != 0) open[patch] = 1;
    }
  }
  DisjointSets shells = patches;
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    rest = rest.subspan(edge.size());
    std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
    for (const EdgeUse& use : edge) {
      if (open[patches.find(use.triangle)] == 0) continue;
      if (last != std::numeric_limits<std::uint32_t>::max()) shells.unite(last, use.triangle);
      last = use.triangle;
    }
  }
  std::vector<std::uint32_t> shell(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) shell[t] = shells.find(t);
  return shell;
}

std::vector<Shell> shellsOf(const medial::TriangleMesh& mesh) {
  const std::vector<std::uint32_t> shellOf = shellOfTriangles(mesh);
  const Eigen::Vector3d origin = medial::boundsOf(mesh).center();
  std::vector<Shell> shells;
  std::vector<std::size_t> place(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (shellOf[t] == t) {
      place[t] = shells.size();
      shells.emplace_back();
    }
    Shell& shell = shells[place[shellOf[t]]];
    shell.triangles.push_back(t);
    for (std::size_t k = 0; k < 3; ++k) shell.bounds.extend(mesh.corner(t, k));
    const Eigen::Vector3d a = mesh.corner(t, 0) - origin;
    const Eigen::Vector3d b = mesh.corner(t, 1) - origin;
    const Eigen::Vector3d c = mesh.corner(t, 2) - origin;
    shell.volume += a.dot(b.cross(c)) / 6;
    shell.area += areaOf(mesh, t);
  }
  return shells;
}

/// How often the shell winds around a point off its surface.
double windingNumber(const medial::TriangleMesh& mesh, const Shell& shell, const Eigen::Vector3d& point) {
  double angle = 0;
  for (const std::uint32_t t : shell.triangles) {
    const Eigen::Vector3d a = mesh.corner(t, 0) - point;
    const Eigen::Vector3d b = mesh.corner(t, 1) - point;
    const Eigen::Vector3d c = mesh.corner(t, 2) - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    angle += 2 * std::atan2(a.dot(b.cross(c)), denominator);
  }
  return angle / (4 * std::numbers::pi);
}

bool liesInAnother(const medial::TriangleMesh& mesh, const std::vector<Shell>& shells, std::size_t index) {
  const std::vector<std::uint32_t>& own = shells[index].triangles;
  const std::size_t step = std::max<std::size_t>(own.size() / kWitnesses, 1);
  for (std::size_t i = 0; i < own.size(); i += step) {
    const Eigen::Vector3d& witness = mesh.corner(own[i], 0);
    for (std::size_t other = 0; other < shells.size(); ++other) {
      if (other == index || !shells[other].bounds.contains(witness)) continue;
      // Whichever way the other one is oriented: it may be about to be turned itself.
      if (std::abs(windingNumber(mesh, shells[other], witness)) > kInside) return true;
    }
  }
  return false;
}

}  // namespace

bool isFlat(const Thickness& thickness) {
  // The mean thickness is about 2 * volume / area; sums of coordinate products carry a rounding error of this
  // order.
  constexpr double kFlat = 1e-12;
  return std::abs(thickness.volume) <= kFlat * thickness.area * thickness.diagonal;
}

std::size_t countFlatShells(const medial::TriangleMesh& mesh) {
  const std::vector<Shell> shells = shellsOf(mesh);
  return static_cast<std::size_t>(
      std::count_if(shells.begin(), shells.end(), [](const Shell& shell) { return shell.flat(); }));
}

Agreement agreeWithNeighbours(medial::TriangleMesh mesh) {
  const Neighbours neighbours(mesh);
  Agreement result;
  std::vector<char> seen(mesh.triangles.size(), 0);
  std::vector<char> turned(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> patch;
  for (std::uint32_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    patch = {seed};
    double keptArea = 0;
    double turnedArea = 0;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const std::uint32_t t = patch[next];
      (turned[t] != 0 ? turnedArea : keptArea) += areaOf(mesh, t);
      for (const Neighbours::Link& link : neighbours.of(t)) {
        const char wanted = link.agree ? turned[t] : static_cast<char>(1 - turned[t]);
        if (seen[link.triangle] != 0) {
          result.orientable = result.orientable && turned[link.triangle] == wanted;
          continue;
        }
        seen[link.triangle] = 1;
        turned[link.triangle] = wanted;
        patch.push_back(link.triangle);
      }
    }
    if (turnedArea <= keptArea) continue;
    for (const std::uint32_t t : patch) turned[t] = static_cast<char>(1 - turned[t]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (turned[t] == 0) continue;
    turn(mesh.triangles[t]);
    ++result.flipped;
  }
  result.mesh = std::move(mesh);
  return result;
}

Outward turnShellsOutwards(medial::TriangleMesh mesh) {
  std::vector<Shell> shells = shellsOf(mesh);
  double total = 0;
  for (const Shell& shell : shells) total += shell.volume;
  const bool whole = total < 0;
  Outward result;
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (shells[s].flat()) continue;
    const bool negative = (shells[s].volume < 0) != whole;
    const bool turnIt = (negative && !liesInAnother(mesh, shells, s)) != whole;
    if (!turnIt) continue;
    for (const std::uint32_t t : shells[s].triangles) turn(mesh.triangles[t]);
    ++result.turnedShells;
  }
  result.mesh = std::move(mesh);
  return result;
}

}  // namespace spheretree::io
