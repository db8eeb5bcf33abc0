// SPDX-License-Identifier: Apache-2.0
#include "renderer/light/light_set.h"

#include "renderer/light/sky.h"

namespace morsel::render {
namespace {

// Up to this many local lights their importances are summed to weigh them against the infinite
// ones; of more the tree's root gives an estimate.
constexpr std::size_t kSummed = 8;

EnvironmentImage image_of(const EnvironmentLight& e) {
  if (e.sky) return sky_image(*e.sky);
  return e.file.empty() ? EnvironmentImage{} : EnvironmentImage::read(e.file);
}

}  // namespace

LightSet::LightSet(const Scene& scene, bool complete) {
  std::vector<DistantLight> distants = scene.distants;
  if (scene.environment) {
    const EnvironmentLight& e = *scene.environment;
    environment_.emplace(image_of(e), e.radiance, e.rotation, !complete);
    // Irradiance under a hemisphere of the mean radiance.
    infinite_.push_back({e.visible_to_camera, kPi * environment_->sampled_luminance(), e.group});
    if (e.sky) {
      DistantLight sun = sun_of(*e.sky);
      sun.irradiance *= e.radiance;
      const double angle = e.rotation * 3.14159265358979323846 / 180.0;
      const auto s = static_cast<float>(std::sin(angle)), c = static_cast<float>(std::cos(angle));
      const V3f d = sun.direction;
      sun.direction = V3f(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
      sun.visible_to_camera = e.visible_to_camera;
      sun.group = e.group;
      distants.push_back(sun);
    }
  }
  for (const DistantLight& d : distants) {
    distants_.emplace_back(d);
    infinite_.push_back({d.visible_to_camera, distants_.back().importance(), d.group});
  }
  for (const Infinite& i : infinite_) {
    infinite_importance_ += i.importance;
    if (i.importance > 0.0f) ++sampled_infinite_;
  }

  const auto add = [&](const auto& lights, auto make) {
    for (const auto& light : lights) {
      local_.emplace_back(make(light));
      local_group_.push_back(light.group);
    }
  };
  add(scene.rectangles, [](const RectangleLight& l) { return Rectangle(l); });
  add(scene.disks, [](const DiskLight& l) { return Disk(l); });
  add(scene.spheres, [](const SphereLight& l) { return Ball(l); });
  add(scene.points, [](const PointLight& l) { return Point(l); });
  add_emissive_meshes(scene);

  only_environment_ =
      local_.empty() && sampled_infinite_ == 1 && environment_ && infinite_[0].importance > 0.0f;

  std::vector<LightBounds> bounds;
  for (const LocalLight& light : local_)
    bounds.push_back(std::visit([](const auto& l) { return l.bounds(); }, light));
  tree_.emplace(bounds);
}

void LightSet::add_emissive_meshes(const Scene& scene) {
  for (const Instance& instance : scene.instances) {
    first_triangle_.push_back(kNoLight);
    const auto* mesh = std::get_if<TriangleMesh>(&scene.geometries[instance.geometry].shape);
    const Material& material = scene.materials[instance.material];
    // One that moves is left to BSDF samples; one that they cannot see lights nothing.
    if (mesh == nullptr || instance.object_to_world_end || !instance.visible_to_bounces ||
        !(max_component(material.emission) > 0.0f))
      continue;
    first_triangle_.back() = static_cast<std::uint32_t>(local_.size());
    emissive_instances_.push_back(static_cast<std::uint32_t>(first_triangle_.size() - 1));
    const auto corner = [&](int vertex) {
      return V3f(V3d(mesh->positions[static_cast<std::size_t>(vertex)]) * instance.object_to_world);
    };
    for (const Imath::V3i& t : mesh->triangles) {
      local_.emplace_back(
          EmissiveTriangle(corner(t.x), corner(t.y), corner(t.z), material.emission));
      local_group_.push_back(material.group);
    }
  }
}

void LightSet::set_triangle(std::uint32_t light, Sample& s) const {
  if (!std::holds_alternative<EmissiveTriangle>(local_[light])) return;
  // The last instance whose first triangle is not beyond it.
  const auto after = std::upper_bound(
      emissive_instances_.begin(), emissive_instances_.end(), light,
      [&](std::uint32_t l, std::uint32_t instance) { return l < first_triangle_[instance]; });
  s.instance = *(after - 1);
  s.triangle = light - first_triangle_[s.instance];
}

float LightSet::local_importance(const V3f& p) const {
  if (local_.size() > kSummed) return tree_->importance(p);
  float total = 0.0f;
  for (std::uint32_t i = 0; i < local_.size(); ++i) total += leaf_importance(i, p);
  return total;
}

float LightSet::local_share(LightGroup group, const V3f& p) const {
  if (group == LightGroup::kLocal) return 1.0f;
  if (group == LightGroup::kInfinite) return 0.0f;
  const float local = local_importance(p), total = local + infinite_importance_;
  return total > 0.0f ? local / total : 0.0f;
}

void LightSet::sample_infinite(std::size_t i, const LightPoint& point, LightSample& sample) const {
  if (environment_ && i == 0)
    environment_->sample(point.in_environment, sample);
  else
    sample = distants_[environment_ ? i - 1 : i].sample(point.u);
}

LightSet::Sample LightSet::sample(LightGroup group, const V3f& p, float choice,
                                  const LightPoint& point) const {
  Sample s;
  if (only_environment_ && group != LightGroup::kLocal) {
    environment_->sample(point.in_environment, s);
    s.light_group = infinite_[0].light_group;
    return s;
  }
  const float local = local_share(group, p);
  if (choice < local) {
    const auto chosen = tree_->sample(p, std::min(choice / local, kOneMinusEpsilon),
                                      [&](std::uint32_t i) { return leaf_importance(i, p); });
    if (!(chosen.probability > 0.0f)) return {};
    static_cast<LightSample&>(s) =
        std::visit([&](const auto& l) { return l.sample(p, point.u); }, local_[chosen.light]);
    s.pdf *= local * chosen.probability;
    s.light_group = local_group_[chosen.light];
    set_triangle(chosen.light, s);
    return s;
  }
  if (!(infinite_importance_ > 0.0f)) return {};
  float rest = (choice - local) / (1.0f - local) * infinite_importance_;
  std::size_t chosen = infinite_.size();
  for (std::size_t i = 0; i < infinite_.size(); ++i) {
    if (!(infinite_[i].importance > 0.0f)) continue;
    chosen = i;  // the last one stands in when rounding leaves something over
    if (rest < infinite_[i].importance) break;
    rest -= infinite_[i].importance;
  }
  sample_infinite(chosen, point, s);
  s.pdf *= (1.0f - local) * infinite_[chosen].importance / infinite_importance_;
  s.light_group = infinite_[chosen].light_group;
  return s;
}

V3f LightSet::infinite_radiance(std::size_t i, const Direction& direction) const {
  if (environment_ && i == 0) return environment_->radiance(direction.in_environment);
  return distants_[environment_ ? i - 1 : i].radiance(direction.wi);
}

float LightSet::infinite_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi) const {
  if (!(infinite_[i].importance > 0.0f)) return 0.0f;
  const float pdf =
      environment_ && i == 0 ? environment_->pdf(wi) : distants_[environment_ ? i - 1 : i].pdf(wi);
  return pdf * infinite_share(group, i, p);
}

float LightSet::infinite_share(LightGroup group, std::size_t i, const V3f& p) const {
  if (only_environment_) return group != LightGroup::kLocal && i == 0 ? 1.0f : 0.0f;
  return (1.0f - local_share(group, p)) * infinite_[i].importance / infinite_importance_;
}

Environment::Arriving LightSet::infinite_arriving(LightGroup group, std::size_t i, const V3f& p,
                                                  const Direction& direction) const {
  if (!environment_ || i != 0 || !(infinite_[i].importance > 0.0f))
    return {infinite_radiance(i, direction), infinite_pdf(group, i, p, direction.wi)};
  Environment::Arriving arriving = environment_->arriving(direction.in_environment);
  arriving.pdf *= infinite_share(group, i, p);
  return arriving;
}

float LightSet::local_pdf(LightGroup group, std::size_t i, const V3f& p, const V3f& wi,
                          float distance) const {
  const auto light = static_cast<std::uint32_t>(i);
  const float chosen =
      tree_->probability(p, light, [&](std::uint32_t k) { return leaf_importance(k, p); });
  if (!(chosen > 0.0f)) return 0.0f;
  const float pdf = std::visit([&](const auto& l) { return l.pdf(p, wi, distance); }, local_[i]);
  return pdf * chosen * local_share(group, p);
}

}  // namespace morsel::render
