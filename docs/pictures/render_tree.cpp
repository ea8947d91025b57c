// SPDX-License-Identifier: GPL-3.0-or-later
//
// Draws the pictures of this documentation: a mesh and the levels of its sphere tree side by side, shaded
// orthographic z-buffer images, written as PPM.
//   render_tree MESH TREE.sph OUT.ppm [YAW PITCH]      angles in degrees
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "io/mesh_import.hpp"
#include "io/tree_files.hpp"

namespace {

using Eigen::Vector3d;

constexpr int kPanel = 400;       // pixels along a side
constexpr int kSupersample = 3;   // squared samples per pixel
constexpr double kMargin = 0.5;  // half the panel, in diagonals of the mesh's box

const Vector3d kLight = Vector3d(-0.5, 0.7, 0.9).normalized();

class Panel {
 public:
  Panel(const Vector3d& center, double halfWidth, const Eigen::Matrix3d& view)
      : center_(center), halfWidth_(halfWidth), view_(view) {}

  void draw(const spheretree::medial::TriangleMesh& mesh, const Vector3d& color) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::array<Vector3d, 3> p{toScreen(mesh.corner(t, 0)), toScreen(mesh.corner(t, 1)),
                                      toScreen(mesh.corner(t, 2))};
      const Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
      if (normal.z() == 0) continue;
      const Vector3d unit = normal.normalized() * (normal.z() > 0 ? 1 : -1);
      const auto [low, high] = extent({p[0], p[1], p[2]}, 0);
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          const Vector3d q(x, y, 0);
          std::array<double, 3> w{};
          for (std::size_t k = 0; k < 3; ++k) {
            const Vector3d a = p[(k + 1) % 3] - q;
            const Vector3d b = p[(k + 2) % 3] - q;
            w[k] = (a.x() * b.y() - a.y() * b.x()) / normal.z();
          }
          if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
          put(x, y, w[0] * p[0].z() + w[1] * p[1].z() + w[2] * p[2].z(), unit, color);
        }
      }
    }
  }

  void draw(const spheretree::Sphere& ball, const Vector3d& color) {
    const Vector3d c = toScreen({static_cast<double>(ball.center.x), static_cast<double>(ball.center.y),
                                 static_cast<double>(ball.center.z)});
    const double r = static_cast<double>(ball.radius) / halfWidth_ * kSize / 2;
    const auto [low, high] = extent({c}, r);
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        const double dx = x - c.x();
        const double dy = y - c.y();
        const double rest = r * r - dx * dx - dy * dy;
        if (rest < 0) continue;
        const double dz = std::sqrt(rest);
        put(x, y, c.z() + dz, Vector3d(dx, dy, dz) / r, color);
      }
    }
  }

  [[nodiscard]] Vector3d pixel(int x, int y) const {
    Vector3d sum = Vector3d::Zero();
    for (int j = 0; j < kSupersample; ++j) {
      for (int i = 0; i < kSupersample; ++i) {
        sum += color_[static_cast<std::size_t>((y * kSupersample + j) * kSize + x * kSupersample + i)];
      }
    }
    return sum / (kSupersample * kSupersample);
  }

 private:
  static constexpr int kSize = kPanel * kSupersample;

  [[nodiscard]] Vector3d toScreen(const Vector3d& p) const {
    const Vector3d q = view_ * (p - center_) / halfWidth_ * (kSize / 2.0);
    return {q.x() + kSize / 2.0, q.y() + kSize / 2.0, q.z()};
  }

  static std::array<std::array<int, 2>, 2> extent(const std::vector<Vector3d>& points, double grow) {
    std::array<std::array<int, 2>, 2> box{{{kSize, kSize}, {-1, -1}}};
    for (const Vector3d& p : points) {
      for (std::size_t k = 0; k < 2; ++k) {
        const double v = p[static_cast<int>(k)];
        box[0][k] = std::clamp(std::min(box[0][k], static_cast<int>(std::floor(v - grow))), 0, kSize - 1);
        box[1][k] = std::clamp(std::max(box[1][k], static_cast<int>(std::ceil(v + grow))), 0, kSize - 1);
      }
    }
    return box;
  }

  void put(int x, int y, double z, const Vector3d& normal, const Vector3d& color) {
    const auto at = static_cast<std::size_t>(y * kSize + x);
    if (z <= depth_[at]) return;
    depth_[at] = z;
    const double light = 0.25 + 0.75 * std::max(0.0, normal.dot(kLight));
    const double rim = 0.75 + 0.25 * std::max(0.0, normal.z());
    color_[at] = color * light * rim;
  }

  Vector3d center_;
  double halfWidth_;
  Eigen::Matrix3d view_;
  std::vector<double> depth_ = std::vector<double>(kSize * kSize, -std::numeric_limits<double>::infinity());
  std::vector<Vector3d> color_ = std::vector<Vector3d>(kSize * kSize, Vector3d(1, 1, 1));
};

/// Well-spread hues: the golden ratio around the colour circle.
Vector3d hue(std::size_t index) {
  const double h = std::fmod(0.11 + static_cast<double>(index) * 0.6180339887498949, 1.0) * 6;
  const auto ramp = [&](double shift) {
    return std::clamp(std::abs(std::fmod(h + shift, 6.0) - 3) - 1, 0.0, 1.0);
  };
  return Vector3d(0.35, 0.35, 0.35) + 0.6 * Vector3d(ramp(0), ramp(4), ramp(2));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) {
    std::fputs("usage: render_tree MESH TREE.sph OUT.ppm [YAW PITCH]\n", stderr);
    return 2;
  }
  const auto mesh = spheretree::io::importMesh(argv[1]);
  const auto file = spheretree::io::readTree(argv[2]);
  if (!mesh || !file) {
    std::fprintf(stderr, "render_tree: %s\n", (!mesh ? mesh.error() : file.error()).message.c_str());
    return 3;
  }
  constexpr double kDegree = std::numbers::pi / 180;
  const double yaw = (argc == 6 ? std::atof(argv[4]) : 30) * kDegree;
  const double pitch = (argc == 6 ? std::atof(argv[5]) : 20) * kDegree;
  const Eigen::Matrix3d view =
      (Eigen::AngleAxisd(pitch, Vector3d::UnitX()) * Eigen::AngleAxisd(-yaw, Vector3d::UnitY()))
          .toRotationMatrix();
  const Vector3d center = spheretree::medial::boundsOf(mesh->mesh).center();
  const double halfWidth = kMargin * spheretree::medial::diagonalOf(mesh->mesh);

  std::vector<Panel> panels;
  panels.emplace_back(center, halfWidth, view);
  panels.back().draw(mesh->mesh, Vector3d(0.8, 0.8, 0.85));
  const spheretree::SphereTree& tree = file->tree;
  for (std::size_t depth = 1; depth < tree.levelCount(); ++depth) {
    panels.emplace_back(center, halfWidth, view);
    for (const spheretree::Node& node : tree.level(depth)) {
      // The colour is that of the ancestor on level 1: families stay together.
      const spheretree::Node* ancestor = &node;
      while (ancestor->parent != 0) ancestor = &tree.nodes()[ancestor->parent];
      panels.back().draw(node.ball, hue(static_cast<std::size_t>(ancestor - tree.level(1).data())));
    }
  }

  std::ofstream out(argv[3], std::ios::binary);
  out << "P6\n" << kPanel * static_cast<int>(panels.size()) << ' ' << kPanel << "\n255\n";
  for (int y = kPanel - 1; y >= 0; --y) {
    for (const Panel& panel : panels) {
      for (int x = 0; x < kPanel; ++x) {
        const Vector3d c = panel.pixel(x, y);
        for (int k = 0; k < 3; ++k) {
          out.put(
              static_cast<char>(static_cast<std::uint8_t>(std::lround(255 * std::clamp(c[k], 0.0, 1.0)))));
        }
      }
    }
  }
  return out.good() ? 0 : 6;
}
