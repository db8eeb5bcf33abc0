// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/material/surface_frame.h"
#include "renderer/texture/ramp.h"
#include "renderer/texture/texture_store.h"

namespace morsel::render {

// Where textures are asked: a hit, the direction to the viewer, and what follows from them.
struct TexturePoint {
  const SurfaceInteraction& hit;
  SurfaceFrame frame;
  Footprint footprint;

  TexturePoint(const Scene& scene, const SurfaceInteraction& h, const V3f& wo)
      : hit(h), frame(surface_frame(scene, h)), footprint(footprint_of(h, wo)) {}
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

  bool any_images() const { return store_.size() > 0; }
  std::string statistics() const { return store_.statistics(); }

 private:
  struct Value {
    V3f color;
    float alpha;
  };
  Value evaluate(const Texture& texture, std::uint32_t index, const TexturePoint& point,
                 const V3f& moved) const;
  Value image(const ImageTexture& image, std::uint32_t index, const TexturePoint& point,
              const V3f& moved) const;
  static float channel_of(TextureChannel channel, const Value& value);

  const Scene& scene_;
  SolidInputs inputs_;
  TextureStore store_;
  std::vector<std::uint32_t> image_of_;  // per texture, of the store
};

}  // namespace morsel::render
