// SPDX-License-Identifier: Apache-2.0
#include "tools/network_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <vector>

namespace morsel::tools {
namespace {

using Imath::V3d;
using topology::CriticalType;

constexpr int kSides = 8;    // around a tube
constexpr int kRings = 6;    // of a ball, between its poles
constexpr int kAround = 12;  // around a ball

class Triangles {
 public:
  void add_ball(const V3d& center, double radius, std::int64_t component) {
    const std::uint32_t first = size();
    add(center, V3d(0.0, 0.0, 1.0), radius, component);
    for (int i = 1; i <= kRings; ++i)
      for (int j = 0; j < kAround; ++j) {
        const double polar = std::numbers::pi * i / (kRings + 1);
        const double azimuth = 2.0 * std::numbers::pi * j / kAround;
        add(center,
            V3d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                std::cos(polar)),
            radius, component);
      }
    add(center, V3d(0.0, 0.0, -1.0), radius, component);
    for (int j = 0; j < kAround; ++j) {
      const std::uint32_t next = (j + 1) % kAround;
      faces_.push_back({first, first + 1 + j, first + 1 + next});
    }
    for (int i = 0; i + 1 < kRings; ++i) add_band(first + 1 + i * kAround, kAround);
    const std::uint32_t last = first + 1 + (kRings - 1) * kAround;
    for (int j = 0; j < kAround; ++j) {
      const std::uint32_t next = (j + 1) % kAround;
      faces_.push_back({last + j, last + kAround, last + next});
    }
  }

  // Open at its ends, where balls are.
  void add_tube(const std::vector<V3d>& path, double radius, std::int64_t component) {
    std::vector<V3d> points;
    for (const V3d& p : path)
      if (points.empty() || (p - points.back()).length() > 0.25 * radius) points.push_back(p);
    if (points.size() < 2) return;
    V3d side(0.0);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const V3d along =
          (points[std::min(i + 1, points.size() - 1)] - points[i == 0 ? 0 : i - 1]).normalized();
      // The side of the ring before, so that the tube does not twist.
      side -= along * side.dot(along);
      if (side.length() < 1e-3)
        side = along.cross(std::abs(along.x) < 0.7 ? V3d(1.0, 0.0, 0.0) : V3d(0.0, 1.0, 0.0));
      side.normalize();
      const V3d up = along.cross(side);
      const std::uint32_t first = size();
      for (int j = 0; j < kSides; ++j) {
        const double angle = -2.0 * std::numbers::pi * j / kSides;
        add(points[i], side * std::cos(angle) + up * std::sin(angle), radius, component);
      }
      if (i > 0) add_band(before, kSides);
      before = first;
    }
  }

  void write(std::ostream& out) const {
    out << fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty int "
        "component\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices_.size(), faces_.size());
    for (const Vertex& v : vertices_)
      out << fmt::format("{:.7g} {:.7g} {:.7g} {:.4g} {:.4g} {:.4g} {}\n", v.position.x,
                         v.position.y, v.position.z, v.normal.x, v.normal.y, v.normal.z,
                         v.component);
    for (const auto& f : faces_) out << fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
  }

 private:
  struct Vertex {
    V3d position, normal;
    std::int64_t component;
  };

  std::uint32_t size() const { return static_cast<std::uint32_t>(vertices_.size()); }
  void add(const V3d& center, const V3d& normal, double radius, std::int64_t component) {
    vertices_.push_back({center + radius * normal, normal, component});
  }
  // Between the ring of n vertices from `first` on and the next n.
  void add_band(std::uint32_t first, std::uint32_t n) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t k = (j + 1) % n;
      faces_.push_back({first + j, first + n + j, first + n + k});
      faces_.push_back({first + j, first + n + k, first + k});
    }
  }

  std::vector<Vertex> vertices_;
  std::vector<std::array<std::uint32_t, 3>> faces_;
};

std::int64_t component_of(const topology::CriticalPoint& p) {
  return p.set == topology::kNoSet ? -1 : static_cast<std::int64_t>(p.set);
}

}  // namespace

void write_network_ply(std::ostream& out, const topology::MorseComplex& complex,
                       const NetworkParts& parts, double radius) {
  Triangles triangles;
  for (const topology::CriticalPoint& p : complex.points)
    if ((parts.maxima && p.type == CriticalType::kMaximum) ||
        (parts.saddles && p.type == CriticalType::kSaddle2))
      triangles.add_ball(p.position, 2.0 * radius, component_of(p));
  if (parts.separatrices)
    for (const topology::Separatrix& s : complex.separatrices)
      triangles.add_tube(s.path, radius, component_of(complex.points[s.saddle]));
  triangles.write(out);
}

}  // namespace morsel::tools
