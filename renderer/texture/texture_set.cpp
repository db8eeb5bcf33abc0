// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/texture_set.h"

#include "renderer/texture/ramp.h"

namespace morsel::render {
namespace {

// The texture coordinates of an image: see ImageTexture. Directions have no offset.
V2f transformed(const ImageTexture& image, V2f uv, bool direction) {
  if (image.v_down) uv.y = direction ? -uv.y : 1.0f - uv.y;
  uv *= image.scale;
  if (image.rotation != 0.0f) {
    // Counter-clockwise in the picture, whichever way v counts.
    const float angle = image.rotation * (kPi / 180.0f) * (image.v_down ? -1.0f : 1.0f);
    const float s = std::sin(angle), c = std::cos(angle);
    uv = V2f(c * uv.x - s * uv.y, s * uv.x + c * uv.y);
  }
  if (!direction) uv += image.offset;
  if (image.v_down) uv.y = direction ? -uv.y : 1.0f - uv.y;
  return uv;
}

V3f checker(const CheckerTexture& c, const V3f& p) {
  const float sum = std::floor(p.x / c.size) + std::floor(p.y / c.size) + std::floor(p.z / c.size);
  return std::fmod(sum, 2.0f) != 0.0f ? c.color_b : c.color_a;
}

// A small step from a hit, in object space.
V3f to_object(const Scene& scene, const SurfaceInteraction& hit, const V3f& moved) {
  if (moved == V3f(0.0f)) return moved;
  V3d step;
  scene.instances[hit.instance].to_world(hit.time).inverse().multDirMatrix(V3d(moved), step);
  return V3f(step);
}

}  // namespace

TextureSet::TextureSet(const Scene& scene) : scene_(scene), store_(scene.settings.texture_memory) {
  for (const Texture& t : scene.textures) {
    const auto* image = std::get_if<ImageTexture>(&t.kind);
    image_of_.push_back(image != nullptr ? store_.add(*image) : kNoIndex);
  }
}

// Projections along the three axes, weighted by a power of the normal's components.
TextureSet::Value TextureSet::image(const ImageTexture& image, std::uint32_t index,
                                    const TexturePoint& point, const V3f& moved) const {
  const SurfaceInteraction& hit = point.hit;
  const std::uint32_t handle = image_of_[index];
  if (!image.triplanar) {
    V2f uv = image.uv_set == 1 ? hit.uv1 : hit.uv, across(0.0f), along(0.0f);
    const SurfaceFrame& frame = point.frame(image.uv_set);
    const auto to_uv = [&](const V3f& d) {
      return V2f(dot(d, frame.u_gradient), dot(d, frame.v_gradient));
    };
    if (frame.valid()) uv += to_uv(moved);
    uv = transformed(image, uv, false);
    if (handle == point.last_image_ && uv == point.last_uv_) return point.last_;
    if (frame.valid()) {
      across = transformed(image, to_uv(point.footprint().across), true);
      along = transformed(image, to_uv(point.footprint().along), true);
    }
    point.last_ = store_.lookup(handle, uv, across, along, hit.texture_random);
    point.last_image_ = handle;
    point.last_uv_ = uv;
    return point.last_;
  }
  const V3f p = (hit.object_p + to_object(scene_, hit, moved)) / image.triplanar_size;
  const V3f& n = hit.object_normal;
  V3f weight;
  for (int i = 0; i < 3; ++i) weight[i] = square(square(n[i]));
  weight /= weight.x + weight.y + weight.z;
  const float width = hit.footprint * hit.object_scale / image.triplanar_size;
  float random = hit.texture_random;
  if (random >= 0.0f) {  // one axis stands for all
    int axis = 0;
    while (axis < 2 && random >= weight[axis]) random -= weight[axis++];
    random = std::clamp(random / weight[axis], 0.0f, kOneMinusEpsilon);
    weight = V3f(0.0f);
    weight[axis] = 1.0f;
  }
  Value sum{V3f(0.0f), 0.0f};
  for (int axis = 0; axis < 3; ++axis) {
    if (weight[axis] < 1e-3f) continue;
    // Seen from outside, u runs to the right and v upwards.
    const float side = n[axis] < 0.0f ? -1.0f : 1.0f;
    const V2f uv = axis == 0   ? V2f(-side * p.z, p.y)
                   : axis == 1 ? V2f(p.x, -side * p.z)
                               : V2f(side * p.x, p.y);
    const auto v = store_.lookup(handle, transformed(image, uv, false),
                                 transformed(image, V2f(width, 0.0f), true),
                                 transformed(image, V2f(0.0f, width), true), random);
    sum.color += v.color * weight[axis];
    sum.alpha += v.alpha * weight[axis];
  }
  return sum;
}

TextureSet::Value TextureSet::evaluate(const Texture& texture, std::uint32_t index,
                                       const TexturePoint& point, const V3f& moved) const {
  if (const auto* i = std::get_if<ImageTexture>(&texture.kind))
    return image(*i, index, point, moved);
  if (const auto* ramp = std::get_if<RampTexture>(&texture.kind)) {
    const auto x = ramp_input(scene_, ramp->input, point.hit);
    return {ramp_color(*ramp, x.value_or(ramp->low)), 1.0f};
  }
  const auto& c = std::get<CheckerTexture>(texture.kind);
  const V3f p = c.solid ? point.hit.object_p : V3f(point.hit.uv.x, point.hit.uv.y, 0.0f);
  return {checker(c, p), 1.0f};
}

const SurfaceFrame& TextureSet::frame(std::uint32_t texture, const TexturePoint& point) const {
  const auto* image = std::get_if<ImageTexture>(&scene_.textures[texture].kind);
  return point.frame(image != nullptr ? image->uv_set : 0);
}

float TextureSet::channel_of(TextureChannel channel, const Value& v) {
  switch (channel) {
    case TextureChannel::kRed:
      return v.color.x;
    case TextureChannel::kGreen:
      return v.color.y;
    case TextureChannel::kBlue:
      return v.color.z;
    case TextureChannel::kAlpha:
      return v.alpha;
    case TextureChannel::kLuminance:
      break;
  }
  return luminance(v.color);
}

V3f TextureSet::color(std::uint32_t texture, const TexturePoint& point) const {
  return evaluate(scene_.textures[texture], texture, point, V3f(0.0f)).color;
}

float TextureSet::number(std::uint32_t texture, const TexturePoint& point) const {
  const Texture& t = scene_.textures[texture];
  return channel_of(t.channel, evaluate(t, texture, point, V3f(0.0f)));
}

V2f TextureSet::slope(std::uint32_t texture, const TexturePoint& point, const V3f& a,
                      const V3f& b) const {
  const Texture& t = scene_.textures[texture];
  // The footprint, but never so small that floats do not tell the points apart.
  const float step = std::max(point.hit.footprint, 1e-4f * std::max(1e-3f, max_abs(point.hit.p)));
  const auto at = [&](const V3f& moved) {
    return channel_of(t.channel, evaluate(t, texture, point, moved));
  };
  return {(at(a * (0.5f * step)) - at(a * (-0.5f * step))) / step,
          (at(b * (0.5f * step)) - at(b * (-0.5f * step))) / step};
}

}  // namespace morsel::render
