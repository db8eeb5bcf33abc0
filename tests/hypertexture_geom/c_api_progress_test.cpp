// SPDX-License-Identifier: Apache-2.0
// The C API: files, progress and cancellation.
#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/hypertexture_geom/c_api_fixture.h"
#include "tests/temporary_folder.h"

namespace morsel::test {
namespace {

TEST_F(CApi, FilesAndCancellation) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "three.topo").string();
  MorselTopology loaded = nullptr;
  EXPECT_EQ(morsel_load_topology(field, path.c_str(), &loaded), MORSEL_ERROR_FILE);
  ASSERT_EQ(morsel_save_topology(topology, path.c_str()), MORSEL_OK) << morsel_last_error_text();
  ASSERT_EQ(morsel_load_topology(field, path.c_str(), &loaded), MORSEL_OK);
  auto info = sized<MorselTopologyInfo>();
  ASSERT_EQ(morsel_topology_info(loaded, &info), MORSEL_OK);
  EXPECT_EQ(info.components, 3u);
  EXPECT_EQ(info.bytes, std::filesystem::file_size(path));
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);

  // Of another field: refused, and never replaced.
  MorselField ball = field_of(kBall);
  EXPECT_EQ(morsel_load_topology(ball, path.c_str(), &loaded), MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_open_topology(ball, path.c_str(), nullptr, &loaded), MORSEL_ERROR_FILE);
  MorselGeometry g = nullptr;
  EXPECT_EQ(morsel_create_geometry(ball, topology, nullptr, &g), MORSEL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(std::filesystem::file_size(path), info.bytes);

  auto options = sized<MorselBuildOptions>();
  struct Watch {
    std::atomic<int> progress{0}, asked{0};
    double last = -1;
    std::string phase;
    bool built = false;
    int stop_after = 1 << 30;
  } watch;
  options.user = &watch;
  options.progress = [](void* user, double fraction, const char* phase) {
    auto& w = *static_cast<Watch*>(user);
    EXPECT_GE(fraction, w.last);
    EXPECT_LE(fraction, 1.0 + 1e-12);
    EXPECT_NE(phase, nullptr);
    w.last = fraction;
    w.phase = phase;
    w.built = w.built || w.phase == "labelling";
    ++w.progress;
  };
  options.cancel = [](void* user) -> std::int32_t {
    auto& w = *static_cast<Watch*>(user);
    return ++w.asked > w.stop_after;
  };
  const std::string opened = (folder.path() / "ball.topo").string();
  watch.stop_after = 1;
  EXPECT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_ERROR_CANCELLED);
  EXPECT_FALSE(std::filesystem::exists(opened));
  EXPECT_TRUE(std::filesystem::is_regular_file(path));
  watch.stop_after = 1 << 30;
  watch.last = -1;
  watch.progress = 0;
  options.threads = 2;
  ASSERT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_OK)
      << morsel_last_error_text();
  EXPECT_GT(watch.progress, 0);
  EXPECT_TRUE(std::filesystem::exists(opened));
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);
  watch.progress = 0;
  watch.built = false;
  watch.last = -1;
  ASSERT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_OK);
  EXPECT_GT(watch.progress, 0);
  EXPECT_EQ(watch.phase, "done");
  EXPECT_FALSE(watch.built);  // read
  EXPECT_EQ(morsel_release_topology(loaded), MORSEL_OK);
  EXPECT_EQ(morsel_open_topology(ball, "/nowhere/at/all.topo", &options, &loaded),
            MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_save_topology(topology, folder.path().c_str()), MORSEL_ERROR_FILE);
  std::ofstream(opened) << "nonsense";
  EXPECT_EQ(morsel_open_topology(ball, opened.c_str(), &options, &loaded), MORSEL_ERROR_FILE);
  EXPECT_EQ(morsel_release_field(ball), MORSEL_OK);
}

// What a caller is told: fractions, and the first one of each phase.
struct Told {
  double last = 0.0;
  bool falls = false;
  std::vector<std::pair<std::string, double>> phases;
  int asked = 0, stop_after = 1 << 30;

  template <class Options>
  void watch(Options& options) {
    options.user = this;
    options.progress = [](void* user, double fraction, const char* phase) {
      auto& told = *static_cast<Told*>(user);
      told.falls = told.falls || !(fraction >= told.last && fraction <= 1.0);
      told.last = fraction;
      if (told.phases.empty() || told.phases.back().first != phase)
        told.phases.emplace_back(phase, fraction);
    };
    options.cancel = [](void* user) -> std::int32_t {
      auto& told = *static_cast<Told*>(user);
      return ++told.asked > told.stop_after;
    };
  }
  // The phases are these, each beginning further on than the one before it; what a phase says of
  // its own parts moves nothing.
  void expect_phases(const std::vector<std::string>& expected) const {
    EXPECT_FALSE(falls);
    EXPECT_EQ(last, 1.0);
    std::size_t next = 0;
    double before = -1.0;
    for (const auto& [name, fraction] : phases) {
      if (next < expected.size() && name == expected[next]) {
        EXPECT_GT(fraction, name == "done" ? before - 1e-9 : before) << name;
        before = fraction;
        ++next;
      } else {
        EXPECT_EQ(fraction, before) << name;
      }
    }
    EXPECT_EQ(next, expected.size());
    EXPECT_EQ(phases.back().first, "done");
  }
};

TEST_F(CApi, ProgressOfABuildNeverFalls) {
  const std::vector<std::string> expected[] = {
      {"labelling", "done"},
      {"labelling", "critical points", "separatrices", "ascents from cells", "done"},
      {"labelling", "critical points", "separatrices", "audit", "done"}};
  for (const std::uint32_t engine :
       {MORSEL_ENGINE_CERTIFIED, MORSEL_ENGINE_MORSE, MORSEL_ENGINE_BOTH}) {
    Told told;
    auto options = sized<MorselBuildOptions>();
    options.engine = engine;
    told.watch(options);
    MorselTopology t = nullptr;
    ASSERT_EQ(morsel_build_topology(field, &options, &t), MORSEL_OK) << morsel_last_error_text();
    told.expect_phases(expected[engine]);
    EXPECT_EQ(morsel_release_topology(t), MORSEL_OK);
  }
}

TEST(CApiProgress, GeometriesReportAndCanBeCancelled) {
  MorselField field = field_of(kBall);
  MorselTopology topology = topology_of(field);
  for (const std::uint32_t membership : {MORSEL_MEMBERSHIP_LABELS, MORSEL_MEMBERSHIP_STREAMLINE})
    for (const std::uint32_t solver : {MORSEL_SOLVER_MODEL, MORSEL_SOLVER_SPHERE}) {
      Told told;
      auto options = sized<MorselGeometryOptions>();
      options.solver = solver;
      options.membership = membership;
      told.watch(options);
      MorselGeometry g = nullptr;
      ASSERT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_OK)
          << morsel_last_error_text();
      const std::string surface = solver == MORSEL_SOLVER_SPHERE ? "slopes" : "bricks";
      if (membership == MORSEL_MEMBERSHIP_STREAMLINE)
        told.expect_phases({surface, "critical points", "separatrices", "done"});
      else
        told.expect_phases({surface, "done"});
      EXPECT_EQ(morsel_release_geometry(g), MORSEL_OK);
      for (const int stop_after : {0, 1}) {
        told = Told{};
        told.stop_after = stop_after;
        g = nullptr;
        EXPECT_EQ(morsel_create_geometry(field, topology, &options, &g), MORSEL_ERROR_CANCELLED)
            << solver << ' ' << membership << ' ' << stop_after;
        EXPECT_EQ(g, nullptr);
      }
    }
  EXPECT_EQ(morsel_release_topology(topology), MORSEL_OK);
  EXPECT_EQ(morsel_release_field(field), MORSEL_OK);
}

TEST_F(CApi, ReadingReportsAndCanBeCancelled) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "three.topo").string();
  ASSERT_EQ(morsel_save_topology(topology, path.c_str()), MORSEL_OK);
  Told told;
  auto options = sized<MorselBuildOptions>();
  told.watch(options);
  MorselTopology t = nullptr;
  ASSERT_EQ(morsel_load_topology_with(field, path.c_str(), &options, &t), MORSEL_OK)
      << morsel_last_error_text();
  told.expect_phases({"reading", "done"});
  EXPECT_EQ(morsel_release_topology(t), MORSEL_OK);
  ASSERT_EQ(morsel_load_topology_with(field, path.c_str(), nullptr, &t), MORSEL_OK);
  EXPECT_EQ(morsel_release_topology(t), MORSEL_OK);
  t = nullptr;
  for (const int stop_after : {0, 1, 5}) {
    told = Told{};
    told.stop_after = stop_after;
    EXPECT_EQ(morsel_load_topology_with(field, path.c_str(), &options, &t), MORSEL_ERROR_CANCELLED);
    EXPECT_EQ(t, nullptr);
  }
  // It reads and never builds.
  const std::string missing = (folder.path() / "none.topo").string();
  EXPECT_EQ(morsel_load_topology_with(field, missing.c_str(), nullptr, &t), MORSEL_ERROR_FILE);
}

}  // namespace
}  // namespace morsel::test
