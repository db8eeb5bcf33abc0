// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/tile_codec.h"

#include <cstring>
#include <stdexcept>

namespace morsel::render {
namespace {

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <class T>
  void array(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto from = std::as_bytes(std::span(values));
    bytes_.insert(bytes_.end(), from.begin(), from.end());
  }
  void number(std::uint64_t value) {
    const auto from = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), from.begin(), from.end());
  }

 private:
  std::vector<std::byte>& bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // As many values as the vector has.
  template <class T>
  void array(std::vector<T>& values) {
    take(std::as_writable_bytes(std::span(values)));
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    take(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }
  // Of things that take at least `least` bytes each.
  std::uint64_t count(std::size_t least) {
    const std::uint64_t n = number();
    if (n > bytes_.size() / least) throw std::runtime_error("a list is longer than the file");
    return n;
  }
  std::span<const std::byte> rest() const { return bytes_; }

 private:
  void take(std::span<std::byte> out) {
    if (out.size() > bytes_.size()) throw std::runtime_error("it ends too early");
    if (!out.empty()) std::memcpy(out.data(), bytes_.data(), out.size());
    bytes_ = bytes_.subspan(out.size());
  }
  std::span<const std::byte> bytes_;
};

}  // namespace

void append_tile(const TileSums& tile, std::vector<std::byte>& bytes) {
  Writer out(bytes);
  out.array(tile.pixels);
  out.array(tile.needed);
  out.array(tile.groups);
  for (const cryptomatte::Accumulator& matte : tile.mattes) {
    out.number(matte.counts().size());
    for (const auto& [id, samples] : matte.counts()) out.number(std::uint64_t{id} << 32 | samples);
  }
  const SampleCounts& c = tile.counts;
  for (const std::uint64_t n :
       {c.rays.camera, c.rays.bounce, c.rays.shadow, c.samples, c.non_finite})
    out.number(n);
  for (const RayCost& cost : c.rays.costs) {
    for (const std::uint64_t n : cost.rays) out.number(n);
    out.number(cost.evaluations);
    out.number(cost.filtered);
  }
  out.number(c.components.size());
  for (const auto& [instance, component] : c.components)
    out.number(std::uint64_t{instance} << 32 | component);
}

std::span<const std::byte> read_tile(std::span<const std::byte> bytes, TileSums& tile) {
  const auto high = [](std::uint64_t n) { return static_cast<std::uint32_t>(n >> 32); };
  const auto low = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
  Reader in(bytes);
  in.array(tile.pixels);
  in.array(tile.needed);
  in.array(tile.groups);
  tile.require_possible(kMostSamples);
  for (cryptomatte::Accumulator& matte : tile.mattes)
    for (std::uint64_t n = in.count(8); n > 0; --n) {
      const std::uint64_t pair = in.number();
      matte.add(high(pair), low(pair));
    }
  SampleCounts& c = tile.counts;
  for (std::uint64_t* n :
       {&c.rays.camera, &c.rays.bounce, &c.rays.shadow, &c.samples, &c.non_finite})
    *n = in.number();
  for (RayCost& cost : c.rays.costs) {
    for (std::uint64_t& n : cost.rays) n = in.number();
    cost.evaluations = in.number();
    cost.filtered = in.number();
  }
  for (std::uint64_t n = in.count(8); n > 0; --n) {
    const std::uint64_t pair = in.number();
    c.components.emplace(high(pair), low(pair));
  }
  return in.rest();
}

}  // namespace morsel::render
