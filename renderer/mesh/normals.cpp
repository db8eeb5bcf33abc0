// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/normals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

namespace morsel::render {
namespace {

struct Place {
  Imath::V3f p;
  std::uint32_t group;
  bool operator==(const Place& other) const { return p == other.p && group == other.group; }
};
struct PlaceHash {
  std::size_t operator()(const Place& place) const {
    const Imath::V3f& p = place.p;
    std::size_t hash = place.group;
    for (int i = 0; i < 3; ++i) {
      const float x = p[i] + 0.0f;  // -0 and 0 compare equal, so they must hash equally
      std::uint32_t bits;
      std::memcpy(&bits, &x, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15ull;
    }
    return hash ^ (hash >> 32);
  }
};

// For each vertex the first vertex at the same position and of the same group.
std::vector<std::size_t> welded(const std::vector<Imath::V3f>& positions,
                                const std::vector<std::uint32_t>& groups) {
  std::unordered_map<Place, std::size_t, PlaceHash> first;
  first.reserve(positions.size());
  std::vector<std::size_t> weld(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    weld[i] = first.try_emplace({positions[i], groups.empty() ? 0 : groups[i]}, i).first->second;
  return weld;
}

// Of group_normal(): far beyond any length that a file gives its normals.
constexpr float kGroup = -1e30f;
bool is_group(const Imath::V3f& normal) { return normal.z < 0.1f * kGroup; }
std::uint32_t group_of(const Imath::V3f& normal) {
  return static_cast<std::uint32_t>(normal.y) << 16 | static_cast<std::uint32_t>(normal.x);
}

// Between two edges; atan2 keeps its accuracy for needles where acos loses it.
double angle(const Imath::V3d& a, const Imath::V3d& b) {
  return std::atan2(a.cross(b).length(), a.dot(b));
}

}  // namespace

Imath::V3f group_normal(std::uint32_t group) {
  return {static_cast<float>(group & 0xffffu), static_cast<float>(group >> 16), kGroup};
}

std::vector<Imath::V3f> smooth_normals(const TriangleMesh& mesh,
                                       const std::vector<std::uint32_t>& groups) {
  const std::vector<std::size_t> weld = welded(mesh.positions, groups);
  std::vector<Imath::V3d> sum(mesh.positions.size(), Imath::V3d(0.0));
  std::vector<Imath::V3d> fallback(mesh.positions.size(), Imath::V3d(0, 1, 0));
  for (const Imath::V3i& triangle : mesh.triangles) {
    Imath::V3d p[3];
    for (int i = 0; i < 3; ++i)
      p[i] = Imath::V3d(mesh.positions[static_cast<std::size_t>(triangle[i])]);
    const Imath::V3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
    if (!(cross.length() > 0)) continue;
    const Imath::V3d face = cross.normalized();
    for (int i = 0; i < 3; ++i) {
      const std::size_t vertex = weld[static_cast<std::size_t>(triangle[i])];
      sum[vertex] += face * angle(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
      fallback[vertex] = face;
    }
  }
  std::vector<Imath::V3f> normals(mesh.positions.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Imath::V3d& n = sum[weld[i]];
    // Angles are of order one, so a sum this small is rounding left over from opposing faces.
    const Imath::V3d unit = n.length() > 1e-6 ? n.normalized() : fallback[weld[i]];
    normals[i] = {static_cast<float>(unit.x), static_cast<float>(unit.y),
                  static_cast<float>(unit.z)};
  }
  return normals;
}

void normalise_normals(TriangleMesh& mesh) {
  if (std::any_of(mesh.normals.begin(), mesh.normals.end(), is_group)) {
    std::vector<std::uint32_t> groups(mesh.normals.size(), 0xffffffffu);  // given normals: none
    for (std::size_t i = 0; i < groups.size(); ++i)
      if (is_group(mesh.normals[i])) groups[i] = group_of(mesh.normals[i]);
    const std::vector<Imath::V3f> in_groups = smooth_normals(mesh, groups);
    for (std::size_t i = 0; i < groups.size(); ++i)
      if (is_group(mesh.normals[i])) mesh.normals[i] = in_groups[i];
  }
  std::vector<Imath::V3f> smooth;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Imath::V3f& normal = mesh.normals[i];
    const float length = normal.length();
    if (length > 0 && std::isfinite(length)) {
      normal /= length;
      continue;
    }
    if (smooth.empty()) smooth = smooth_normals(mesh);
    normal = smooth[i];
  }
}

}  // namespace morsel::render
