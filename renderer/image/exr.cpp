// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/oiioversion.h>
#include <fmt/format.h>

#include <ctime>
#include <functional>
#include <stdexcept>
#include <vector>

#include "renderer/camera/camera.h"
#include "renderer/film/matte_names.h"
#include "renderer/image/denoise.h"
#include "topology/replacing_file.h"

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

constexpr auto kHalfMax = static_cast<float>(HALF_MAX);

struct Channel {
  std::string name;
  Imf::PixelType type;
  std::function<float(const Film&, int x, int y)> value;
};

void add_colors(std::vector<Channel>& channels, const std::string& prefix, const char* letters,
                Imf::PixelType type, const std::function<V3f(const Film&, int, int)>& value) {
  for (int c = 0; c < 3; ++c)
    channels.push_back({prefix + letters[c], type,
                        [value, c](const Film& f, int x, int y) { return value(f, x, y)[c]; }});
}

std::vector<Channel> channels_of(const Scene& scene, const RenderResult& result) {
  const Film& film = result.film;
  std::vector<Channel> list;
  const auto color = [&](const char* prefix, const char* letters, Imf::PixelType type,
                         V3f Pixel::*member) {
    add_colors(list, prefix, letters, type,
               [member](const Film& f, int x, int y) { return f.at(x, y).*member; });
  };
  const auto number = [&](const char* name, Imf::PixelType type, float Pixel::*member) {
    list.push_back(
        {name, type, [member](const Film& f, int x, int y) { return f.at(x, y).*member; }});
  };
  color("", "RGB", Imf::HALF, &Pixel::color);
  number("A", Imf::HALF, &Pixel::alpha);
  color("albedo.", "RGB", Imf::HALF, &Pixel::albedo);
  color("N.", "XYZ", Imf::HALF, &Pixel::normal);
  color("Ng.", "XYZ", Imf::HALF, &Pixel::geometric_normal);
  color("P.", "XYZ", Imf::FLOAT, &Pixel::position);
  color("variance.", "RGB", Imf::FLOAT, &Pixel::variance);
  number("Z", Imf::FLOAT, &Pixel::depth);
  number("component", Imf::FLOAT, &Pixel::component);
  number("steps", Imf::FLOAT, &Pixel::steps);
  list.push_back({"sampleCount", Imf::FLOAT, [](const Film& f, int x, int y) {
                    return static_cast<float>(f.at(x, y).samples);
                  }});
  if (const std::vector<V3f>& denoised = result.denoised; !denoised.empty())
    add_colors(list, "denoised.", "RGB", Imf::HALF, [&denoised](const Film& f, int x, int y) {
      return denoised[static_cast<std::size_t>(y - f.window().y0) *
                          static_cast<std::size_t>(f.width()) +
                      static_cast<std::size_t>(x - f.window().x0)];
    });
  for (std::size_t g = 0; g < film.group_count(); ++g)
    add_colors(list, "light_" + scene.light_groups[g] + ".", "RGB", Imf::HALF,
               [g](const Film& f, int x, int y) { return f.group(g, x, y); });
  for (std::size_t m = 0; m < film.matte_count(); ++m)
    for (int rank = 0; rank < cryptomatte::kRanks; ++rank) {
      const std::string layer = fmt::format("{}{:02}.", kMatteLayers[m], rank / 2);
      const auto r = static_cast<std::size_t>(rank);
      list.push_back(
          {layer + (rank % 2 == 0 ? "R" : "B"), Imf::FLOAT, [m, r](const Film& f, int x, int y) {
             return cryptomatte::as_float(f.matte(m, x, y)[r].id);
           }});
      list.push_back(
          {layer + (rank % 2 == 0 ? "G" : "A"), Imf::FLOAT,
           [m, r](const Film& f, int x, int y) { return f.matte(m, x, y)[r].coverage; }});
    }
  return list;
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

Imf::Header make_header(const Scene& scene, const RenderResult& result,
                        const std::vector<Channel>& channels) {
  const Film& film = result.film;
  const Crop& w = film.window();
  const Imath::Box2i display({0, 0}, {film.full_width() - 1, film.full_height() - 1});
  const Imath::Box2i data({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1});
  Imf::Header header(display, data, 1.0f, {0.0f, 0.0f}, 1.0f, Imf::INCREASING_Y,
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
  header.insert("morsel:maxDepth", Imf::IntAttribute(s.max_depth));
  // As text: an EXR integer is signed.
  header.insert("morsel:seed", Imf::StringAttribute(std::to_string(s.seed)));
  header.insert("morsel:exposure", Imf::FloatAttribute(s.exposure));
  header.insert("morsel:renderSeconds",
                Imf::DoubleAttribute(result.statistics.seconds_of("trace")));
  for (const auto& [phase, seconds] : result.statistics.seconds)
    header.insert("morsel:seconds:" + phase, Imf::DoubleAttribute(seconds));
  header.insert("morsel:fireflyPixels",
                Imf::DoubleAttribute(static_cast<double>(result.statistics.firefly_pixels)));
  header.insert("morsel:rays",
                Imf::DoubleAttribute(static_cast<double>(result.statistics.rays.total())));
  add_mattes(header, scene, film);
  for (const Channel& c : channels) header.channels().insert(c.name, Imf::Channel(c.type));
  return header;
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Scene& scene, const RenderResult& result) {
  const Film& film = result.film;
  const Crop& window = film.window();
  const auto width = static_cast<std::size_t>(film.width());
  const auto height = static_cast<std::size_t>(film.height());
  topology::ReplacingFile file(path);
  try {
    const std::vector<Channel> channels = channels_of(scene, result);
    const Imf::Header header = make_header(scene, result, channels);
    // One plane per channel, stored as the file has it.
    std::vector<std::vector<char>> planes;
    Imf::FrameBuffer frame;
    for (const Channel& c : channels) {
      const std::size_t size = c.type == Imf::HALF ? sizeof(Imath::half) : sizeof(float);
      std::vector<char>& plane = planes.emplace_back(size * width * height);
      std::size_t i = 0;
      for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x, ++i) {
          const float v = c.value(film, x, y);
          if (c.type == Imf::HALF)
            reinterpret_cast<Imath::half*>(plane.data())[i] =
                Imath::half(std::clamp(v, -kHalfMax, kHalfMax));
          else
            reinterpret_cast<float*>(plane.data())[i] = v;
        }
      frame.insert(c.name,
                   Imf::Slice::Make(c.type, plane.data(), header.dataWindow(), size, size * width));
    }
    Imf::OutputFile out(file.temporary_path().c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(film.height());
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path.string(), e.what()));
  }
  file.commit();
}

}  // namespace morsel::render
