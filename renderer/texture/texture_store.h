// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "renderer/math/vector.h"
#include "renderer/scene/texture.h"
#include "renderer/texture/tile_sampler.h"

namespace morsel::render {

// Images through OpenImageIO's texture system: tiles and mip levels are read when they are needed
// and forgotten when the budget of memory is used up. Thread-safe.
class TextureStore {
 public:
  explicit TextureStore(std::uint64_t megabytes);
  ~TextureStore();
  TextureStore(const TextureStore&) = delete;
  TextureStore& operator=(const TextureStore&) = delete;

  // The number of an image; the same one for the same file with the same colour space and wrapping.
  // Throws std::runtime_error naming the file when it cannot be read or a UDIM has no tiles.
  std::uint32_t add(const ImageTexture& image);

  struct Value {
    V3f color{0.0f};
    float alpha = 1.0f;
  };
  // At texture coordinates (u right, v up), averaged over the parallelogram that the two vectors
  // span about them. Grey images give three equal channels. Errors of reading give black.
  // With `random` in [0, 1) one point of the parallelogram at one mip level is taken instead, whose
  // expected value is that average: a fraction of the work, for where many samples are averaged.
  Value lookup(std::uint32_t image, const V2f& uv, const V2f& across, const V2f& along,
               float random = -1.0f) const;

  // A single point in three steps, of which the second serves all images of one shape (size and
  // wrapping), so that what is taken from several at one place is looked for once. An image without
  // a shape has no such place: UDIM.
  static constexpr std::uint32_t kNoShape = 0xffffffffu;
  std::uint32_t shape(std::uint32_t image) const;
  TexelPlace place(std::uint32_t image, const V2f& uv, const V2f& across, const V2f& along,
                   float random) const;
  TileSampler& sampler() const;  // of the calling thread
  Value texel(std::uint32_t image, const TexelPlace& place, TileSampler& sampler) const;

  std::size_t size() const;
  // Bytes read from files and memory in use, for people.
  std::string statistics() const;
  // The same as numbers, by OpenImageIO's names: bytes_read, cache_memory_used, tiles_created, ...
  std::vector<std::pair<std::string, std::int64_t>> numbers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace morsel::render
