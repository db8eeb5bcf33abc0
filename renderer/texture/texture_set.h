// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/material/surface_frame.h"
#include "renderer/texture/texture_store.h"

namespace morsel::render {

// Where textures are asked: a hit, the direction to the viewer, and what follows from them when it
// is needed first. Of one thread.
class TexturePoint {
 public:
  TexturePoint(const Scene& scene, const SurfaceInteraction& h, const V3f& wo)
      : hit(h), scene_(scene), wo_(wo) {}

  const SurfaceFrame& frame(int uv_set) const {
    auto& frame = uv_set == 1 ? second_frame_ : first_frame_;
    if (!frame) frame.emplace(surface_frame(scene_, hit, uv_set));
    return *frame;
  }
  const Footprint& footprint() const {
    if (!footprint_) footprint_ = footprint_of(hit, wo_);
    return *footprint_;
  }

  const SurfaceInteraction& hit;

 private:
  friend class TextureSet;

  const Scene& scene_;
  const V3f& wo_;
  mutable std::optional<SurfaceFrame> first_frame_, second_frame_;
  mutable std::optional<Footprint> footprint_;
  mutable TileSampler* sampler_ = nullptr;  // the thread's, once an image was looked up
  // The last images that were looked up, and where: materials take several numbers from one, and
  // one place in several.
  mutable std::uint32_t last_layout_ = kNoIndex, last_image_ = kNoIndex;
  mutable TexelPlace last_place_;
  mutable TextureStore::Value last_;
};

// The textures of a scene, open and ready. Thread-safe.
class TextureSet {
 public:
  // Throws std::runtime_error for images that cannot be read.
  explicit TextureSet(const Scene& scene);

  V3f color(std::uint32_t texture, const TexturePoint& point) const;
  float number(std::uint32_t texture, const TexturePoint& point) const;
  // Derivatives of number() along two directions in the surface, for bumps: differences over the
  // footprint.
  V2f slope(std::uint32_t texture, const TexturePoint& point, const V3f& a, const V3f& b) const;

  // How the coordinates that an image texture goes by lie at the point.
  const SurfaceFrame& frame(std::uint32_t texture, const TexturePoint& point) const;

  bool any_images() const { return store_.size() > 0; }
  std::string statistics() const { return store_.statistics(); }
  auto numbers() const { return store_.numbers(); }

 private:
  using Value = TextureStore::Value;
  // The texture coordinates of an image from the mesh's: see ImageTexture.
  struct UvMap {
    V2f u{1.0f, 0.0f}, v{0.0f, 1.0f}, offset{0.0f, 0.0f};

    explicit UvMap(const ImageTexture& image);
    UvMap() = default;
    bool operator==(const UvMap&) const = default;
    V2f direction(const V2f& d) const { return u * d.x + v * d.y; }
    V2f point(const V2f& p) const { return direction(p) + offset; }
  };
  struct Prepared {
    const Texture* texture = nullptr;
    std::uint32_t handle = kNoIndex;  // of an image, of the store
    int uv_set = 0;
    float per_length = 0.0f;  // repetitions of a triplanar image; 0: by coordinates
    // The same for images whose texels lie alike on surfaces; kNoIndex: those of no other.
    std::uint32_t layout = kNoIndex;
    UvMap map;
  };
  Value evaluate(const Prepared& texture, const TexturePoint& point, const V3f* moved) const;
  Value by_coordinates(const Prepared& texture, const TexturePoint& point, const V3f* moved) const;
  Value triplanar(const Prepared& texture, const TexturePoint& point, const V3f* moved) const;
  TileSampler& sampler(const TexturePoint& point) const {
    if (point.sampler_ == nullptr) point.sampler_ = &store_.sampler();
    return *point.sampler_;
  }
  static float channel_of(TextureChannel channel, const Value& value);

  const Scene& scene_;
  TextureStore store_;
  std::vector<Prepared> prepared_;  // per texture
};

}  // namespace morsel::render
