// SPDX-License-Identifier: Apache-2.0
// A file of bricks. Inputs that begin with its magic are taken as they are; all others are the
// sections of one, with the right fingerprint and checksums: a byte that chooses the field, the
// number of bricks in 16 bits, the bricks, the blocks.
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "hypertexture_geom/embree/brick_file.h"
#include "hypertexture_geom/embree/geometry.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"

namespace {

using morsel::test::require;
using namespace morsel;

// A field, its topology, and the name and metadata of the file that its bricks are kept in.
struct Subject {
  geom::Hypertexture hypertexture;
  std::shared_ptr<const topology::TopologyCache> cache;
  std::filesystem::path stem, file;
  nlohmann::json meta;

  explicit Subject(const char* noise) : stem(test::scratch_folder() / noise) {
    nlohmann::json geometry{
        {"name", noise},
        {"type", "hypertexture"},
        {"max_depth", 6},
        {"bounds", {{"min", {-1.5, -1.5, -1.5}}, {"max", {1.5, 1.5, 1.5}}}},
        {"field",
         {{"density", {{"type", "sphere"}}},
          {"modulations",
           {{{"type", "fbm"}, {"noise", noise}, {"amplitude", 0.2}, {"frequency", 1.5}}}}}}};
    hypertexture = geom::hypertexture_from_json(geometry, params::Place{"fuzz", ""});
    cache = std::make_shared<topology::TopologyCache>(geom::build_cache(hypertexture));
    require(!make().statistics().bricks_were_read, "there is no file yet");
    for (const auto& entry : std::filesystem::directory_iterator(test::scratch_folder()))
      if (entry.path().filename().string().starts_with(noise)) file = entry.path();
    const auto text = topology::SectionFile(file, geom::kBrickFormat).read("meta");
    const auto* first = reinterpret_cast<const char*>(text.data());
    meta = nlohmann::json::parse(first, first + text.size());
    require(make().statistics().bricks_were_read, "what was written can be read");
  }

  // Thrown in place of making bricks instead of those that cannot be read.
  struct Refused {};

  geom::HypertextureGeometry make() const {
    geom::GeometryOptions options;
    options.bricks.stem = stem;
    options.bricks.may_write = file.empty();
    options.bricks.warn = [](const std::string&) { throw Refused(); };
    return geom::HypertextureGeometry(hypertexture.field, cache, options);
  }
};

const Subject& subject(std::uint32_t choice) {
  static const Subject impulses("sparse_convolution"), perlin("perlin");
  return (choice & 1u) != 0 ? perlin : impulses;
}

void write_sections(test::Input in, const Subject& of) {
  constexpr std::size_t kBrick = sizeof(geom::Brick), kBlock = 128;
  const std::uint32_t count = in.word();
  const auto bricks = in.take(count * kBrick);
  const auto whole = bricks.first(bricks.size() / kBrick * kBrick);
  nlohmann::json meta = of.meta;
  const auto blocks = in.rest();
  meta["bricks"] = whole.size() / kBrick;
  // So many as they say, were they empty; a wrong number is a case of its own.
  std::uint64_t number = 0;
  for (std::size_t at = 0; at + kBlock <= blocks.size(); ++number) {
    std::uint32_t n[3];
    std::memcpy(n, blocks.data() + at + 104, sizeof n);
    at += kBlock + std::uint64_t{n[0]} * 28 + std::uint64_t{n[1]} * 8 + std::uint64_t{n[2]} * 4;
  }
  meta["blocks"] = number;
  meta["groups"] = 1;
  const std::string text = meta.dump();
  topology::SectionWriter writer(of.file, geom::kBrickFormat);
  writer.add("meta", std::as_bytes(std::span(text)));
  writer.add("bricks", whole, kBrick);
  writer.add("blocks.0", blocks);
  writer.publish();
}

// Rays and shading, whatever the bricks say: answers need not be right, but bounded.
void use(const geom::HypertextureGeometry& geometry) {
  const auto bricks = static_cast<std::uint32_t>(geometry.statistics().bricks);
  for (std::uint32_t i = 0; i < std::min(bricks, 64u); ++i) {
    const topology::Box box = geometry.primitive_bounds(i);
    const Imath::V3d middle = (box.min + box.max) * 0.5;
    for (const Imath::V3d& d : {Imath::V3d(1.0, 0.0, 0.0), Imath::V3d(-0.3, 0.5, 0.8)}) {
      const auto hit = geometry.intersect_brick(i, middle - d, d, 0.0, 2.0);
      require(!hit || (hit->t > 0.0 && hit->t < 2.0), "hits lie on the ray");
      if (hit) geometry.shade(i, Imath::V3f(middle + d * (hit->t - 1.0)));
    }
    geometry.detail(i, middle);
  }
}

void run(const std::uint8_t* data, std::size_t size) {
  if (size >= 8 && std::memcmp(data, geom::kBrickFormat.magic, 8) == 0) {
    test::write_file(subject(0).file, std::as_bytes(std::span(data, size)));
    use(subject(0).make());
  } else {
    test::Input in(data, size);
    const Subject& of = subject(in.byte());
    write_sections(in, of);
    use(of.make());
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 1 << 18;
  if (size > kLongest) return 0;
  try {
    run(data, size);
  } catch (const Subject::Refused&) {
  }
  return 0;
}
