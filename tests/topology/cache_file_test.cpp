// SPDX-License-Identifier: Apache-2.0
// A cache file gives back what was written, or an error that names the file: never a crash, never a
// wrong octree.
#include "topology/cache_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <tuple>

#include "tests/topology/blobs.h"

namespace morsel::topology {
namespace {

namespace fs = std::filesystem;

class CacheFile : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("morsel_cache_test_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
    CertifyOptions options;
    options.box = Box(Imath::V3d(-2.0), Imath::V3d(5.0, 2.0, 2.0));
    cache_.topology = certify(testing::Blobs({{0, 0, 0}, {3, 0, 0}}, 1.0, 0.3), options);
    cache_.field_hash = "0123456789abcdef0123456789abcdef";
    cache_.field = {{"test", "blobs"}};
    cache_.seconds = 1.5;
    path_ = directory_ / "blobs.topo";
    write_cache(cache_, path_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string error_of(const fs::path& path) {
    try {
      read_cache(path);
    } catch (const CacheError& e) {
      return e.what();
    }
    return "";
  }

  fs::path directory_, path_;
  TopologyCache cache_;
};

TEST_F(CacheFile, RoundTrip) {
  const TopologyCache back = read_cache_of(path_, cache_.field_hash);
  EXPECT_EQ(back.bytes, fs::file_size(path_));
  EXPECT_EQ(back.field, cache_.field);
  EXPECT_EQ(back.seconds, 1.5);
  // The same leaves; nodes may be numbered otherwise.
  ASSERT_EQ(back.topology.nodes.size(), cache_.topology.nodes.size());
  std::vector<std::tuple<double, double, double, int, int, int, std::uint32_t>> leaves[2];
  const Topology* both[2] = {&back.topology, &cache_.topology};
  for (int i = 0; i < 2; ++i)
    both[i]->octree().for_each_leaf([&](const OctreeView::Leaf& leaf) {
      const OctreeNode& n = both[i]->nodes[leaf.node];
      leaves[i].emplace_back(leaf.box.min.x, leaf.box.min.y, leaf.box.min.z, leaf.depth, n.content,
                             n.faces, n.component);
    });
  EXPECT_EQ(leaves[0], leaves[1]);
  ASSERT_EQ(back.topology.components.size(), 2u);
  EXPECT_EQ(back.topology.components[1].volume_hi, cache_.topology.components[1].volume_hi);
  const nlohmann::json info = describe(back, KeepRule::parse("main"));
  for (const char* key :
       {"components", "components_bounds", "certified", "unresolved_cells", "engine",
        "critical_points", "kept", "field_hash", "seconds", "bytes", "octree"})
    EXPECT_TRUE(info.contains(key)) << key;
  EXPECT_EQ(info["components"], 2);
  EXPECT_EQ(info["kept"], 1);
  EXPECT_EQ(info["components_bounds"], nlohmann::json({2, 2}));
  EXPECT_TRUE(info["octree"].contains("leaves") && info["octree"].contains("depth"));
}

TEST_F(CacheFile, WritesNothingUnderTheFinalNameWhenItFails) {
  TopologyCache cache = cache_;
  EXPECT_THROW(write_cache(cache, directory_ / "missing" / "x.topo"), CacheError);
  EXPECT_FALSE(fs::exists(directory_ / "missing"));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(directory_)) ++files;
  EXPECT_EQ(files, 1);  // no temporary file stays behind
}

TEST_F(CacheFile, AnotherFieldsCacheIsNamed) {
  try {
    read_cache_of(path_, "ffffffffffffffffffffffffffffffff");
    FAIL();
  } catch (const CacheError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find(path_.string()), std::string::npos);
    EXPECT_NE(text.find("0123456789abcdef"), std::string::npos);
    EXPECT_NE(text.find("ffffffff"), std::string::npos);
  }
}

TEST_F(CacheFile, TruncatedAnywhere) {
  const std::uintmax_t size = fs::file_size(path_);
  for (const std::uintmax_t length : {std::uintmax_t{0}, std::uintmax_t{7}, std::uintmax_t{127},
                                      std::uintmax_t{128}, size / 2, size - 1}) {
    const fs::path cut = directory_ / "cut.topo";
    fs::copy_file(path_, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, length);
    EXPECT_NE(error_of(cut).find("cut.topo"), std::string::npos) << length;
  }
  EXPECT_NE(error_of(directory_ / "none.topo").find("none.topo"), std::string::npos);
  EXPECT_NE(error_of(directory_).find("directory"), std::string::npos);
}

TEST_F(CacheFile, AnyFlippedByteIsNoticed) {
  std::ifstream in(path_, std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  std::mt19937 random(1);
  for (int n = 0; n < 400; ++n) {
    std::string bad = good;
    const std::size_t at = n < 128 ? static_cast<std::size_t>(n) : random() % bad.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    const fs::path file = directory_ / "bad.topo";
    std::ofstream(file, std::ios::binary) << bad;
    EXPECT_NE(error_of(file).find("bad.topo"), std::string::npos) << "byte " << at;
  }
}

TEST(KeepRules, ParseAndPrint) {
  for (const char* text :
       {"main", "all", "detached", "largest:3", "volume:0.25", "touching:1,-2.5,0", "ids:0,4,7"})
    EXPECT_EQ(KeepRule::parse(text).to_string(), text);
  for (const char* text : {"", "biggest", "largest", "largest:x", "largest:-1", "main:1",
                           "touching:1,2", "volume:nan", "volume:-1", "ids:", "ids:1,,2"}) {
    try {
      KeepRule::parse(text);
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find("choices"), std::string::npos);
    }
  }
}

TEST_F(CacheFile, KeepRulesChooseComponents) {
  const Topology& t = cache_.topology;
  const auto kept = [&](const char* rule) {
    return kept_components(KeepRule::parse(rule), t.components, t.octree());
  };
  EXPECT_EQ(kept("main"), (std::vector<bool>{true, false}));
  EXPECT_EQ(kept("detached"), (std::vector<bool>{false, true}));
  EXPECT_EQ(kept("all"), (std::vector<bool>{true, true}));
  EXPECT_EQ(kept("largest:9"), (std::vector<bool>{true, true}));
  EXPECT_EQ(kept("largest:0"), (std::vector<bool>{false, false}));
  EXPECT_EQ(kept("volume:1000"), (std::vector<bool>{false, false}));
  EXPECT_EQ(kept("ids:1"), (std::vector<bool>{false, true}));
  const std::uint32_t at_three = t.nodes[t.octree().locate({3, 0, 0}).node].component;
  EXPECT_EQ(kept("touching:3,0,0")[at_three], true);
  // Outside the box there is no cell, though the nearest one may hold something.
  EXPECT_EQ(kept("touching:3,0,900"), (std::vector<bool>{false, false}));
  EXPECT_EQ(kept("touching:1.5,0,0"), (std::vector<bool>{false, false}));
  EXPECT_THROW(kept("ids:2"), std::invalid_argument);
}

}  // namespace
}  // namespace morsel::topology
