// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/texture_set.h"

#include <algorithm>
#include <cmath>

#include "renderer/texture/ramp.h"

namespace morsel::render {
namespace {

V3f checker(const CheckerTexture& c, const V3f& p) {
  const float sum = std::floor(p.x / c.size) + std::floor(p.y / c.size) + std::floor(p.z / c.size);
  return std::fmod(sum, 2.0f) != 0.0f ? c.color_b : c.color_a;
}

// A small step from a hit, in object space.
V3f to_object(const Scene& scene, const SurfaceInteraction& hit, const V3f& moved) {
  V3d step;
  scene.instances[hit.instance].to_world(hit.time).inverse().multDirMatrix(V3d(moved), step);
  return V3f(step);
}

}  // namespace

TextureSet::UvMap::UvMap(const ImageTexture& image) {
  // Counter-clockwise in the picture, whichever way v counts.
  constexpr double kHalfTurn = 3.14159265358979323846;
  const double angle = double{image.rotation} * (image.v_down ? -1.0 : 1.0) * (kHalfTurn / 180.0);
  const double s = image.rotation == 0.0f ? 0.0 : std::sin(angle),
               c = image.rotation == 0.0f ? 1.0 : std::cos(angle);
  const auto mapped = [&](double x, double y, double origin) {  // origin: 1 of points
    if (image.v_down) y = origin - y;
    x *= double{image.scale.x};
    y *= double{image.scale.y};
    const double turned_x = c * x - s * y + origin * double{image.offset.x};
    const double turned_y = s * x + c * y + origin * double{image.offset.y};
    return V2f(static_cast<float>(turned_x),
               static_cast<float>(image.v_down ? origin - turned_y : turned_y));
  };
  u = mapped(1.0, 0.0, 0.0);
  v = mapped(0.0, 1.0, 0.0);
  offset = mapped(0.0, 0.0, 1.0);
}

TextureSet::TextureSet(const Scene& scene) : scene_(scene), store_(scene.settings.texture_memory) {
  for (const Texture& t : scene.textures) {
    Prepared p;
    p.texture = &t;
    if (const auto* image = std::get_if<ImageTexture>(&t.kind)) {
      p.handle = store_.add(*image);
      p.uv_set = image->uv_set;
      p.map = UvMap(*image);
      if (image->triplanar) p.per_length = 1.0f / image->triplanar_size;
      const auto index = static_cast<std::uint32_t>(prepared_.size());
      if (!image->triplanar && store_.shape(p.handle) != TextureStore::kNoShape) {
        const auto alike = std::find_if(prepared_.begin(), prepared_.end(), [&](const auto& q) {
          return q.layout != kNoIndex && q.uv_set == p.uv_set && q.map == p.map &&
                 store_.shape(q.handle) == store_.shape(p.handle);
        });
        p.layout = alike != prepared_.end() ? alike->layout : index;
      }
    }
    prepared_.push_back(p);
  }
}

TextureSet::Value TextureSet::by_coordinates(const Prepared& texture, const TexturePoint& point,
                                             const V3f* moved) const {
  const SurfaceInteraction& hit = point.hit;
  const bool stays = moved == nullptr, single = hit.texture_random >= 0.0f;
  if (stays && texture.handle == point.last_image_ && texture.layout == point.last_layout_)
    return point.last_;
  if (!stays || !single || texture.layout == kNoIndex || texture.layout != point.last_layout_) {
    const SurfaceFrame& frame = point.frame(texture.uv_set);
    const auto to_uv = [&](const V3f& d) {
      return V2f(dot(d, frame.u_gradient), dot(d, frame.v_gradient));
    };
    V2f uv = texture.uv_set == 1 ? hit.uv1 : hit.uv, across(0.0f), along(0.0f);
    if (frame.valid()) {
      if (!stays) uv += to_uv(*moved);
      across = texture.map.direction(to_uv(point.footprint().across));
      along = texture.map.direction(to_uv(point.footprint().along));
    }
    uv = texture.map.point(uv);
    if (!single || texture.layout == kNoIndex)
      return store_.lookup(texture.handle, uv, across, along, hit.texture_random);
    const TexelPlace place = store_.place(texture.handle, uv, across, along, hit.texture_random);
    if (!stays) return store_.texel(texture.handle, place, sampler(point));
    point.last_place_ = place;
    point.last_layout_ = texture.layout;
  }
  point.last_image_ = texture.handle;
  point.last_ = store_.texel(texture.handle, point.last_place_, sampler(point));
  return point.last_;
}

// Projections along the three axes, weighted by a power of the normal's components.
TextureSet::Value TextureSet::triplanar(const Prepared& texture, const TexturePoint& point,
                                        const V3f* moved) const {
  const SurfaceInteraction& hit = point.hit;
  const V3f p = (moved == nullptr ? hit.object_p : hit.object_p + to_object(scene_, hit, *moved)) *
                texture.per_length;
  const V3f& n = hit.object_normal;
  const float width = hit.footprint * hit.object_scale * texture.per_length;
  const V2f across = texture.map.u * width, along = texture.map.v * width;
  const auto projected = [&](int axis) {
    // Seen from outside, u runs to the right and v upwards.
    const float side = n[axis] < 0.0f ? -1.0f : 1.0f;
    return texture.map.point(axis == 0   ? V2f(-side * p.z, p.y)
                             : axis == 1 ? V2f(p.x, -side * p.z)
                                         : V2f(side * p.x, p.y));
  };
  V3f weight;
  for (int i = 0; i < 3; ++i) weight[i] = square(square(n[i]));
  const float total = weight.x + weight.y + weight.z;
  if (hit.texture_random >= 0.0f) {  // one axis stands for all
    float rest = hit.texture_random * total;
    int axis = 0;
    while (axis < 2 && rest >= weight[axis]) rest -= weight[axis++];
    const float again = std::clamp(rest / weight[axis], 0.0f, kOneMinusEpsilon);
    if (store_.shape(texture.handle) == TextureStore::kNoShape)
      return store_.lookup(texture.handle, projected(axis), across, along, again);
    return store_.texel(texture.handle,
                        store_.place(texture.handle, projected(axis), across, along, again),
                        sampler(point));
  }
  weight *= 1.0f / total;
  Value sum{V3f(0.0f), 0.0f};
  for (int axis = 0; axis < 3; ++axis) {
    if (weight[axis] < 1e-3f) continue;
    const auto v = store_.lookup(texture.handle, projected(axis), across, along);
    sum.color += v.color * weight[axis];
    sum.alpha += v.alpha * weight[axis];
  }
  return sum;
}

// `moved`: a small step from the hit, in the world, or none.
TextureSet::Value TextureSet::evaluate(const Prepared& texture, const TexturePoint& point,
                                       const V3f* moved) const {
  if (texture.handle != kNoIndex)
    return texture.per_length > 0.0f ? triplanar(texture, point, moved)
                                     : by_coordinates(texture, point, moved);
  if (const auto* ramp = std::get_if<RampTexture>(&texture.texture->kind)) {
    const auto x = ramp_input(scene_, ramp->input, point.hit);
    return {ramp_color(*ramp, x.value_or(ramp->low)), 1.0f};
  }
  const auto& c = std::get<CheckerTexture>(texture.texture->kind);
  const V3f p = c.solid ? point.hit.object_p : V3f(point.hit.uv.x, point.hit.uv.y, 0.0f);
  return {checker(c, p), 1.0f};
}

const SurfaceFrame& TextureSet::frame(std::uint32_t texture, const TexturePoint& point) const {
  return point.frame(prepared_[texture].uv_set);
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
  return evaluate(prepared_[texture], point, nullptr).color;
}

float TextureSet::number(std::uint32_t texture, const TexturePoint& point) const {
  const Prepared& t = prepared_[texture];
  return channel_of(t.texture->channel, evaluate(t, point, nullptr));
}

V2f TextureSet::slope(std::uint32_t texture, const TexturePoint& point, const V3f& a,
                      const V3f& b) const {
  const Prepared& t = prepared_[texture];
  // The footprint, but never so small that floats do not tell the points apart.
  const float step = std::max(point.hit.footprint, 1e-4f * std::max(1e-3f, max_abs(point.hit.p)));
  const auto at = [&](const V3f& moved) {
    return channel_of(t.texture->channel, evaluate(t, point, &moved));
  };
  return {(at(a * (0.5f * step)) - at(a * (-0.5f * step))) / step,
          (at(b * (0.5f * step)) - at(b * (-0.5f * step))) / step};
}

}  // namespace morsel::render
