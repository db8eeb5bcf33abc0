// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hypertexture_geom/c_api/call.h"
#include "hypertexture_geom/c_api/objects.h"
#include "hypertexture_geom/embree/geometry.h"

namespace morsel::c_api {
namespace {

constexpr std::size_t kHitV1 = sizeof(MorselHit);

struct QueryRay {
  explicit QueryRay(const MorselRay* ray)
      : origin(ray->origin[0], ray->origin[1], ray->origin[2]),
        direction(ray->direction[0], ray->direction[1], ray->direction[2]),
        tnear(ray->tnear),
        tfar(ray->tfar) {}
  Imath::V3f origin, direction;
  float tnear, tfar;
};

void write_hit(const QueryObject& query, const QueryRay& ray, const geom::SurfaceQuery::Hit& hit,
               void* out, std::size_t size) {
  MorselHit r{};
  r.t = hit.t;
  store(hit.gradient, r.gradient);
  r.prim_id = hit.brick;
  r.component = query.geometry->geometry->component_at(
      hit.brick, Imath::V3d(ray.origin) + hit.t * Imath::V3d(ray.direction));
  r.entering = hit.entering;
  write_entry(r, out, size);
}

void require_hit_size(std::size_t size) {
  require_struct_size(size, kHitV1, "MorselHit", "hit_size");
}

}  // namespace
}  // namespace morsel::c_api

using namespace morsel::c_api;

MorselResult morsel_create_query(MorselGeometry geometry, struct RTCDeviceTy* device,
                                 MorselQuery* query) {
  return call(geometry, [&] {
    auto object = std::make_shared<QueryObject>();
    object->geometry = shared_object_of<GeometryObject>(geometry);
    require(device, "device");
    require(query, "query");
    try {
      object->query =
          std::make_unique<morsel::geom::SurfaceQuery>(*object->geometry->geometry, device);
    } catch (const std::runtime_error& e) {
      throw ApiError(MORSEL_ERROR_EMBREE, e.what());
    }
    give(std::move(object), query);
  });
}

MorselResult morsel_retain_query(MorselQuery query) {
  return call(query, [&] { retain(query, Kind::kQuery); });
}

MorselResult morsel_release_query(MorselQuery query) {
  return call(query, [&] { release(query, Kind::kQuery); });
}

MorselResult morsel_query_all_hits(MorselQuery query, const MorselRay* ray, size_t hit_size,
                                   MorselHit* hits, size_t capacity, size_t* count) {
  return call(query, [&] {
    const auto& object = object_of<QueryObject>(query);
    require(ray, "ray");
    require(count, "count");
    if (capacity > 0) require(hits, "hits");
    require_hit_size(hit_size);
    const QueryRay r(ray);
    const auto found = object.query->all_hits(r.origin, r.direction, r.tnear, r.tfar);
    auto* out = reinterpret_cast<char*>(hits);
    for (size_t i = 0; i < std::min(found.size(), capacity); ++i)
      write_hit(object, r, found[i], out + i * hit_size, hit_size);
    *count = found.size();
  });
}

MorselResult morsel_query_first_hit(MorselQuery query, const MorselRay* ray, size_t hit_size,
                                    MorselHit* hit, int32_t* found) {
  return call(query, [&] {
    const auto& object = object_of<QueryObject>(query);
    require(ray, "ray");
    require(hit, "hit");
    require(found, "found");
    require_hit_size(hit_size);
    const QueryRay r(ray);
    const auto first = object.query->first_hit(r.origin, r.direction, r.tnear, r.tfar);
    if (first) write_hit(object, r, *first, hit, hit_size);
    *found = first.has_value();
  });
}

MorselResult morsel_query_any_hit(MorselQuery query, const MorselRay* ray, int32_t* found) {
  return call(query, [&] {
    const auto& object = object_of<QueryObject>(query);
    require(ray, "ray");
    require(found, "found");
    const QueryRay r(ray);
    *found = object.query->any_hit(r.origin, r.direction, r.tnear, r.tfar);
  });
}
