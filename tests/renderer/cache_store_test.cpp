// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/cache_store.h"

#include <gtest/gtest.h>

#include "scene_files.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using test::TemporaryFolder;

class CacheStoreTest : public ::testing::Test {
 protected:
  SceneDocument document(const std::vector<std::string>& set = {}) {
    std::vector<Override> overrides;
    for (const std::string& text : set) overrides.push_back(parse_override(text));
    return {folder_.write("scene.json", test::kSmallScene), overrides};
  }

  geom::Hypertexture rock(const SceneDocument& from) {
    return read_hypertexture(from, find_hypertexture(from, "rock"));
  }

  StoredCache get(const std::vector<std::string>& set = {}) {
    const SceneDocument from = document(set);
    return CacheStore(from).get(rock(from), execution_,
                                [this](const std::string& w) { warnings_.push_back(w); });
  }

  TemporaryFolder folder_;
  std::vector<std::string> warnings_;
  topology::Execution execution_;
};

TEST_F(CacheStoreTest, DefaultNameCarriesTheFingerprint) {
  const SceneDocument from = document();
  const geom::Hypertexture h = rock(from);
  EXPECT_EQ(cache_file_of(from, h),
            folder_ / ("scene.cache/rock-" + h.hash.substr(0, 16) + ".topo"));
  const SceneDocument other = document({"geometries.rock.field.density.radius=0.9"});
  EXPECT_NE(cache_file_of(other, rock(other)), cache_file_of(from, h));
}

TEST_F(CacheStoreTest, NamesOfGeometriesCannotLeaveTheFolder) {
  const SceneDocument from = document({"geometries.rock.name=../a b"});
  const geom::Hypertexture h = read_hypertexture(from, find_hypertexture(from, "../a b"));
  EXPECT_EQ(cache_file_of(from, h).parent_path(), folder_ / "scene.cache");
  EXPECT_EQ(cache_file_of(from, h).filename().string().substr(0, 7), "___a_b-");
}

// A scene from elsewhere writes in its own folder alone; what the user sets is the user's.
TEST_F(CacheStoreTest, ScenesCannotWriteOutsideOfTheirFolder) {
  const auto cache_of = [&](const std::string& name, const std::vector<std::string>& set) {
    nlohmann::json scene = nlohmann::json::parse(test::kSmallScene);
    for (nlohmann::json& g : scene["geometries"])
      if (g["name"] == "rock") g["cache"] = name;
    std::vector<Override> overrides;
    for (const std::string& text : set) overrides.push_back(parse_override(text));
    const SceneDocument from(folder_.write("sub/scene.json", scene.dump()), overrides);
    return cache_file_of(from, rock(from));
  };
  for (const char* name : {"../my.topo", "a/../../my.topo", "/tmp/my.topo", "./../my.topo", ".."}) {
    try {
      cache_of(name, {});
      ADD_FAILURE() << name << " is taken";
    } catch (const params::InputError& e) {
      const std::string what = e.what();
      EXPECT_NE(what.find("/cache: "), std::string::npos) << what;
      EXPECT_NE(what.find(std::string("\"") + name + "\""), std::string::npos) << what;
    }
  }
  for (const char* name : {"my.topo", "a/my.topo", "a/../my.topo", "..my.topo"})
    EXPECT_EQ(cache_of(name, {}), folder_ / "sub" / name);
  EXPECT_EQ(cache_of("my.topo", {"geometries.rock.cache=../my.topo"}), folder_ / "sub/../my.topo");
  EXPECT_EQ(cache_of("../x", {"geometries.rock.cache=/tmp/my.topo"}), "/tmp/my.topo");
  // An override of something else does not make it the user's.
  EXPECT_THROW(cache_of("../my.topo", {"geometries.rock.keep=all"}), params::InputError);
}

TEST_F(CacheStoreTest, BuildsThenReads) {
  const StoredCache built = get();
  EXPECT_TRUE(built.built);
  const StoredCache read = get();
  EXPECT_FALSE(read.built);
  EXPECT_EQ(read.file, built.file);
  EXPECT_EQ(read.cache->topology.nodes.size(), built.cache->topology.nodes.size());
  EXPECT_EQ(folder_.count_files(), 2u);  // the scene and the cache, nothing temporary
}

TEST_F(CacheStoreTest, ExplicitFileIsRelativeToTheScene) {
  EXPECT_EQ(get({"geometries.rock.cache=sub/my.topo"}).file, folder_ / "sub/my.topo");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "sub/my.topo"));
}

TEST_F(CacheStoreTest, CacheOfAnotherFieldIsAnError) {
  get({"geometries.rock.cache=my.topo"});
  const std::string before = test::read_text(folder_ / "my.topo");
  try {
    get({"geometries.rock.cache=my.topo", "geometries.rock.field.density.radius=0.9"});
    FAIL() << "accepted";
  } catch (const topology::CacheError& e) {
    const std::string what = e.what();
    for (const char* part : {"my.topo", "another field", "rock", "scene.json"})
      EXPECT_NE(what.find(part), std::string::npos) << part << " in " << what;
  }
  EXPECT_EQ(test::read_text(folder_ / "my.topo"), before);
}

TEST_F(CacheStoreTest, DamagedCacheIsAnError) {
  const std::filesystem::path file = get().file;
  std::string bytes = test::read_text(file);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_THROW(get(), topology::CacheError);
  std::filesystem::resize_file(file, bytes.size() / 2);
  EXPECT_THROW(get(), topology::CacheError);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(CacheStoreTest, InspectionTellsStatesApart) {
  const SceneDocument from = document();
  const std::string hash = rock(from).hash;
  EXPECT_EQ(inspect_cache(folder_ / "gone.topo", hash).state, CacheState::kMissing);
  const std::filesystem::path file = get().file;
  EXPECT_EQ(inspect_cache(file, hash).state, CacheState::kCurrent);
  EXPECT_EQ(inspect_cache(file, "0123").state, CacheState::kStale);
  std::filesystem::resize_file(file, 40);
  EXPECT_EQ(inspect_cache(file, hash).state, CacheState::kDamaged);
  EXPECT_EQ(inspect_cache(folder_.path(), hash).state, CacheState::kDamaged);
}

TEST_F(CacheStoreTest, GoesOnInMemoryWhenItCannotWrite) {
  folder_.write("wall", "a file where a folder would have to be");
  const StoredCache stored = get({"geometries.rock.cache=wall/my.topo"});
  EXPECT_TRUE(stored.built);
  EXPECT_EQ(stored.cache->topology.components.size(), 1u);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("wall/my.topo"), std::string::npos) << warnings_[0];
}

TEST_F(CacheStoreTest, EqualFieldsShareOneCache) {
  const SceneDocument from = document({R"(geometries.ball={"name": "twin", "type": "hypertexture",
    "keep": "all", "field": {"density": {"type": "sphere", "radius": 1.0}, "modulations": []},
    "bounds": {"min": [-1.25, -1.25, -1.25], "max": [1.25, 1.25, 1.25]}})"});
  CacheStore store(from);
  const StoredCache a = store.get(rock(from), execution_, {});
  const StoredCache b =
      store.get(read_hypertexture(from, find_hypertexture(from, "twin")), execution_, {});
  EXPECT_EQ(a.cache, b.cache);
}

TEST_F(CacheStoreTest, HypertexturesAreFoundByName) {
  const SceneDocument from = document();
  EXPECT_EQ(find_hypertexture(from, "").name, "rock");
  EXPECT_THROW(find_hypertexture(from, "floor"), params::InputError);
  try {
    find_hypertexture(from, "rok");
    FAIL();
  } catch (const params::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"rock\""), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace morsel::render
