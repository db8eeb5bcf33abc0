// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "renderer/light/ball.h"
#include "renderer/light/disk.h"
#include "renderer/light/distant.h"
#include "renderer/light/emissive_triangle.h"
#include "renderer/light/environment.h"
#include "renderer/light/light_tree.h"
#include "renderer/light/point.h"
#include "renderer/light/rectangle.h"

namespace morsel::render {

// Lights that one sample chooses among: the environment and distant lights, or those that are
// somewhere.
enum class LightGroup { kAll, kInfinite, kLocal };

// The registry of lights that are somewhere: a class as light.h describes and an entry here.
using LocalLight = std::variant<Rectangle, Disk, Ball, Point, EmissiveTriangle>;

// All lights of a scene and the choice among them: in proportion to the light that each can bring
// to the shaded point at most (visibility and the surface's normal not considered), among those
// that are somewhere by a light tree.
//
// Local lights are numbered: rectangles, disks and spheres as in the scene (the order in which
// SceneAccel has them as geometry), then points, then the triangles of emissive meshes.
class LightSet {
 public:
  // Reads the environment's image. `complete`: every light is sampled wherever it shines; otherwise
  // BSDF samples are counted on for the even part of the environment. Throws std::runtime_error,
  // std::invalid_argument.
  LightSet(const Scene& scene, bool complete);

  // Whether a sample of the group can find anything, and whether it has a choice of what.
  bool any(LightGroup group) const { return count(group) > 0; }
  bool chooses(LightGroup group) const { return count(group) > 1; }
  bool empty() const { return !environment_ && distants_.empty() && local_.empty(); }

  static constexpr std::uint32_t kNoLight = 0xffffffffu;

  // A direction from `p` to one of the group's lights; pdf includes the choice, and is 0 if none of
  // them can reach `p`.
  struct Sample : LightSample {
    std::uint32_t light_group = kNoGroup;  // Scene's
    // Of the triangle of an emissive mesh; `radiance` is then that of the material without
    // textures.
    std::uint32_t instance = kNoLight, triangle = 0;
  };
  Sample sample(LightGroup group, const V3f& p, float choice, const V2f& u) const {
    LightPoint at;
    point(group, u, at);
    fetch(at);
    return sample(group, p, choice, at);
  }
  // The same in three steps: what the next one needs of memory is fetched in between.
  struct LightPoint {
    V2f u{0.0f};
    bool infinite = false;  // the environment is among them
    Environment::Place in_environment;
  };
  void point(LightGroup group, const V2f& u, LightPoint& point) const {
    point.u = u;
    point.infinite = environment_ && group != LightGroup::kLocal && infinite_[0].importance > 0.0f;
    if (point.infinite) environment_->place(u, point.in_environment);
  }
  void fetch(LightPoint& point) const {
    if (point.infinite) environment_->fetch(point.in_environment);
  }
  Sample sample(LightGroup group, const V3f& p, float choice, const LightPoint& point) const;

  bool has_environment() const { return environment_.has_value(); }
  // Lights infinitely far away, which an escaping ray meets: 0 is the environment if there is one,
  // then the distant lights.
  std::size_t infinite_count() const { return infinite_.size(); }
  V3f infinite_radiance(std::size_t i, const V3f& wi) const {
    return infinite_radiance(i, towards(wi));
  }
  bool infinite_visible_to_camera(std::size_t i) const { return infinite_[i].visible_to_camera; }
  // The density of sample(group, p) in direction `wi` as far as light `i`, which must be of the
  // group, is concerned. Each light is an integral of its own, so this is what MIS needs.
  float infinite_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi) const;
  // A direction that these may be asked for: what they need of memory is fetched meanwhile.
  struct Direction {
    V3f wi{0.0f};
    Environment::Patch in_environment;
  };
  Direction towards(const V3f& wi) const {
    Direction direction;
    find(wi, direction);
    return direction;
  }
  void find(const V3f& wi, Direction& direction) const {
    direction.wi = wi;
    if (environment_) environment_->find(wi, direction.in_environment);
  }
  V3f infinite_radiance(std::size_t i, const Direction& direction) const;
  // infinite_radiance() and infinite_pdf() at once.
  Environment::Arriving infinite_arriving(LightGroup group, std::size_t i, const V3f& p,
                                          const Direction& direction) const;

  // `from_outside`: the ray meets the side that the geometry's normal is on.
  V3f local_radiance(std::size_t i, const V3f& wi, bool from_outside) const {
    if (!from_outside && std::holds_alternative<Ball>(local_[i])) return V3f(0.0f);
    return std::visit([&](const auto& light) { return light.radiance(wi); }, local_[i]);
  }
  // As infinite_pdf, for a ray that hits local light `i` at `distance`.
  float local_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi,
                  float distance) const;
  // Number of the local light that is this triangle; kNoLight if the instance's are not sampled.
  std::uint32_t emissive_triangle(std::uint32_t instance, std::uint32_t triangle) const {
    const std::uint32_t first = first_triangle_[instance];
    return first == kNoLight ? kNoLight : first + triangle;
  }

  // The scene's light group that they belong to, or kNoGroup.
  std::uint32_t infinite_light_group(std::size_t i) const { return infinite_[i].light_group; }
  std::uint32_t local_light_group(std::size_t i) const { return local_group_[i]; }

 private:
  struct Infinite {
    bool visible_to_camera;
    float importance;
    std::uint32_t light_group;
  };
  std::size_t count(LightGroup group) const {
    return (group == LightGroup::kLocal ? 0 : sampled_infinite_) +
           (group == LightGroup::kInfinite ? 0 : local_.size());
  }
  float local_importance(const V3f& p) const;
  // Chance that a sample of the group goes to infinite light `i`.
  float infinite_share(LightGroup group, std::size_t i, const V3f& p) const;
  // Chance that a sample of kAll goes to the local lights.
  float local_share(LightGroup group, const V3f& p) const;
  float leaf_importance(std::uint32_t i, const V3f& p) const {
    return std::visit([&](const auto& light) { return light.importance(p); }, local_[i]);
  }
  void add_emissive_meshes(const Scene& scene);
  void set_triangle(std::uint32_t light, Sample& s) const;
  void sample_infinite(std::size_t i, const LightPoint& point, LightSample& sample) const;

  std::optional<Environment> environment_;
  std::vector<Distant> distants_;
  std::vector<Infinite> infinite_;
  float infinite_importance_ = 0.0f;
  std::size_t sampled_infinite_ = 0;  // those of some importance
  bool only_environment_ = false;     // is sampled
  std::vector<LocalLight> local_;
  std::vector<std::uint32_t> local_group_;
  std::vector<std::uint32_t> first_triangle_;      // per instance
  std::vector<std::uint32_t> emissive_instances_;  // in the order of their triangles
  std::optional<LightTree> tree_;
};

}  // namespace morsel::render
