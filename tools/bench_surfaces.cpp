// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_surfaces.h"

#include <fmt/format.h>

#include <malloc.h>

#include <cstring>
#include <utility>

#include "tools/bench_rays.h"

namespace morsel::tools {
namespace {

std::uint64_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Puts the geometry into the scene and builds the hierarchy.
void commit(BenchSurface& surface, render::GeometryHandle geometry) {
  rtcAttachGeometryByID(surface.scene.get(), geometry.get(), 0);
  rtcCommitScene(surface.scene.get());
  surface.device->check("building the acceleration structure of a benchmark");
}

}  // namespace

BenchSurface trace_hypertexture(std::shared_ptr<const geom::Field> field,
                                std::shared_ptr<const topology::TopologyCache> cache,
                                const geom::GeometryOptions& options) {
  BenchSurface s;
  s.device = std::make_unique<render::Device>();
  s.scene.reset(rtcNewScene(s.device->get()));
  const std::uint64_t heap = heap_bytes();
  double start = processor_seconds();
  s.hypertexture =
      std::make_unique<geom::HypertextureGeometry>(std::move(field), std::move(cache), options);
  s.geometry_seconds = processor_seconds() - start;
  s.geometry_bytes = heap_bytes() - heap;
  const std::uint64_t before = s.device->bytes();
  start = processor_seconds();
  commit(s, render::GeometryHandle(s.hypertexture->create(s.device->get())));
  s.bvh_seconds = processor_seconds() - start;
  s.bvh_bytes = s.device->bytes() - before;
  return s;
}

topology::Box kept_bounds(const topology::Topology& topology, const std::vector<bool>& kept) {
  topology::Box box;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) box.extendBy(topology.components[i].bounds);
  return box;
}

topology::Mesh mesh_kept(const geom::Hypertexture& hypertexture, const topology::Topology& topology,
                         double error, const topology::Execution& execution) {
  const std::vector<bool> kept =
      topology::kept_components(hypertexture.keep, topology.components, topology.octree());
  const topology::Box box = kept_bounds(topology, kept);
  if (box.isEmpty())
    throw std::runtime_error(
        fmt::format("{}: nothing is kept of it: nothing to measure", hypertexture.name));
  topology::MeshOptions options;
  options.error = error * (box.max - box.min).length();
  return topology::extract_mesh(*hypertexture.field, topology.octree(), kept, options, execution);
}

BenchSurface trace_mesh(const topology::Mesh& mesh) {
  BenchSurface s;
  s.device = std::make_unique<render::Device>();
  s.scene.reset(rtcNewScene(s.device->get()));
  rtcSetSceneFlags(s.scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(s.scene.get(), RTC_BUILD_QUALITY_HIGH);
  const std::uint64_t before = s.device->bytes();
  render::GeometryHandle geometry(rtcNewGeometry(s.device->get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* positions = static_cast<Imath::V3f*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(Imath::V3f), mesh.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(mesh.triangles[0]), mesh.triangles.size()));
  s.device->check("buffers of a benchmark's mesh");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    positions[i] = Imath::V3f(mesh.positions[i]);
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  geom::accept_all_rays(geometry.get());
  s.geometry_bytes = mesh.positions.size() * sizeof(Imath::V3f) +
                     mesh.triangles.size() * sizeof(mesh.triangles[0]);
  const double start = processor_seconds();
  rtcCommitGeometry(geometry.get());
  commit(s, std::move(geometry));
  s.bvh_seconds = processor_seconds() - start;
  s.bvh_bytes = s.device->bytes() - before - s.geometry_bytes;
  return s;
}

}  // namespace morsel::tools
