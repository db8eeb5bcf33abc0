// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/synonyms.h"

#include <algorithm>
#include <cctype>

#include "hypertexture_geom/params/parameter.h"

namespace morsel::params {
namespace {

// "lookAt", "look-at" and "look_at" are one word.
std::string plain(std::string_view name) {
  std::string text;
  for (const char c : name)
    if (c != '_' && c != '-' && c != ' ')
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

// By what is ours. A word that stands twice means whichever of the two is known where it is used.
const std::vector<std::pair<std::string_view, std::string_view>>& synonyms() {
  static const std::vector<std::pair<std::string_view, std::string_view>> table{
      // Sections of a scene.
      {"sensor", "camera"},
      {"view", "camera"},
      {"film", "render"},
      {"integrator", "render"},
      {"sampler", "render"},
      {"settings", "render"},
      {"options", "render"},
      {"objects", "instances"},
      {"primitives", "instances"},
      {"nodes", "instances"},
      {"shapes", "geometries"},
      {"meshes", "geometries"},
      {"surfaces", "geometries"},
      {"bsdfs", "materials"},
      {"shaders", "materials"},
      {"emitters", "lights"},
      {"lamps", "lights"},
      {"images", "textures"},
      // Cameras.
      {"fov", "vertical_fov"},
      {"fovy", "vertical_fov"},
      {"yfov", "vertical_fov"},
      {"fieldofview", "vertical_fov"},
      {"angle", "vertical_fov"},
      {"target", "look_at"},
      {"lookat", "look_at"},
      {"to", "look_at"},
      {"at", "look_at"},
      {"eye", "position"},
      {"origin", "position"},
      {"from", "position"},
      {"lookfrom", "position"},
      {"location", "position"},
      {"center", "position"},
      {"vup", "up"},
      {"upvector", "up"},
      {"aperture", "aperture_radius"},
      {"lensradius", "aperture_radius"},
      {"focaldistance", "focus_distance"},
      {"focusdist", "focus_distance"},
      {"shutteropen", "shutter"},
      {"shutterclose", "shutter"},
      {"pinhole", "perspective"},
      {"panorama", "spherical"},
      {"environment", "spherical"},
      {"latlong", "spherical"},
      // The picture.
      {"samples", "spp"},
      {"samplecount", "spp"},
      {"samplesperpixel", "spp"},
      {"pixelsamples", "spp"},
      {"width", "resolution"},
      {"height", "resolution"},
      {"xresolution", "resolution"},
      {"yresolution", "resolution"},
      {"imagesize", "resolution"},
      {"size", "resolution"},
      {"maxbounces", "max_depth"},
      {"bounces", "max_depth"},
      {"depth", "max_depth"},
      {"raydepth", "max_depth"},
      {"clamp", "indirect_clamp"},
      {"rfilter", "filter"},
      {"pixelfilter", "filter"},
      {"denoiser", "denoise"},
      // Materials.
      {"albedo", "color"},
      {"reflectance", "color"},
      {"basecolor", "color"},
      {"basecolorfactor", "color"},
      {"diffusecolor", "color"},
      {"kd", "color"},
      {"rgb", "color"},
      {"eta", "ior"},
      {"intior", "ior"},
      {"indexofrefraction", "ior"},
      {"refractiveindex", "ior"},
      {"metalness", "metallic"},
      {"emissive", "emission"},
      {"emissivecolor", "emission"},
      {"emissioncolor", "emission"},
      {"le", "emission"},
      {"glossiness", "roughness"},
      {"coat", "clearcoat"},
      {"spectrans", "transmission"},
      {"bumpmap", "bump_texture"},
      {"normalmap", "normal_texture"},
      {"alpha", "opacity"},
      {"alpha", "roughness"},
      {"transparency", "opacity"},
      {"lambert", "diffuse"},
      {"lambertian", "diffuse"},
      {"matte", "diffuse"},
      {"orennayar", "diffuse"},
      {"glass", "dielectric"},
      {"metal", "conductor"},
      {"mirror", "conductor"},
      {"disney", "principled"},
      {"uber", "principled"},
      {"pbr", "principled"},
      {"standardsurface", "principled"},
      // Fields.
      {"from", "start"},
      {"a", "start"},
      {"to", "end"},
      {"b", "end"},
      // Geometries, instances and textures.
      {"obj", "mesh"},
      {"ply", "mesh"},
      {"gltf", "mesh"},
      {"triangles", "mesh"},
      {"trianglemesh", "mesh"},
      {"plane", "rectangle"},
      {"quad", "rectangle"},
      {"implicit", "hypertexture"},
      {"sdf", "hypertexture"},
      {"filename", "file"},
      {"path", "file"},
      {"url", "file"},
      {"uri", "file"},
      {"id", "name"},
      {"bsdf", "material"},
      {"shader", "material"},
      {"shape", "geometry"},
      {"object", "geometry"},
      {"mesh", "geometry"},
      {"matrix", "transform"},
      {"toworld", "transform"},
      {"position", "translate"},
      {"translation", "translate"},
      {"rotation", "rotate"},
      {"bitmap", "image"},
      {"imagemap", "image"},
      {"checkerboard", "checker"},
      // Lights.
      {"infinite", "environment"},
      {"constant", "environment"},
      {"envmap", "environment"},
      {"dome", "environment"},
      {"hdri", "environment"},
      {"skydome", "sky"},
      {"sunsky", "sky"},
      {"area", "rectangle"},
      {"spot", "point"},
      {"omni", "point"},
      {"directional", "distant"},
      {"sun", "distant"},
      {"intensity", "radiance"},
      {"power", "radiance"},
      {"strength", "radiance"},
      {"color", "radiance"},
      {"l", "radiance"},
      {"emission", "radiance"},
      {"radiance", "intensity"},
      {"power", "intensity"},
      {"strength", "intensity"},
      {"color", "intensity"},
      {"radiance", "irradiance"},
      {"intensity", "irradiance"},
      {"strength", "irradiance"},
      {"color", "irradiance"},
      {"coneangle", "outer_angle"},
      {"cutoffangle", "outer_angle"},
      // Fields.
      {"octaves", "layers"},
      {"persistence", "hurst"},
      {"noisetype", "noise"},
      {"gabor", "sparse_convolution"},
      {"billow", "turbulence"},
      {"ridge", "ridged"},
      {"ridgedmultifractal", "ridged"},
      {"domainwarp", "warp"},
      {"fractal", "fbm"},
      {"box", "rounded_box"},
      {"cube", "rounded_box"},
      {"cylinder", "capsule"},
      {"plane", "slab"},
      {"blobs", "metaballs"},
  };
  return table;
}

std::string suggested_name(std::string_view name, const std::vector<std::string>& known) {
  const auto is_known = [&](std::string_view word) {
    return std::find(known.begin(), known.end(), word) != known.end();
  };
  const std::string word = plain(name);
  for (const std::string& candidate : known)
    if (plain(candidate) == word) return candidate;
  for (const auto& [theirs, ours] : synonyms())
    if (theirs == word && is_known(ours)) return std::string(ours);
  return nearest_name(name, known);
}

}  // namespace morsel::params
