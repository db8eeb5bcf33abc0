// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "renderer/scene/texture.h"

namespace morsel::geom {
class HypertextureGeometry;
}

// A scene as plain data: what the loader makes and the integrator reads. Indices refer to the
// vectors of Scene. World space is right-handed; lengths are scene units; colours are scene-linear
// Rec. 709.
namespace morsel::render {

// Lights may belong to a group of Scene::light_groups, whose light gets an image layer of its own.
inline constexpr std::uint32_t kNoGroup = 0xffffffffu;
inline constexpr std::uint32_t kMaxLightGroups = 8;

enum class MaterialType { kDiffuse, kConductor, kDielectric, kPrincipled };

// The principled material is glTF 2.0's metallic-roughness model with the extensions KHR_materials_
// clearcoat, ior, sheen, specular, transmission, volume and emissive_strength. Every roughness is
// perceptual: GGX's alpha is its square; 0 is a perfect mirror or clear glass.
struct Material {
  std::string name;
  MaterialType type = MaterialType::kDiffuse;
  Imath::V3f color{0.5f};  // diffuse albedo; conductor: reflectance at normal incidence;
                           // dielectric: tint of light that passes through; principled: all three
  float roughness = 0.0f;
  float diffuse_roughness = 0.0f;  // of the matte body: 0 is Lambert's, 1 the roughest
  float ior = 1.5f;                // dielectric and principled; of the inside
  std::optional<Imath::V3f>
      checker_color;          // diffuse: second colour of a checkerboard in world x, z
  float checker_size = 1.0f;  // side of one square

  // Principled only.
  float metallic = 0.0f;
  float specular = 1.0f;            // scales the reflection of what is not metal
  Imath::V3f specular_color{1.0f};  // tints it at normal incidence
  float clearcoat = 0.0f, clearcoat_roughness = 0.0f;
  Imath::V3f sheen_color{0.0f};
  float sheen_roughness = 0.0f;
  float transmission = 0.0f;
  bool thin = false;  // a sheet without an inside: refracts nothing

  // Dielectric and principled: white light becomes `attenuation_color` on this length of way
  // through the inside. 0: nothing is absorbed, and `color` tints what passes.
  float attenuation_distance = 0.0f;
  Imath::V3f attenuation_color{1.0f};
  bool color_tints_volume = false;  // `color` does so all the same, as glTF has it

  Imath::V3f emission{0.0f};       // radiance, on both sides
  std::uint32_t group = kNoGroup;  // of its light
  float opacity = 1.0f;            // share of rays that the surface is there for
  // Above 0: all or nothing, whether the opacity reaches this.
  float opacity_cutoff = 0.0f;
  bool vertex_alpha = false;  // whether the opacity is multiplied by the mesh's alphas

  // Indices into Scene::textures, by MaterialInput.
  std::array<std::uint32_t, kMaterialInputs> textures = no_textures();
  float normal_scale = 1.0f;  // how much the normal map leans
  float bump_height = 0.1f;   // length that a bump texture's 1 stands for

  std::uint32_t& texture(MaterialInput input) { return textures[static_cast<std::size_t>(input)]; }
  std::uint32_t texture(MaterialInput input) const {
    return textures[static_cast<std::size_t>(input)];
  }
  bool opaque() const {
    return opacity >= 1.0f && texture(MaterialInput::kOpacity) == kNoTexture && !vertex_alpha;
  }

  static std::array<std::uint32_t, kMaterialInputs> no_textures() {
    std::array<std::uint32_t, kMaterialInputs> none;
    none.fill(kNoTexture);
    return none;
  }
};

struct TriangleMesh {
  std::vector<Imath::V3f> positions;
  std::vector<Imath::V3f> normals;  // unit, per vertex; empty: geometric normals
  std::vector<Imath::V2f> uvs;      // per vertex; may be empty
  std::vector<Imath::V2f> uvs1;     // a second set, for images that ask for it
  std::vector<Imath::V3f> colors;   // per vertex; multiply the material's color; may be empty
  std::vector<float> alphas;        // per vertex, for Material::vertex_alpha; may be empty
  std::vector<Imath::V3i> triangles;
};

struct Geometry {
  std::string name;
  std::variant<TriangleMesh, std::shared_ptr<const geom::HypertextureGeometry>> shape;
};

struct Instance {
  std::string name;
  std::uint32_t geometry = 0;
  std::uint32_t material = 0;
  std::optional<std::uint32_t>
      detached_material;        // hypertexture: for components other than the main one
  Imath::M44d object_to_world;  // row vectors: p' = p * M, as Imath has it
  std::optional<Imath::M44d> object_to_world_end;  // at the end of the frame, if it moves
  bool visible_to_camera = true;
  // To reflections, refractions and indirect light; if not, it lights nothing either.
  bool visible_to_bounces = true;
  bool casts_shadow = true;

  // At a time of the shutter, [0, 1]: interpolated as Embree does it.
  Imath::M44d to_world(float time) const {
    if (!object_to_world_end) return object_to_world;
    return object_to_world * (1.0 - double{time}) + *object_to_world_end * double{time};
  }
};

// The sky of a clear day with its sun; see light/sky.h. Angles in degrees.
struct SkyLight {
  float sun_elevation = 40.0f;  // above the horizon, [-90, 90]
  float sun_azimuth = 0.0f;     // 0: -z, 90: +x
  float turbidity = 3.0f;       // 2: very clear, 10: hazy
  float sun_diameter = 0.53f;
  Imath::V3f ground_color{0.2f};
};

struct EnvironmentLight {
  std::string file;             // absolute path of a lat-long image; empty: constant
  std::optional<SkyLight> sky;  // instead of the image; its sun is a distant light besides
  Imath::V3f radiance{1.0f};    // multiplies the image
  float rotation = 0.0f;        // degrees about +y
  bool visible_to_camera = true;
  std::uint32_t group = kNoGroup;
};

// Lights of the scene that are neither the environment nor materials that emit. Radiance is emitted
// on the side that the normal points to. Those that have a surface are geometry: they hide what is
// behind them unless `casts_shadow` is off.
struct LightFlags {
  bool visible_to_camera = true;
  bool casts_shadow = true;
};

// Emits from the side that cross(edge_u, edge_v) points to. Corner + edges, world space.
struct RectangleLight : LightFlags {
  std::string name;
  std::uint32_t group = kNoGroup;
  Imath::V3f corner{0.0f}, edge_u{1, 0, 0}, edge_v{0, 0, 1};
  Imath::V3f radiance{1.0f};
};

struct DiskLight : LightFlags {
  std::string name;
  std::uint32_t group = kNoGroup;
  Imath::V3f position{0.0f}, normal{0, -1, 0};
  float radius = 1.0f;
  Imath::V3f radiance{1.0f};
};

struct SphereLight : LightFlags {
  std::string name;
  std::uint32_t group = kNoGroup;
  Imath::V3f position{0.0f};
  float radius = 1.0f;
  Imath::V3f radiance{1.0f};
};

// A point, or a spot about `direction` that fades from inner to outer angle (degrees from the
// axis).
struct PointLight {
  std::string name;
  std::uint32_t group = kNoGroup;
  Imath::V3f position{0.0f}, direction{0, 0, -1};
  Imath::V3f intensity{1.0f};  // per steradian
  float inner_angle = 0.0f, outer_angle = 180.0f;
};

struct DistantLight {
  std::string name;
  std::uint32_t group = kNoGroup;
  Imath::V3f direction{0, -1, 0};  // that light travels in
  Imath::V3f irradiance{1.0f};     // on a surface that faces it
  float angular_diameter = 0.0f;   // degrees
  bool visible_to_camera = true;
};

enum class Projection { kPerspective, kOrthographic, kSpherical };

struct SceneCamera {
  Projection projection = Projection::kPerspective;
  Imath::V3f position{0, 0, 5}, look_at{0.0f}, up{0, 1, 0};
  float vertical_fov = 40.0f;  // degrees; perspective
  float height = 2.0f;         // of what the image shows, a length; orthographic
  // Thin lens: 0 is a pinhole. Points at `focus_distance` along the view are sharp; 0: at look_at.
  float aperture_radius = 0.0f, focus_distance = 0.0f;
  int blades = 0;               // edges of the aperture; fewer than 3: a circle
  float blade_rotation = 0.0f;  // degrees
  // Part of the frame, in which moving instances go from their start to their end, that the shutter
  // is open for.
  float shutter_open = 0.0f, shutter_close = 1.0f;
};

// Pixel window [x0, x1) x [y0, y1) of the full resolution, y down.
struct Crop {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool operator==(const Crop&) const = default;
};

// How samples lie about a pixel's centre; the radius of a box or triangle is half its width.
enum class PixelFilter { kBox, kTriangle, kGaussian, kBlackmanHarris };

struct RenderSettings {
  int width = 960, height = 540;
  int spp = 64;  // at most, when noise_target is set
  // Pixels stop at about this standard error of their mean, relative to it; 0: all have spp
  // samples.
  float noise_target = 0.0f;
  int min_spp = 16;  // that the error is estimated from
  PixelFilter filter = PixelFilter::kBox;
  float filter_radius = 0.5f;  // pixels
  bool cryptomatte = false;
  bool denoise = false;       // an image layer beside the rendered one, where the build can do it
  int texture_memory = 1024;  // MB that texture tiles may take
  int max_depth = 8;          // path vertices beyond the first hit
  // Bounces of a kind that a path may have.
  int max_diffuse_depth = 1024, max_glossy_depth = 1024, max_transmission_depth = 1024;
  float indirect_clamp =
      0.0f;  // brightest contribution of light that bounced more than once; 0: any
  std::uint32_t seed = 0;
  std::optional<Crop> crop;
  float exposure = 0.0f;  // stops; PNG preview only
  // Reflections and refractions that are seen by way of rougher surfaces are widened to at least
  // this share of their roughness: blurs caustics, which else are grains. 0: exact.
  float regularization = 0.0f;
};

struct Scene {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Geometry> geometries;
  std::vector<Instance> instances;
  std::optional<EnvironmentLight> environment;
  std::vector<RectangleLight> rectangles;
  std::vector<DiskLight> disks;
  std::vector<SphereLight> spheres;
  std::vector<PointLight> points;
  std::vector<DistantLight> distants;
  std::vector<std::string> light_groups;  // names
  SceneCamera camera;
  RenderSettings settings;
};

}  // namespace morsel::render
