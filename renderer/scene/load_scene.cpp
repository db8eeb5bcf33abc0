// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/load_scene.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <utility>

#include "hypertexture_geom/embree/geometry.h"
#include "renderer/mesh/mesh_file.h"
#include "renderer/mesh/normals.h"
#include "renderer/mesh/primitives.h"
#include "renderer/scene/cache_store.h"
#include "renderer/scene/declarations.h"
#include "renderer/scene/model.h"
#include "renderer/scene/readers.h"
#include "renderer/scene/scene_json.h"
#include "renderer/scene/scene_reference.h"
#include "renderer/scene/transform.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::JsonReader;
using params::Place;

const json kNoObject = json::object();
const json kNoArray = json::array();

// Whether nothing in the scene emits anything.
bool is_dark(const Scene& scene) {
  const auto shines = [](const Imath::V3f& light) {
    return light.x > 0.0f || light.y > 0.0f || light.z > 0.0f;
  };
  const auto some = [](const auto& list, auto&& does) {
    return std::any_of(list.begin(), list.end(), does);
  };
  const auto radiates = [&](const auto& light) { return shines(light.radiance); };
  const auto emits = [&](std::uint32_t material) {
    return shines(scene.materials[material].emission);
  };
  return !(scene.environment && radiates(*scene.environment)) &&
         !some(scene.rectangles, radiates) && !some(scene.disks, radiates) &&
         !some(scene.spheres, radiates) &&
         !some(scene.points, [&](const auto& light) { return shines(light.intensity); }) &&
         !some(scene.distants, [&](const auto& light) { return shines(light.irradiance); }) &&
         !some(scene.instances, [&](const Instance& instance) {
           return emits(instance.material) ||
                  (instance.detached_material && emits(*instance.detached_material));
         });
}

// Reads a document section by section into `result`. With a list of problems, a problem is noted
// and the next element is read; without one it is thrown.
class SceneLoader {
 public:
  SceneLoader(const SceneDocument& document, const LoadOptions& options,
              std::vector<std::string>* problems)
      : document_(document), options_(options), problems_(problems), store_(document) {}

  // Everything that is quick comes before what can take minutes.
  LoadedScene load() {
    attempt([&] {
      scene_.camera = read_camera(section("camera", kNoObject), document_.place() / "camera");
    });
    attempt([&] {
      scene_.settings = read_settings(section("render", kNoObject), document_.place() / "render");
    });
    load_textures();
    load_materials();
    load_lights();
    const bool models = !section("models", kNoArray).empty();  // which may bring lights
    if (list_all_geometries()) {
      load_instances();
      if (!models) warn_of_darkness();
      load_geometries();
      keep_used_geometries();
    }
    load_models();
    if (models) warn_of_darkness();
    return std::move(result_);
  }

 private:
  template <class Read>
  void attempt(Read&& read) {
    if (problems_ == nullptr) {
      document_.explain(std::forward<Read>(read));
      return;
    }
    try {
      document_.explain(std::forward<Read>(read));
    } catch (const topology::Cancelled&) {
      throw;
    } catch (const std::exception& e) {
      problems_->push_back(e.what());
    }
  }

  const json& section(const char* name, const json& if_absent) const {
    const auto found = document_.root().find(name);
    return found != document_.root().end() ? *found : if_absent;
  }

  // Calls read(element, place, index) for each element of an array.
  template <class Read>
  void for_each(const char* name, Read&& read) {
    const json& array = section(name, kNoArray);
    for (std::size_t i = 0; i < array.size(); ++i)
      attempt([&] { read(array[i], document_.place() / name / i, i); });
  }

  void warn(const std::string& message) const {
    if (options_.warn) options_.warn(message);
  }

  bool has_problems() const { return problems_ != nullptr && !problems_->empty(); }

  // A scene without light is a valid one, but hardly what anyone wants to see.
  void warn_of_darkness() const {
    if (has_problems()) return;  // a light may be what is wrong
    if (is_dark(scene_))
      warn(fmt::format(
          "{}: /lights: nothing shines: there is no light, no environment and no instance of a "
          "material with emission, so the picture will be black; {{\"type\": \"environment\"}} is "
          "light from everywhere",
          document_.place().file));
  }

  // Adds an element's name, even if the rest of it is wrong: what uses it is not to blame. Whether
  // another has that name.
  static bool list_name(const json& object, std::vector<std::string>& names) {
    const bool named = object.is_object() && object.contains("name") && object["name"].is_string();
    std::string name = named ? object["name"].get<std::string>() : "";
    const bool repeated = std::find(names.begin(), names.end(), name) != names.end();
    names.push_back(std::move(name));
    return repeated;
  }

  void load_textures() {
    for_each("textures", [&](const json& object, const Place& place, std::size_t) {
      const bool repeated = list_name(object, texture_names_);
      scene_.textures.emplace_back().name = texture_names_.back();
      Texture texture = read_texture(object, place);
      if (repeated)
        (place / "name").fail(fmt::format("\"{}\" is the name of another texture", texture.name));
      if (auto* image = std::get_if<ImageTexture>(&texture.kind)) {
        if (image->file.find("<UDIM>") == std::string::npos)
          image->file = readable_image(image->file, place / "file");
        else
          image->file = std::filesystem::absolute(document_.resolve(image->file)).string();
      }
      scene_.textures.back() = std::move(texture);
    });
  }

  void load_models() {
    for_each("models", [&](const json& object, const Place& place, std::size_t) {
      const JsonReader reader(object, model_declaration(), place);
      const std::filesystem::path file = document_.resolve(reader.string("file"));
      Model model;
      try {
        model = load_model(file, options_.warn);
      } catch (const MeshError& e) {
        (place / "file").fail(e.what());
      }
      ModelPlacement placement;
      placement.name = reader.string("name");
      if (placement.name.empty()) placement.name = file.stem().string();
      placement.transform = make_transform(reader.vector3("scale"), reader.vector3("rotate"),
                                           reader.vector3("translate"));
      if (!is_invertible(placement.transform))
        (place / "scale").fail("must not flatten the model: no component may be 0");
      placement.lights = reader.boolean("lights");
      placement.camera =
          reader.boolean("camera") && document_.root().find("camera") == document_.root().end();
      add_model(std::move(model), placement, scene_);
    });
  }

  void load_materials() {
    for_each("materials", [&](const json& object, const Place& place, std::size_t) {
      const bool repeated = list_name(object, material_names_);
      scene_.materials.emplace_back();
      scene_.materials.back() = read_material(object, place, scene_);
      if (repeated)
        (place / "name")
            .fail(fmt::format("\"{}\" is the name of another material", material_names_.back()));
    });
  }

  void load_lights() {
    for_each("lights", [&](const json& object, const Place& place, std::size_t) {
      const bool had_environment = scene_.environment.has_value();
      read_light(object, place, scene_);
      if (had_environment || !scene_.environment || scene_.environment->file.empty()) return;
      std::string& file = scene_.environment->file;
      const std::string name = std::exchange(file, "");
      file = readable_image(name, place / "file");
    });
  }

  std::string readable_image(const std::string& name, const Place& place) const {
    const std::filesystem::path file = std::filesystem::absolute(document_.resolve(name));
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || !std::ifstream(file))
      place.fail(fmt::format("{}: no such file, or not readable", file.string()));
    if (options_.check_image) {
      try {
        options_.check_image(file);
      } catch (const std::runtime_error& e) {
        place.fail(e.what());
      }
    }
    return file.string();
  }

  bool list_all_geometries() {
    bool listed = false;
    attempt([&] {
      entries_ = list_geometries(document_);
      listed = true;
    });
    for (const GeometryEntry& entry : entries_) geometry_names_.push_back(entry.name);
    used_.assign(entries_.size(), false);
    return listed;
  }

  void load_instances() {
    for_each("instances", [&](const json& object, const Place& place, std::size_t) {
      const InstanceEntry entry = read_instance(object, place);
      Instance instance;
      instance.name = entry.name;
      instance.object_to_world = entry.object_to_world;
      instance.object_to_world_end = entry.object_to_world_end;
      instance.visible_to_camera = entry.visible_to_camera;
      instance.visible_to_bounces = entry.visible_to_bounces;
      instance.casts_shadow = entry.casts_shadow;
      instance.geometry =
          find_name(entry.geometry, geometry_names_, "geometry", place / "geometry");
      instance.material =
          find_name(entry.material, material_names_, "material", place / "material");
      used_[instance.geometry] = true;
      if (!entry.detached_material.empty()) {
        instance.detached_material = find_name(entry.detached_material, material_names_, "material",
                                               place / "detached_material");
        if (entries_[instance.geometry].type != "hypertexture")
          (place / "detached_material")
              .fail(fmt::format("geometry \"{}\" is a {}; only a hypertexture has detached pieces",
                                entry.geometry, entries_[instance.geometry].type));
      }
      scene_.instances.push_back(std::move(instance));
    });
  }

  void load_geometries() {
    scene_.geometries.resize(entries_.size());
    // Hypertextures last: building a cache can take minutes, and all other problems come first.
    for (const bool hypertextures : {false, true})
      for (std::size_t i = 0; i < entries_.size(); ++i) {
        if ((entries_[i].type == "hypertexture") != hypertextures) continue;
        scene_.geometries[i].name = entries_[i].name;
        attempt([&] {
          const Place place = document_.place() / "geometries" / entries_[i].index;
          load_geometry(i, document_.root()["geometries"][entries_[i].index], place);
        });
      }
  }

  void load_geometry(std::size_t i, const json& object, const Place& place) {
    const GeometryEntry& entry = entries_[i];
    if (!used_[i] && !has_problems())  // an instance may be what is wrong
      warn(fmt::format("geometry \"{}\" is used by no instance", entry.name));
    auto& shape = scene_.geometries[i].shape;
    if (entry.type == "mesh") {
      shape = read_mesh(object, place);
    } else if (entry.type == "rectangle") {
      const JsonReader reader(object, rectangle_declaration(), place);
      shape = make_rectangle(Imath::V2f(reader.vector2("size")));
    } else if (entry.type == "sphere") {
      const JsonReader reader(object, sphere_declaration(), place);
      shape = make_sphere(static_cast<float>(reader.number("radius")),
                          static_cast<int>(reader.integer("segments")));
    } else {
      const geom::Hypertexture hypertexture =
          read_hypertexture(document_, entry, options_.execution);
      if (problems_ != nullptr)
        check_cache(hypertexture);
      else if (used_[i])
        shape = make_hypertexture(hypertexture);
    }
  }

  TriangleMesh read_mesh(const json& object, const Place& place) const {
    const JsonReader reader(object, mesh_declaration(), place);
    try {
      TriangleMesh mesh = load_mesh(document_.resolve(reader.string("file")));
      if (mesh.normals.empty() && reader.boolean("smooth")) mesh.normals = smooth_normals(mesh);
      return mesh;
    } catch (const MeshError& e) {
      reader.place("file").fail(e.what());
    }
  }

  void check_cache(const geom::Hypertexture& hypertexture) const {
    const CacheInspection found =
        inspect_cache(cache_file_of(document_, hypertexture), hypertexture.hash);
    if (found.state == CacheState::kStale || found.state == CacheState::kDamaged)
      throw topology::CacheError(found.problem);
  }

  // Beside the topology cache, where that could be written itself.
  void keep_bricks(const std::filesystem::path& cache, geom::BrickKeeping& bricks) const {
    std::error_code ignored;
    if (options_.max_brick_file == 0 || !std::filesystem::exists(cache, ignored)) return;
    bricks.stem = cache;
    if (cache.extension() == ".topo") bricks.stem.replace_extension();
    bricks.max_bytes = options_.max_brick_file;
    // A share that is only read is no reason for a warning.
    const std::filesystem::path folder = cache.has_parent_path() ? cache.parent_path() : ".";
    bricks.may_write = ::access(folder.c_str(), W_OK | X_OK) == 0;
    bricks.warn = [this](const std::string& text) { warn(text); };
  }

  std::shared_ptr<const geom::HypertextureGeometry> make_hypertexture(
      const geom::Hypertexture& hypertexture) {
    const StoredCache stored = store_.get(hypertexture, options_.execution, options_.warn);
    const topology::Topology& topology = stored.cache->topology;
    for (const std::string& text : topology_warnings(hypertexture, topology)) warn(text);
    geom::GeometryOptions ray_options;
    ray_options.keep = hypertexture.keep;
    ray_options.solver = hypertexture.solver;
    ray_options.membership = hypertexture.membership;
    keep_bricks(stored.file, ray_options.bricks);
    auto geometry = std::make_shared<const geom::HypertextureGeometry>(
        hypertexture.field, stored.cache, ray_options, options_.execution);

    HypertextureReport report;
    report.geometry = hypertexture.name;
    report.cache_file = stored.file;
    report.built = stored.built;
    report.build_seconds = stored.cache->seconds;
    report.components = topology.components.size();
    const std::vector<bool> kept =
        topology::kept_components(hypertexture.keep, topology.components, topology.octree());
    report.kept = static_cast<std::uint64_t>(std::count(kept.begin(), kept.end(), true));
    report.certified = topology.certified;
    report.bricks = geometry->statistics().bricks;
    report.bricks_were_read = geometry->statistics().bricks_were_read;
    report.bytes = geometry->statistics().bytes;
    result_.hypertextures.push_back(std::move(report));
    if (geometry->statistics().bricks == 0)
      warn(fmt::format("geometry \"{}\": nothing of it is kept by the rule \"{}\"",
                       hypertexture.name, hypertexture.keep.to_string()));
    return geometry;
  }

  // Drops geometries without instances and renumbers the rest.
  void keep_used_geometries() {
    std::vector<std::uint32_t> renumbered(entries_.size(), 0);
    std::vector<Geometry> kept;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (!used_[i]) continue;
      renumbered[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(std::move(scene_.geometries[i]));
    }
    scene_.geometries = std::move(kept);
    for (Instance& instance : scene_.instances) instance.geometry = renumbered[instance.geometry];
  }

  const SceneDocument& document_;
  const LoadOptions& options_;
  std::vector<std::string>* problems_;
  CacheStore store_;
  LoadedScene result_;
  Scene& scene_ = result_.scene;
  std::vector<GeometryEntry> entries_;
  std::vector<std::string> geometry_names_;
  std::vector<std::string> material_names_, texture_names_;
  std::vector<bool> used_;
};

}  // namespace

LoadedScene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides,
                       const LoadOptions& options) {
  const SceneDocument document(file, overrides);
  return SceneLoader(document, options, nullptr).load();
}

std::vector<std::string> check_scene(const std::filesystem::path& file,
                                     const std::vector<Override>& overrides,
                                     const LoadOptions& options) {
  std::vector<std::string> problems;
  try {
    const SceneDocument document(file, overrides);
    // The loader stops at the first problem of each object, the declarations know all of them; but
    // only the loader knows what values mean to one another.
    problems = declared_problems(document);
    std::vector<std::string> more;
    SceneLoader(document, options, &more).load();
    for (std::string& problem : more)
      if (std::find(problems.begin(), problems.end(), problem) == problems.end())
        problems.push_back(std::move(problem));
  } catch (const params::InputError& e) {
    problems.push_back(e.what());
  }
  return problems;
}

}  // namespace morsel::render
