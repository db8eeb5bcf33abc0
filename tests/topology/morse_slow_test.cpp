// SPDX-License-Identifier: Apache-2.0
// The paper's engine and the certified one on random fields: densities x noises x layers x seeds.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/test_fields.h"
#include "topology/bound_solid.h"
#include "topology/morse/audit.h"

namespace morsel::topology {
namespace {

constexpr int kSeeds = 2;   // of each kind of field
constexpr int kSpare = 12;  // more, in place of fields that cannot be compared

class AuditSlow : public ::testing::TestWithParam<const char*> {
 protected:
  // Empty solids and those that their box cuts are no fields to compare; says whether it was one.
  bool compare(const std::string& noise, int layers, int seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto between = [&](double lo, double hi) {
      return std::uniform_real_distribution<double>(lo, hi)(random);
    };
    const nlohmann::json json{{"density", geom::testing::random_density(GetParam(), random, 1)},
                              {"modulations",
                               {{{"type", "fbm"},
                                 {"noise", noise},
                                 {"amplitude", between(0.4, 0.8)},
                                 {"frequency", between(1.2, 2.2)},
                                 {"layers", layers},
                                 {"seed", seed}}}}};
    const auto field = geom::testing::field_of(json);
    const auto bounds = field->solid_bounds();
    if (!bounds) return false;
    CertifyOptions options;
    options.box = find_solid(*field, *bounds);
    if (options.box.isEmpty()) return false;
    const Topology t = certify(*field, options);
    MorseOptions morse;
    morse.box = t.box;
    const MorseComplex c = morse_complex(*field, morse);
    const Audit a = audit(*field, t, c);
    std::cout << GetParam() << ", " << noise << ", " << layers << " layers, seed " << seed << ": "
              << t.components.size() << " components, " << c.count(CriticalType::kMaximum)
              << " maxima; " << a.verdict() << (a.euler_by_mesh ? ", with the mesh" : "");
    for (const std::string& reason : a.reasons) std::cout << "; " << reason;
    std::cout << "\n";
    for (const Audit::Disagreement& d : a.disagreements)
      ADD_FAILURE() << json << ": at " << d.place << ": " << d.what;
    if (!a.conclusive) return false;
    EXPECT_EQ(c.sets.size(), t.components.size()) << json;
    ++compared_;
    by_mesh_ += a.euler_by_mesh;
    components_ += t.components.size();
    maxima_ += c.count(CriticalType::kMaximum);
    return true;
  }

  int compared_ = 0, by_mesh_ = 0;
  std::size_t components_ = 0, maxima_ = 0;
};

// 6 densities x 2 noises x 2 numbers of layers x 2 seeds: 48 fields.
TEST_P(AuditSlow, RandomFieldsAgree) {
  int seed = 0;
  for (const char* noise : {"sparse_convolution", "perlin"})
    for (const int layers : {1, 2})
      for (int done = 0, tried = 0; done < kSeeds && tried < kSeeds + kSpare; ++tried)
        done += compare(noise, layers, ++seed);
  std::cout << GetParam() << ": " << compared_ << " fields compared, " << by_mesh_
            << " of them with the mesh as well: " << components_ << " components, " << maxima_
            << " maxima\n";
  EXPECT_EQ(compared_, 4 * kSeeds);
  EXPECT_GE(by_mesh_, 3 * kSeeds);  // the others by the octree alone
}

INSTANTIATE_TEST_SUITE_P(Densities, AuditSlow,
                         ::testing::Values("sphere", "ellipsoid", "rounded_box", "torus", "capsule",
                                           "union"),
                         [](const auto& density) { return std::string(density.param); });

}  // namespace
}  // namespace morsel::topology
