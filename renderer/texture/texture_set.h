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
    auto& frame = frame_[uv_set];
    if (!frame) frame = surface_frame(scene_, hit, uv_set);
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
  mutable std::optional<SurfaceFrame> frame_[2];
  mutable std::optional<Footprint> footprint_;
  // The last image that was looked up, and where: materials take several numbers from one.
  mutable std::uint32_t last_image_ = kNoIndex;
  mutable V2f last_uv_{0.0f, 0.0f};
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
  Value evaluate(const Texture& texture, std::uint32_t index, const TexturePoint& point,
                 const V3f& moved) const;
  Value image(const ImageTexture& image, std::uint32_t index, const TexturePoint& point,
              const V3f& moved) const;
  static float channel_of(TextureChannel channel, const Value& value);

  const Scene& scene_;
  TextureStore store_;
  std::vector<std::uint32_t> image_of_;  // per texture, of the store
};

}  // namespace morsel::render
