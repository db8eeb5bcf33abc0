// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "topology/mesh/mesh.h"

namespace morsel::topology::testing {

// Every edge belongs to two triangles, which traverse it in opposite directions; the triangles
// around each vertex form one fan; none is degenerate; no vertex is unused.
inline void expect_closed_manifold(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.components.size(), mesh.positions.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>
      opposite;  // directed edge -> tip
  std::vector<std::uint32_t> valence(mesh.positions.size(), 0);
  std::vector<std::uint32_t> some_neighbour(mesh.positions.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      ASSERT_LT(a, mesh.positions.size());
      ASSERT_TRUE(opposite.emplace(std::pair(a, b), c).second)
          << "an edge with two equal directions";
      ++valence[a];
      some_neighbour[a] = b;
    }
    const Imath::V3d p = mesh.positions[t[0]], q = mesh.positions[t[1]], r = mesh.positions[t[2]];
    ASSERT_GT((q - p).cross(r - p).length(), 0.0);
    ASSERT_EQ(mesh.components[t[0]], mesh.components[t[1]]);
    ASSERT_EQ(mesh.components[t[0]], mesh.components[t[2]]);
  }
  for (const auto& [edge, tip] : opposite)
    ASSERT_EQ(opposite.count({edge.second, edge.first}), 1u) << "an edge of one triangle only";
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    ASSERT_GE(valence[v], 3u);
    std::uint32_t steps = 0, at = some_neighbour[v];
    do {
      at = opposite.at({v, at});
      ++steps;
      ASSERT_LE(steps, valence[v]);
    } while (at != some_neighbour[v]);
    ASSERT_EQ(steps, valence[v]) << "a vertex where surfaces touch";
  }
}

// A bound on the distance of `x` from F = 0 that is found by walking along the gradient, in steps
// that double: a sign change within `reach`. Infinite if none was met.
inline double distance_to_surface(const ScalarField& field, const Imath::V3d& x, double reach) {
  const Jet jet = field.jet(x);
  if (jet.value == 0.0) return 0.0;
  const Imath::V3d direction = jet.gradient.normalized() * (jet.value > 0.0 ? -1.0 : 1.0);
  const auto crossed = [&](double t) {
    return (field.value(x + direction * t) >= 0.0) != (jet.value >= 0.0);
  };
  double lo = 0.0, hi = reach * std::ldexp(1.0, -30);
  while (!crossed(hi)) {
    if (hi >= reach) return std::numeric_limits<double>::infinity();
    lo = hi;
    hi = std::min(2.0 * hi, reach);
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (crossed(middle) ? hi : lo) = middle;
  }
  return hi;
}

// `count` points, uniformly distributed over the triangles (not over the area: small ones count).
inline std::vector<Imath::V3d> points_on(const Mesh& mesh, std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Imath::V3d> points;
  while (points.size() < count && !mesh.triangles.empty()) {
    const auto& t = mesh.triangles[std::uniform_int_distribution<std::size_t>(
        0, mesh.triangles.size() - 1)(random)];
    double u = unit(random), v = unit(random);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    points.push_back(mesh.positions[t[0]] * (1.0 - u - v) + mesh.positions[t[1]] * u +
                     mesh.positions[t[2]] * v);
  }
  return points;
}

// All within the error of F = 0, unit normals, and triangles that face away from S: a triangle
// whose height is well above the error can't be tilted by more than a few degrees.
inline void expect_near_surface(const Mesh& mesh, const ScalarField& field, double error,
                                std::size_t points) {
  EXPECT_LE(mesh.error_bound, error);
  for (const Imath::V3f& n : mesh.normals) ASSERT_NEAR(n.length(), 1.0f, 1e-5f);
  for (const auto& t : mesh.triangles) {
    const Imath::V3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Imath::V3d n = (b - a).cross(c - a);
    const double longest =
        std::sqrt(std::max({(b - a).length2(), (c - b).length2(), (a - c).length2()}));
    if (n.length() / longest < 4.0 * mesh.error_bound) continue;  // the height
    ASSERT_LT(n.dot(field.jet((a + b + c) / 3.0).gradient), 0.0);
  }
  double largest = 0.0;
  for (const Imath::V3d& x : points_on(mesh, points))
    largest = std::max(largest, distance_to_surface(field, x, 1.01 * error));
  EXPECT_LE(largest, error);
  EXPECT_LE(largest, mesh.error_bound * (1.0 + 1e-9) + 1e-13);
}

inline Box cube(double half, const Imath::V3d& centre = Imath::V3d(0.0)) {
  return {centre - Imath::V3d(half), centre + Imath::V3d(half)};
}

inline Topology certify_in(const ScalarField& field, const Box& box) {
  CertifyOptions options;
  options.box = box;
  return certify(field, options);
}

inline Mesh mesh_of(const ScalarField& field, const Topology& topology, double error,
                    const std::string& keep = "all", int max_depth = kMaxDepth) {
  MeshOptions options;
  options.error = error;
  options.max_depth = max_depth;
  return extract_mesh(
      field, topology.octree(),
      kept_components(KeepRule::parse(keep), topology.components, topology.octree()), options);
}

}  // namespace morsel::topology::testing
