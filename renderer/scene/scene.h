// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace morsel::geom {
class HypertextureGeometry;
}

// A scene as plain data: what the loader makes and the integrator reads. Indices refer to the
// vectors of Scene. World space is right-handed; lengths are scene units; colours are scene-linear
// Rec. 709.
namespace morsel::render {

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

  Imath::V3f emission{0.0f};  // radiance, on both sides
  float opacity = 1.0f;       // share of rays that the surface is there for
};

struct TriangleMesh {
  std::vector<Imath::V3f> positions;
  std::vector<Imath::V3f> normals;  // unit, per vertex; empty: geometric normals
  std::vector<Imath::V2f> uvs;      // per vertex; may be empty
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
};

struct EnvironmentLight {
  std::string file;           // absolute path of a lat-long image; empty: constant
  Imath::V3f radiance{1.0f};  // multiplies the image
  float rotation = 0.0f;      // degrees about +y
  bool visible_to_camera = true;
};

// Emits from the side that cross(edge_u, edge_v) points to. Corner + edges, world space.
struct RectangleLight {
  std::string name;
  Imath::V3f corner{0.0f}, edge_u{1, 0, 0}, edge_v{0, 0, 1};
  Imath::V3f radiance{1.0f};
  bool visible_to_camera = true;
};

struct PerspectiveCamera {
  Imath::V3f position{0, 0, 5}, look_at{0.0f}, up{0, 1, 0};
  float vertical_fov = 40.0f;  // degrees
};

// Pixel window [x0, x1) x [y0, y1) of the full resolution, y down.
struct Crop {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct RenderSettings {
  int width = 960, height = 540;
  int spp = 64;
  int max_depth = 8;  // path vertices beyond the first hit
  std::uint32_t seed = 0;
  std::optional<Crop> crop;
  float exposure = 0.0f;  // stops; PNG preview only
  // Reflections and refractions that are seen by way of rougher surfaces are widened to at least
  // this share of their roughness: blurs caustics, which else are grains. 0: exact.
  float regularization = 0.0f;
};

struct Scene {
  std::vector<Material> materials;
  std::vector<Geometry> geometries;
  std::vector<Instance> instances;
  std::optional<EnvironmentLight> environment;
  std::vector<RectangleLight> rectangles;
  PerspectiveCamera camera;
  RenderSettings settings;
};

}  // namespace morsel::render
