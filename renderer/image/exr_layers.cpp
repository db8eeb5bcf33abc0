// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/exr_layers.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <fmt/format.h>

#include <stdexcept>

#include "renderer/film/matte_names.h"
#include "topology/replacing_file.h"

namespace morsel::render {
namespace {

constexpr auto kHalfMax = static_cast<float>(HALF_MAX);

void add_colors(std::vector<ExrChannel>& channels, const std::string& prefix, const char* letters,
                Imf::PixelType type, const std::function<V3f(const Film&, int, int)>& value) {
  for (int c = 0; c < 3; ++c)
    channels.push_back({prefix + letters[c], type,
                        [value, c](const Film& f, int x, int y) { return value(f, x, y)[c]; }});
}

}  // namespace

std::vector<ExrChannel> picture_channels(const std::vector<std::string>& light_groups,
                                         const Film& film, const std::vector<V3f>& denoised) {
  std::vector<ExrChannel> list;
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
  if (!denoised.empty())
    add_colors(list, "denoised.", "RGB", Imf::HALF, [&denoised](const Film& f, int x, int y) {
      return denoised[static_cast<std::size_t>(y - f.window().y0) *
                          static_cast<std::size_t>(f.width()) +
                      static_cast<std::size_t>(x - f.window().x0)];
    });
  for (std::size_t g = 0; g < film.group_count(); ++g)
    add_colors(list, "light_" + light_groups[g] + ".", "RGB", Imf::HALF,
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

void write_planes(const std::filesystem::path& path, Imf::Header header,
                  const std::vector<ExrChannel>& channels, const Film& film,
                  const std::vector<ExrWords>& words) {
  const Crop& window = film.window();
  const auto width = static_cast<std::size_t>(film.width());
  const auto height = static_cast<std::size_t>(film.height());
  topology::ReplacingFile file(path);
  try {
    // One plane per channel, stored as the file has it.
    std::vector<std::vector<char>> planes;
    Imf::FrameBuffer frame;
    const auto add = [&](const std::string& name, Imf::PixelType type, const char* plane,
                         std::size_t size) {
      header.channels().insert(name, Imf::Channel(type));
      frame.insert(name, Imf::Slice::Make(type, plane, header.dataWindow(), size, size * width));
    };
    for (const ExrChannel& c : channels) {
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
      add(c.name, c.type, plane.data(), size);
    }
    for (const ExrWords& w : words)
      add(w.name, Imf::UINT, reinterpret_cast<const char*>(w.plane.data()), sizeof w.plane[0]);
    Imf::OutputFile out(file.temporary_path().c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(film.height());
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: cannot write: {}", path.string(), e.what()));
  }
  file.commit();
}

}  // namespace morsel::render
