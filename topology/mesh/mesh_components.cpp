// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "topology/mesh/mesh.h"
#include "topology/union_find.h"

namespace morsel::topology {

std::vector<MeshComponent> mesh_components(const Mesh& mesh) {
  UnionFind sets(mesh.positions.size());
  std::map<std::uint32_t, MeshComponent> by_id;
  for (const auto& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
    MeshComponent& c = by_id[mesh.components[t[0]]];
    ++c.triangles;
    const Imath::V3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], d = mesh.positions[t[2]];
    c.area += 0.5 * (b - a).cross(d - a).length();
    // Divergence theorem, about a vertex so that objects far from the origin lose no digits.
    const Imath::V3d origin = mesh.positions[0];
    c.volume += (a - origin).dot((b - origin).cross(d - origin)) / 6.0;
  }
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    MeshComponent& c = by_id[mesh.components[i]];
    ++c.vertices;
    if (sets.find(i) == i) ++c.surfaces;
  }
  std::vector<MeshComponent> result;
  for (auto& [id, c] : by_id) {
    c.component = id;
    // Closed: 2 E = 3 T.
    c.euler_characteristic =
        static_cast<std::int64_t>(c.vertices) - static_cast<std::int64_t>(c.triangles / 2);
    result.push_back(c);
  }
  return result;
}

}  // namespace morsel::topology
