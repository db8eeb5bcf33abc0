// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/task_arena.h>

#include <memory>
#include <string>
#include <vector>

#include "hypertexture_geom/c_api/handle.h"
#include "hypertexture_geom/embree/surface_query.h"
#include "hypertexture_geom/field/field.h"
#include "topology/morse/critical_point.h"

// What the handles of the C API stand for.
namespace morsel::c_api {

// NOLINTNEXTLINE(bugprone-exception-escape): that of Hypertexture.
struct FieldObject {
  static constexpr Kind kKind = Kind::kField;
  geom::Hypertexture hypertexture;
  std::string json;
};

struct TopologyObject {
  static constexpr Kind kKind = Kind::kTopology;
  std::shared_ptr<const topology::TopologyCache> cache;
  std::vector<topology::CriticalPoint> critical_points;  // empty where they were not asked for
  std::uint64_t bytes = 0;
};

struct GeometryObject {
  static constexpr Kind kKind = Kind::kGeometry;
  std::vector<bool> kept;
  std::unique_ptr<geom::HypertextureGeometry> geometry;
};

struct QueryObject {
  static constexpr Kind kKind = Kind::kQuery;
  std::shared_ptr<GeometryObject> geometry;
  std::unique_ptr<geom::SurfaceQuery> query;
};

// Runs `body` on that many threads (0: all).
template <class Body>
void on_threads(std::uint32_t threads, const Body& body) {
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute(body);
}

}  // namespace morsel::c_api
