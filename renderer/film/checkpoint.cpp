// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "renderer/film/tile_codec.h"
#include "topology/section_file.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using topology::SectionFile;
using topology::SectionFormat;
using topology::SectionWriter;

constexpr SectionFormat kFormat{"MORSRNDR", 1, "checkpoint of a render"};

// Tiles are written in bands of rows: that much is copied at once.
constexpr int kMostBands = 512;

struct Bands {
  int tiles, per_band;
  explicit Bands(const FilmSums& sums)
      : tiles(sums.tile_count()),
        per_band(sums.tile_columns() * (sums.tile_rows() / kMostBands + 1)) {}
  int count() const { return (tiles + per_band - 1) / per_band; }
  int begin(int band) const { return band * per_band; }
  int end(int band) const { return std::min((band + 1) * per_band, tiles); }
  static std::string name(int band) { return fmt::format("tiles.{}", band); }
};

json layout_json(const FilmSums& sums) {
  const FilmLayout& l = sums.layout();
  return {{"resolution", {l.full_width, l.full_height}},
          {"crop", {l.window.x0, l.window.y0, l.window.x1, l.window.y1}},
          {"adaptive", l.halves == 2},
          {"light_groups", l.groups},
          {"cryptomatte", l.mattes},
          {"shard", fmt::format("{}/{}", sums.shard().index, sums.shard().count)}};
}

json parsed(const std::vector<std::byte>& bytes) {
  const auto* begin = reinterpret_cast<const char*>(bytes.data());
  const json document = json::parse(begin, begin + bytes.size(), nullptr, false);
  if (!document.is_object() || !document.contains("layout") || !document.contains("identity") ||
      !document.contains("seconds") || !document["seconds"].is_number())
    throw std::runtime_error("its description is not one");
  return document;
}

std::string shortened(const json& value) {
  std::string text = value.dump();
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

}  // namespace

std::string differences(const json& before, const json& now) {
  constexpr std::size_t kMost = 3;
  std::string text;
  std::size_t count = 0;
  for (const json& change : json::diff(before, now)) {
    if (++count > kMost) continue;
    const std::string path = change["path"].get<std::string>();
    const json::json_pointer pointer(path);
    const std::string old = before.contains(pointer) ? shortened(before[pointer]) : "absent";
    const std::string changed = change["op"] == "remove" ? "absent" : shortened(change["value"]);
    text += fmt::format("{}{} was {}, is {}", text.empty() ? "" : "; ",
                        path.empty() ? "everything" : path, old, changed);
  }
  if (count > kMost) text += fmt::format("; and {} more", count - kMost);
  return text;
}

std::uint64_t write_checkpoint(const std::filesystem::path& file, FilmSums& sums,
                               const CheckpointInfo& info) {
  try {
    SectionWriter writer(file, kFormat);
    const std::string description = json{
        {"identity", info.identity},
        {"layout", layout_json(sums)},
        {"seconds", info.seconds}}.dump();
    writer.add("render", std::as_bytes(std::span(description)), 1, true);
    const Bands bands(sums);
    std::vector<std::byte> bytes;
    for (int band = 0; band < bands.count(); ++band) {
      bytes.clear();
      for (int i = bands.begin(band); i < bands.end(band); ++i)
        sums.with_tile(i, [&](const TileSums& tile) { append_tile(tile, bytes); });
      writer.add(Bands::name(band), bytes, 1, true);
    }
    return writer.publish();
  } catch (const topology::CacheError& e) {
    throw CheckpointError(e.what());
  }
}

CheckpointInfo read_checkpoint(const std::filesystem::path& file, const json& identity,
                               FilmSums& sums) {
  try {
    const SectionFile sections(file, kFormat);
    const json description = parsed(sections.read("render"));
    const std::string changed = differences(description["identity"], identity);
    if (!changed.empty())
      throw std::runtime_error(
          fmt::format("the checkpoint is of another scene, or the scene has changed: {}", changed));
    const std::string moved = differences(description["layout"], layout_json(sums));
    if (!moved.empty())
      throw std::runtime_error(fmt::format("the checkpoint is of another picture: {}", moved));

    const Bands bands(sums);
    for (int band = 0; band < bands.count(); ++band) {
      const std::vector<std::byte> bytes = sections.read(Bands::name(band));
      std::span<const std::byte> rest = bytes;
      for (int i = bands.begin(band); i < bands.end(band); ++i)
        sums.with_tile(i, [&](TileSums& tile) { rest = read_tile(rest, tile); });
      if (!rest.empty()) throw std::runtime_error("a section is longer than its tiles");
    }
    return {description["identity"], description["seconds"].get<double>()};
  } catch (const topology::CacheError& e) {
    throw CheckpointError(e.what());
  } catch (const CheckpointError&) {
    throw;
  } catch (const std::exception& e) {
    throw CheckpointError(fmt::format("{}: {}", file.string(), e.what()));
  }
}

}  // namespace morsel::render
