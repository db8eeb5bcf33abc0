// SPDX-License-Identifier: Apache-2.0
// A scene file, read and checked without rendering, in a folder with a mesh, a model and a file
// that stands for an image. Lines "--set PATH=VALUE" at the beginning are overrides.
#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/load_scene.h"
#include "renderer/scene/scene_identity.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"
#include "topology/cache_file.h"

namespace {

namespace fs = std::filesystem;
using morsel::test::require;
using namespace morsel::render;

// One level down, so that what leaves the scene's folder by "..", is seen.
const fs::path& folder() {
  static const fs::path path = [] {
    const fs::path inner = morsel::test::scratch_folder() / "scene";
    fs::create_directory(inner);
    morsel::test::write_file(inner / "triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    morsel::test::write_file(
        inner / "model.gltf",
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})");
    morsel::test::write_file(inner / "image.png", "an image, for all that a loader knows");
    return inner;
  }();
  return path;
}

bool is_given(const fs::path& name) {
  return name == "triangle.obj" || name == "model.gltf" || name == "image.png" ||
         name == "scene.json";
}

// What an input left behind must be within the folder, and goes.
void clean_up() {
  for (const auto& entry : fs::directory_iterator(morsel::test::scratch_folder()))
    require(entry.path() == folder(), "a scene writes in its folder alone");
  for (const auto& entry : fs::directory_iterator(folder()))
    if (!is_given(entry.path().filename())) fs::remove_all(entry.path());
}

std::vector<Override> take_overrides(std::string& text) {
  constexpr std::string_view kSet = "--set ";
  std::vector<Override> overrides;
  while (text.starts_with(kSet)) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    overrides.push_back(parse_override(text.substr(kSet.size(), end - kSet.size())));
    text.erase(0, end + 1);
  }
  return overrides;
}

void check_loaded(const Scene& scene) {
  for (const Instance& i : scene.instances) {
    require(i.geometry < scene.geometries.size(), "an instance has a geometry");
    require(i.material < scene.materials.size(), "an instance has a material");
  }
  for (const Material& m : scene.materials)
    for (const std::uint32_t t : m.textures)
      require(t == kNoTexture || t < scene.textures.size(), "a material's textures are there");
  require(scene.settings.width > 0 && scene.settings.height > 0, "a picture has pixels");
}

// The problems that a check finds; empty where it was stopped.
std::optional<std::vector<std::string>> problems_of(const fs::path& file,
                                                    const std::vector<Override>& overrides,
                                                    const LoadOptions& options) {
  try {
    auto problems = check_scene(file, overrides, options);
    for (const std::string& problem : problems)
      require(problem.starts_with(folder().string()), "a problem names its file");
    return problems;
  } catch (const morsel::topology::Cancelled&) {
    return std::nullopt;
  }
}

void load(const fs::path& file, const LoadOptions& options,
          const std::optional<std::vector<std::string>>& problems) {
  try {
    const LoadedScene loaded = load_scene(file, {}, options);
    require(!problems || problems->empty(), "a scene with problems is not loaded");
    check_loaded(loaded.scene);
    require(scene_identity(file, {}, loaded, false) == scene_identity(file, {}, loaded, false),
            "a scene is itself");
  } catch (const morsel::params::InputError&) {
    require(!problems || !problems->empty(), "a scene without problems is loaded");
  } catch (const morsel::topology::Cancelled&) {
  } catch (const morsel::topology::CacheError&) {
  } catch (const morsel::topology::MemoryLimit&) {
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 1 << 14;
  if (size > kLongest) return 0;
  std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const std::vector<Override> overrides = take_overrides(text);
    const fs::path file = morsel::test::write_file(folder() / "scene.json", text);
    const morsel::test::Deadline deadline(std::chrono::milliseconds(300));
    LoadOptions options;
    options.execution.cancel = &deadline.stop();
    options.execution.max_bytes = 64u << 20;
    options.warn = [](const std::string& warning) {
      require(!warning.empty(), "warnings say something");
    };
    const auto problems = problems_of(file, overrides, options);
    // Overrides are the user's: they may name any place to write to, so nothing is loaded with
    // them.
    if (overrides.empty()) load(file, options, problems);
  } catch (const morsel::params::InputError&) {  // of an override's text
  }
  clean_up();
  return 0;
}
