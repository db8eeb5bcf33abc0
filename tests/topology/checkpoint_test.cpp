// SPDX-License-Identifier: Apache-2.0
// A build that is interrupted anywhere and goes on gives what one that is not gives; a checkpoint
// that is damaged, or of another build, is never believed. And builds that are given too little
// memory.
#include "topology/checkpoint.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tests/hypertexture_geom/test_fields.h"
#include "tests/temporary_folder.h"
#include "topology/certified.h"
#include "topology/section_file.h"

namespace morsel::topology {
namespace {

namespace fs = std::filesystem;

class Checkpoints : public ::testing::Test {
 protected:
  Checkpoints() {
    options_.box = Box(Imath::V3d(-3.0), Imath::V3d(3.0));
    expected_ = certify(*field_, options_);
  }
  Topology build(Execution execution = {}) {
    Checkpoint checkpoint(path_, "key");
    execution.checkpoint = &checkpoint;
    execution.checkpoint_after = 0.0;
    return certify(*field_, options_, execution);
  }
  static bool same(const Topology& a, const Topology& b) {
    return a.nodes.size() == b.nodes.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(OctreeNode)) == 0 &&
           a.components.size() == b.components.size() && a.certified == b.certified;
  }
  std::string bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(in)), {});
  }

  std::shared_ptr<const ScalarField> field_ =
      geom::testing::field_of(geom::testing::eq13_json(1, 3, 0.8, 2.0));
  CertifyOptions options_;
  Topology expected_;
  test::TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "a.topo.partial";
};

TEST_F(Checkpoints, AnInterruptedBuildGoesOn) {
  for (const double stop : {0.05, 0.4, 0.9}) {
    fs::remove(path_);
    std::atomic<bool> cancel{false};
    Execution execution;
    execution.cancel = &cancel;
    execution.progress = [&](double fraction, const char*) {
      if (fraction > stop) cancel = true;
    };
    EXPECT_THROW(build(execution), Cancelled);
    EXPECT_GT(Checkpoint(path_, "key").found(), 0u);
    const Topology again = build();
    EXPECT_TRUE(same(again, expected_));
    EXPECT_LT(again.models, expected_.models);
  }
}

TEST_F(Checkpoints, AFinishedCheckpointSavesTheLot) {
  build();
  const Topology again = build();
  EXPECT_TRUE(same(again, expected_));
  EXPECT_LT(again.models, expected_.models / 10);
}

TEST_F(Checkpoints, DamagedOnesAreCutOff) {
  build();
  const std::string good = bytes();
  const std::size_t found = Checkpoint(path_, "key").found();
  for (std::size_t at = 0; at < good.size(); at += good.size() / 7) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    std::ofstream(path_, std::ios::binary) << bad;
    EXPECT_LT(Checkpoint(path_, "key").found(), found) << at;
    std::ofstream(path_, std::ios::binary) << good.substr(0, at);
    EXPECT_LT(Checkpoint(path_, "key").found(), found) << at;
    EXPECT_TRUE(same(build(), expected_)) << at;
  }
}

TEST_F(Checkpoints, ThoseOfOtherBuildsAreNotUsed) {
  build();
  EXPECT_EQ(Checkpoint(path_, "another").found(), 0u);
  EXPECT_TRUE(Checkpoint(path_, "another").is_empty());
  EXPECT_THROW(Checkpoint(folder_.path() / "missing" / "x", "key"), CacheError);
}

// Builds at the same time: one keeps what it has done, the other leaves that alone.
TEST_F(Checkpoints, AnotherProcesssIsLeftAlone) {
  build();
  Checkpoint first(path_, "key");
  ASSERT_GT(first.found(), 0u);
  const std::string before = bytes();
  {
    Checkpoint same_field(path_, "key"), other_field(path_, "another");
    for (Checkpoint* second : {&same_field, &other_field}) {
      EXPECT_EQ(second->found(), 0u);
      EXPECT_TRUE(second->take(0).empty());
      second->save(0, expected_.nodes);
      EXPECT_TRUE(second->is_empty());
      second->remove();
    }
  }
  EXPECT_EQ(bytes(), before);
  first.remove();
  EXPECT_FALSE(fs::exists(path_));
}

// As on a disk that is full: nothing stays behind.
TEST_F(Checkpoints, OnesThatCannotBeBegunAreNotThere) {
  struct rlimit old = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  struct rlimit none = old;
  none.rlim_cur = 1;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  EXPECT_THROW(Checkpoint(path_, "key"), CacheError);
  std::signal(SIGXFSZ, handler);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(Checkpoints, TooLittleMemoryIsSaidAndWhatIsDoneIsKept) {
  Execution execution;
  execution.max_bytes = expected_.nodes.size() * sizeof(OctreeNode);  // half of what it needs
  EXPECT_THROW(build(execution), MemoryLimit);
  EXPECT_GT(Checkpoint(path_, "key").found(), 0u);
  execution.max_bytes *= 3;
  EXPECT_TRUE(same(build(execution), expected_));
}

}  // namespace
}  // namespace morsel::topology
