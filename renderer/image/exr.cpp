// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/exr.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/oiioversion.h>

#include <cmath>
#include <ctime>

#include "renderer/camera/camera.h"
#include "renderer/film/matte_names.h"
#include "renderer/image/denoise.h"
#include "renderer/image/exr_layers.h"
#include "renderer/image/shard_layers.h"

namespace morsel::render {
namespace {

// As the attribute capDate has it.
std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &parts);
  return text;
}

void add_mattes(Imf::Header& header, const Scene& scene, const Film& film) {
  if (film.matte_count() == 0) return;
  const MatteNames names(scene);
  for (std::size_t m = 0; m < kMattes; ++m) {
    const std::string key = "cryptomatte/" + cryptomatte::key_of(kMatteLayers[m]) + "/";
    const auto set = [&](const char* what, const std::string& value) {
      header.insert(key + what, Imf::StringAttribute(value));
    };
    set("name", kMatteLayers[m]);
    set("hash", "MurmurHash3_32");
    set("conversion", "uint32_to_float32");
    set("manifest", cryptomatte::manifest_of(names.manifest(static_cast<Matte>(m), film)));
  }
}

// Width of what the picture shows, one unit before a perspective camera; see OpenEXR's
// screenWindowWidth.
float screen_width(const Scene& scene) {
  const SceneCamera& c = scene.camera;
  const float aspect =
      static_cast<float>(scene.settings.width) / static_cast<float>(scene.settings.height);
  switch (c.projection) {
    case Projection::kPerspective:
      return 2.0f * std::tan(c.vertical_fov * (kPi / 360.0f)) * aspect;
    case Projection::kOrthographic:
      return c.height * aspect;
    case Projection::kSpherical:
      break;
  }
  return 1.0f;
}

Imf::Header make_header(const Scene& scene, const RenderResult& result) {
  const Film& film = result.film;
  const Crop& w = film.window();
  const Imath::Box2i display({0, 0}, {film.full_width() - 1, film.full_height() - 1});
  const Imath::Box2i data({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1});
  Imf::Header header(display, data, 1.0f, {0.0f, 0.0f}, screen_width(scene), Imf::INCREASING_Y,
                     Imf::ZIP_COMPRESSION);
  const RenderSettings& s = scene.settings;
  const Camera camera(scene.camera, s.width, s.height);
  Imf::addWorldToCamera(header, camera.world_to_camera());
  Imf::addWorldToNDC(header, camera.world_to_ndc());
  header.insert("software", Imf::StringAttribute("Morsel " MORSEL_VERSION));
  header.insert("morsel:embree", Imf::StringAttribute(embree_version()));
  header.insert("morsel:openimageio", Imf::StringAttribute(OIIO_VERSION_STRING));
  header.insert("morsel:openexr", Imf::StringAttribute(OPENEXR_VERSION_STRING));
  if (!result.denoised.empty())
    header.insert("morsel:denoiser",
                  Imf::StringAttribute("Open Image Denoise " + denoiser_version()));
  Imf::addCapDate(header, local_time());
  header.insert("morsel:spp", Imf::IntAttribute(s.spp));
  if (s.noise_target > 0.0f) {  // then spp is the most that a pixel gets
    header.insert("morsel:noiseTarget", Imf::FloatAttribute(s.noise_target));
    header.insert("morsel:minSpp", Imf::IntAttribute(s.min_spp));
  }
  header.insert("morsel:maxDepth", Imf::IntAttribute(s.max_depth));
  // As text: an EXR integer is signed.
  header.insert("morsel:seed", Imf::StringAttribute(std::to_string(s.seed)));
  header.insert("morsel:complete", Imf::IntAttribute(result.end == RenderEnd::kDone));
  header.insert("morsel:exposure", Imf::FloatAttribute(s.exposure));
  header.insert("morsel:renderSeconds",
                Imf::DoubleAttribute(result.statistics.earlier_seconds +
                                     result.statistics.seconds_of("trace")));
  for (const auto& [phase, seconds] : result.statistics.seconds)
    header.insert("morsel:seconds:" + phase, Imf::DoubleAttribute(seconds));
  header.insert("morsel:fireflyPixels",
                Imf::DoubleAttribute(static_cast<double>(result.statistics.firefly_pixels)));
  header.insert("morsel:rays",
                Imf::DoubleAttribute(static_cast<double>(result.statistics.rays.total())));
  add_mattes(header, scene, film);
  return header;
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Scene& scene, const RenderResult& result) {
  write_planes(path, make_header(scene, result),
               picture_channels(scene.light_groups, result.film, result.denoised), result.film);
}

void write_shard(const std::filesystem::path& path, const Scene& scene, const RenderResult& result,
                 FilmSums& sums, const std::string& scene_hash) {
  Imf::Header header = make_header(scene, result);
  add_shard_attributes(header, scene, sums, scene_hash);
  write_planes(path, header, picture_channels(scene.light_groups, result.film, result.denoised),
               result.film, shard_words(sums));
}

}  // namespace morsel::render
