// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/shard_layers.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <stdexcept>

#include "renderer/film/matte_names.h"

namespace morsel::render {
namespace {

constexpr int kFormat = 1;

template <class T>
constexpr std::size_t words_of() {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
  return sizeof(T) / 4;
}

std::string pixel_name(std::size_t half, std::size_t word) {
  return fmt::format("shard.pixel.{}.{:02}", half, word);
}
std::string group_name(std::size_t group, std::size_t half, std::size_t word) {
  return fmt::format("shard.group.{}.{}.{:02}", group, half, word);
}
std::string matte_name(std::size_t matte, std::size_t rank, const char* what) {
  return fmt::format("shard.matte.{}.{:02}.{}", matte, rank, what);
}

// Row by row in the window instead of tile by tile: for each pixel of each tile, visit(tile, place
// in the tile, place in the window).
template <class Visit>
void each_pixel(FilmSums& sums, Visit&& visit) {
  const Crop& all = sums.layout().window;
  const auto width = static_cast<std::size_t>(all.x1 - all.x0);
  for (int t = 0; t < sums.tile_count(); ++t)
    sums.with_tile(t, [&](TileSums& tile) {
      for (int y = tile.window.y0; y < tile.window.y1; ++y)
        for (int x = tile.window.x0; x < tile.window.x1; ++x)
          visit(
              tile, tile.offset(x, y),
              static_cast<std::size_t>(y - all.y0) * width + static_cast<std::size_t>(x - all.x0));
    });
}

std::size_t pixel_count(const FilmLayout& layout) {
  const Crop& w = layout.window;
  return static_cast<std::size_t>(w.x1 - w.x0) * static_cast<std::size_t>(w.y1 - w.y0);
}

// Names that a pixel of some matte has at most.
std::size_t most_names(FilmSums& sums, std::size_t matte) {
  std::size_t most = 0;
  each_pixel(sums, [&](TileSums& tile, std::size_t at, std::size_t) {
    most = std::max(most, tile.mattes[matte * tile.pixel_count() + at].counts().size());
  });
  return most;
}

// The planes of an array of T with one element a pixel, `element(tile, place)`.
template <class T, class Element>
void spread(FilmSums& sums, std::span<ExrWords> planes, Element&& element) {
  each_pixel(sums, [&](TileSums& tile, std::size_t at, std::size_t pixel) {
    std::uint32_t words[words_of<T>()];
    std::memcpy(words, &element(tile, at), sizeof words);
    for (std::size_t w = 0; w < planes.size(); ++w) planes[w].plane[pixel] = words[w];
  });
}
template <class T, class Element>
void gather(FilmSums& sums, std::span<const ExrWords> planes, Element&& element) {
  each_pixel(sums, [&](TileSums& tile, std::size_t at, std::size_t pixel) {
    std::uint32_t words[words_of<T>()];
    for (std::size_t w = 0; w < planes.size(); ++w) words[w] = planes[w].plane[pixel];
    std::memcpy(&element(tile, at), words, sizeof words);
  });
}

// Calls visit<T>(names of T's words, element) for every array but the mattes.
template <class Visit>
void each_array(const FilmLayout& layout, Visit&& visit) {
  for (std::size_t h = 0; h < layout.halves; ++h) {
    std::vector<std::string> names;
    for (std::size_t w = 0; w < words_of<PixelAccumulator>(); ++w)
      names.push_back(pixel_name(h, w));
    visit.template operator()<PixelAccumulator>(
        names, [h](TileSums& tile, std::size_t at) -> PixelAccumulator& {
          return tile.pixels[h * tile.pixel_count() + at];
        });
    for (std::size_t g = 0; g < layout.groups; ++g) {
      names.clear();
      for (std::size_t w = 0; w < words_of<ColorSum>(); ++w) names.push_back(group_name(g, h, w));
      const std::size_t first = g * layout.halves + h;
      visit.template operator()<ColorSum>(names,
                                          [first](TileSums& tile, std::size_t at) -> ColorSum& {
                                            return tile.groups[first * tile.pixel_count() + at];
                                          });
    }
  }
}

std::vector<ExrWords> blank_planes(const std::vector<std::string>& names, std::size_t pixels) {
  std::vector<ExrWords> planes;
  planes.reserve(names.size());
  for (const std::string& name : names)
    planes.push_back({name, std::vector<std::uint32_t>(pixels, 0u)});
  return planes;
}

std::string text_of(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute != nullptr ? attribute->value() : "";
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, shard.index);
  if (error != std::errc() || slash == end || *slash != '/' ||
      std::from_chars(slash + 1, end, shard.count).ptr != end || shard.index >= shard.count)
    throw std::runtime_error(fmt::format("morsel:shard is \"{}\"", text));
  return shard;
}

class Reader {
 public:
  Reader(const std::filesystem::path& path, ShardFile& shard) : in_(path.c_str()), shard_(shard) {
    shard.file = path;
    shard.header = in_.header();
    const Imf::Header& header = shard.header;
    const auto* format = header.findTypedAttribute<Imf::IntAttribute>("morsel:shardFormat");
    if (format == nullptr) throw std::runtime_error("not a shard; `render --shard` writes them");
    if (format->value() != kFormat || header.channels().findChannel(pixel_name(0, 0)) == nullptr)
      throw std::runtime_error(
          fmt::format("a shard of format {}; this program reads {}", format->value(), kFormat));
    shard.scene_hash = text_of(header, "morsel:sceneHash");
    const auto* spp = header.findTypedAttribute<Imf::IntAttribute>("morsel:spp");
    shard.spp = spp != nullptr ? spp->value() : 0;
    if (const auto* names =
            header.findTypedAttribute<Imf::StringVectorAttribute>("morsel:lightGroups"))
      shard.light_groups = names->value();
    shard.sums = std::make_unique<FilmSums>(layout(), parse_shard(text_of(header, "morsel:shard")));
  }

  void read() {
    const FilmLayout& layout = shard_.sums->layout();
    each_array(layout, [&]<class T>(const std::vector<std::string>& names, auto&& element) {
      const std::vector<ExrWords> planes = read_planes(names);
      gather<T>(*shard_.sums, planes, element);
    });
    // All shards together have no more samples than a scene may ask for.
    const std::uint32_t most = shard_.sums->shard().range(kMostSamples).size() + 1;
    for (int i = 0; i < shard_.sums->tile_count(); ++i)
      shard_.sums->with_tile(i, [&](const TileSums& tile) { tile.require_possible(most); });
    if (!layout.mattes) return;
    for (std::size_t m = 0; m < kMattes; ++m)
      for (std::size_t k = 0; has(matte_name(m, k, "id")); ++k) {
        const std::vector<ExrWords> planes =
            read_planes({matte_name(m, k, "id"), matte_name(m, k, "n")});
        each_pixel(*shard_.sums, [&](TileSums& tile, std::size_t at, std::size_t pixel) {
          tile.mattes[m * tile.pixel_count() + at].add(planes[0].plane[pixel],
                                                       planes[1].plane[pixel]);
        });
      }
  }

 private:
  bool has(const std::string& channel) const {
    return shard_.header.channels().findChannel(channel) != nullptr;
  }

  FilmLayout layout() const {
    const Imath::Box2i display = shard_.header.displayWindow(), data = shard_.header.dataWindow();
    RenderSettings settings;
    settings.width = display.max.x + 1;
    settings.height = display.max.y + 1;
    settings.crop = Crop{data.min.x, data.min.y, data.max.x + 1, data.max.y + 1};
    FilmLayout layout(settings, shard_.light_groups.size());
    layout.halves = has(pixel_name(1, 0)) ? 2 : 1;
    layout.mattes = has(std::string(kMatteLayers[0]) + "00.R");
    return layout;
  }

  std::vector<ExrWords> read_planes(const std::vector<std::string>& names) {
    std::vector<ExrWords> planes = blank_planes(names, pixel_count(shard_.sums->layout()));
    const Imath::Box2i data = shard_.header.dataWindow();
    const auto width = static_cast<std::size_t>(data.max.x - data.min.x) + 1;
    Imf::FrameBuffer frame;
    for (ExrWords& p : planes) {
      const Imf::Channel* channel = shard_.header.channels().findChannel(p.name);
      if (channel == nullptr || channel->type != Imf::UINT)
        throw std::runtime_error(fmt::format("has no channel {}", p.name));
      frame.insert(p.name, Imf::Slice::Make(Imf::UINT, p.plane.data(), data, 4, 4 * width));
    }
    in_.setFrameBuffer(frame);
    in_.readPixels(data.min.y, data.max.y);
    return planes;
  }

  Imf::InputFile in_;
  ShardFile& shard_;
};

}  // namespace

std::vector<ExrWords> shard_words(FilmSums& sums) {
  const FilmLayout& layout = sums.layout();
  const std::size_t pixels = pixel_count(layout);
  std::vector<ExrWords> all;
  const auto append = [&](std::vector<ExrWords> planes) {
    for (ExrWords& p : planes) all.push_back(std::move(p));
  };
  each_array(layout, [&]<class T>(const std::vector<std::string>& names, auto&& element) {
    std::vector<ExrWords> planes = blank_planes(names, pixels);
    spread<T>(sums, planes, element);
    append(std::move(planes));
  });
  if (!layout.mattes) return all;
  for (std::size_t m = 0; m < kMattes; ++m) {
    const std::size_t most = most_names(sums, m);
    for (std::size_t k = 0; k < most; ++k) {
      std::vector<ExrWords> planes =
          blank_planes({matte_name(m, k, "id"), matte_name(m, k, "n")}, pixels);
      each_pixel(sums, [&](TileSums& tile, std::size_t at, std::size_t pixel) {
        const auto& counts = tile.mattes[m * tile.pixel_count() + at].counts();
        if (k >= counts.size()) return;
        planes[0].plane[pixel] = counts[k].first;
        planes[1].plane[pixel] = counts[k].second;
      });
      append(std::move(planes));
    }
  }
  return all;
}

void add_shard_attributes(Imf::Header& header, const Scene& scene, FilmSums& sums,
                          const std::string& scene_hash) {
  header.insert("morsel:shardFormat", Imf::IntAttribute(kFormat));
  header.insert("morsel:sceneHash", Imf::StringAttribute(scene_hash));
  header.insert("morsel:shard",
                Imf::StringAttribute(fmt::format("{}/{}", sums.shard().index, sums.shard().count)));
  header.insert("morsel:denoise", Imf::IntAttribute(scene.settings.denoise));
  header.insert("morsel:lightGroups", Imf::StringVectorAttribute(scene.light_groups));
}

ShardFile read_shard(const std::filesystem::path& file) {
  try {
    ShardFile shard;
    Reader(file, shard).read();
    return shard;
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: cannot read: {}", file.string(), e.what()));
  }
}

}  // namespace morsel::render
