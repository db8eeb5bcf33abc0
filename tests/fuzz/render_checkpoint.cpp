// SPDX-License-Identifier: Apache-2.0
// The file that a render goes on from. Inputs that begin with its magic are taken as they are; all
// others are the sections of one, so that checksums do not keep the fuzzer out: a byte that chooses
// the picture, the length of the description in 16 bits, the description, the tiles.
#include <cstring>
#include <string>

#include "renderer/film/checkpoint.h"
#include "renderer/film/tile_codec.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"
#include "topology/section_file.h"

namespace {

using morsel::test::require;
using namespace morsel::render;

constexpr morsel::topology::SectionFormat kFormat{"MORSRNDR", 1, "checkpoint of a render"};

std::filesystem::path scratch() { return morsel::test::scratch_folder() / "render.checkpoint"; }

const nlohmann::json& identity() {
  static const nlohmann::json json{{"scene", "a scene"}, {"version", 1}};
  return json;
}

// A few pixels; two tiles where that is asked for.
FilmLayout layout_of(std::uint32_t choice) {
  RenderSettings settings;
  settings.width = (choice & 1u) != 0 ? FilmSums::kTileSize + 1 : 2;
  settings.height = 1;
  settings.cryptomatte = (choice & 2u) != 0;
  settings.noise_target = (choice & 4u) != 0 ? 0.1f : 0.0f;
  return FilmLayout(settings, (choice & 8u) != 0 ? 2 : 0);
}
Shard shard_of(std::uint32_t choice) { return (choice & 16u) != 0 ? Shard{1, 2} : Shard{}; }

std::vector<std::byte> bytes_of(FilmSums& sums) {
  std::vector<std::byte> bytes;
  for (int i = 0; i < sums.tile_count(); ++i)
    sums.with_tile(i, [&](const TileSums& tile) { append_tile(tile, bytes); });
  return bytes;
}

// What a render that goes on does with it.
void use(FilmSums& sums, const CheckpointInfo& info, std::uint32_t choice) {
  const auto bytes = bytes_of(sums);
  const Film film = sums.develop();
  sums.counts();
  sums.fireflies();
  for (int x = 0; x < film.full_width(); ++x) film.at(x, 0);
  write_checkpoint(scratch(), sums, info);
  FilmSums again(layout_of(choice), shard_of(choice));
  const CheckpointInfo info_again = read_checkpoint(scratch(), identity(), again);
  require(info_again.identity == info.identity && info_again.seconds == info.seconds,
          "a checkpoint's description survives writing");
  require(bytes_of(again) == bytes, "sums survive writing");
  // One more sample each, and the sums of another shard.
  PathSample sample;
  sample.radiance = V3f(1.0f);
  for (int i = 0; i < sums.tile_count(); ++i)
    sums.with_tile(i, [&](TileSums& tile) {
      for (PixelAccumulator& pixel : tile.pixels) pixel.add(sample, 0.5f, 0.5f, 7);
      for (ColorSum& group : tile.groups) group.add(sample.radiance);
    });
  sums.add(again);
  sums.develop();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 1 << 16;
  if (size > kLongest) return 0;
  std::uint32_t choice = 0;
  if (size >= 8 && std::memcmp(data, kFormat.magic, 8) == 0) {
    morsel::test::write_file(scratch(), std::as_bytes(std::span(data, size)));
  } else {
    morsel::test::Input in(data, size);
    choice = in.byte();
    const std::uint32_t description = in.word();
    morsel::topology::SectionWriter writer(scratch(), kFormat);
    writer.add("render", in.take(description), 1, true);
    writer.add("tiles.0", in.rest(), 1, true);
    writer.publish();
  }
  FilmSums sums(layout_of(choice), shard_of(choice));
  CheckpointInfo info;
  try {
    info = read_checkpoint(scratch(), identity(), sums);
  } catch (const CheckpointError&) {
    return 0;
  }
  use(sums, info, choice);
  return 0;
}
