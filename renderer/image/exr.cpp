// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "renderer/camera/camera.h"
#include "topology/replacing_file.h"

namespace morsel::render {
namespace {

constexpr auto kHalfMax = static_cast<float>(HALF_MAX);

struct Channel {
  const char* name;
  Imf::PixelType type;
  float (*value)(const Pixel&);
};

constexpr Channel kChannels[] = {
    {"R", Imf::HALF, [](const Pixel& p) { return p.color.x; }},
    {"G", Imf::HALF, [](const Pixel& p) { return p.color.y; }},
    {"B", Imf::HALF, [](const Pixel& p) { return p.color.z; }},
    {"A", Imf::HALF, [](const Pixel& p) { return p.alpha; }},
    {"albedo.R", Imf::HALF, [](const Pixel& p) { return p.albedo.x; }},
    {"albedo.G", Imf::HALF, [](const Pixel& p) { return p.albedo.y; }},
    {"albedo.B", Imf::HALF, [](const Pixel& p) { return p.albedo.z; }},
    {"N.X", Imf::HALF, [](const Pixel& p) { return p.normal.x; }},
    {"N.Y", Imf::HALF, [](const Pixel& p) { return p.normal.y; }},
    {"N.Z", Imf::HALF, [](const Pixel& p) { return p.normal.z; }},
    {"variance.R", Imf::FLOAT, [](const Pixel& p) { return p.variance.x; }},
    {"variance.G", Imf::FLOAT, [](const Pixel& p) { return p.variance.y; }},
    {"variance.B", Imf::FLOAT, [](const Pixel& p) { return p.variance.z; }},
    {"Z", Imf::FLOAT, [](const Pixel& p) { return p.depth; }},
    {"component", Imf::FLOAT, [](const Pixel& p) { return p.component; }},
    {"sampleCount", Imf::FLOAT, [](const Pixel& p) { return static_cast<float>(p.samples); }},
};

Imf::Header make_header(const Scene& scene, const RenderResult& result) {
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
  header.insert("morsel:spp", Imf::IntAttribute(s.spp));
  header.insert("morsel:maxDepth", Imf::IntAttribute(s.max_depth));
  // As text: an EXR integer is signed.
  header.insert("morsel:seed", Imf::StringAttribute(std::to_string(s.seed)));
  header.insert("morsel:exposure", Imf::FloatAttribute(s.exposure));
  header.insert("morsel:renderSeconds",
                Imf::DoubleAttribute(result.statistics.seconds_of("trace")));
  header.insert("morsel:rays",
                Imf::DoubleAttribute(static_cast<double>(result.statistics.rays.total())));
  for (const Channel& c : kChannels) header.channels().insert(c.name, Imf::Channel(c.type));
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
    const Imf::Header header = make_header(scene, result);
    // One plane per channel, stored as the file has it.
    std::vector<std::vector<char>> planes;
    Imf::FrameBuffer frame;
    for (const Channel& c : kChannels) {
      const std::size_t size = c.type == Imf::HALF ? sizeof(Imath::half) : sizeof(float);
      std::vector<char>& plane = planes.emplace_back(size * width * height);
      std::size_t i = 0;
      for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x, ++i) {
          const float v = c.value(film.at(x, y));
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
