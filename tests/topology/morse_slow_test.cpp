// SPDX-License-Identifier: Apache-2.0
// The paper's engine and the certified one on random fields: densities x noises x seeds.
#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/hypertexture_geom/random_density.h"
#include "tests/hypertexture_geom/test_fields.h"
#include "topology/bound_solid.h"
#include "topology/morse/audit.h"

namespace morsel::topology {
namespace {

TEST(AuditSlow, RandomFieldsAgree) {
  const std::vector<std::string> densities{"sphere", "ellipsoid", "rounded_box",
                                           "torus",  "capsule",   "union"};
  int compared = 0, by_mesh = 0;
  std::size_t pieces = 0, maxima = 0;
  for (int seed = 1; seed <= 60 && compared < 48; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto between = [&](double lo, double hi) {
      return std::uniform_real_distribution<double>(lo, hi)(random);
    };
    const int layers = seed / 12 % 2 == 0 ? 1 : 2;
    const nlohmann::json json{
        {"density", geom::testing::random_density(densities[seed % densities.size()], random, 1)},
        {"modulations",
         {{{"type", "fbm"},
           {"noise", seed / 6 % 2 == 0 ? "sparse_convolution" : "perlin"},
           {"amplitude", between(0.4, 0.8)},
           {"frequency", between(1.2, 2.2)},
           {"layers", layers},
           {"seed", seed}}}}};
    const auto field = geom::testing::field_of(json);
    const auto bounds = field->solid_bounds();
    if (!bounds) continue;
    CertifyOptions options;
    options.box = find_solid(*field, *bounds);
    if (options.box.isEmpty()) continue;
    const Topology t = certify(*field, options);
    MorseOptions morse;
    morse.box = t.box;
    const MorseComplex c = morse_complex(*field, morse);
    const Audit a = audit(*field, t, c);
    std::string reasons;
    for (const std::string& r : a.reasons) reasons += r + "; ";
    std::cout << "seed " << seed << ": " << densities[seed % densities.size()] << ", "
              << (seed / 6 % 2 == 0 ? "sparse convolution" : "perlin") << ", " << layers
              << " layers: " << t.components.size() << " components, "
              << c.count(CriticalType::kMaximum) << " maxima " << reasons << "\n";
    for (const Audit::Disagreement& d : a.disagreements)
      ADD_FAILURE() << json << ": at " << d.place << ": " << d.what;
    if (!a.conclusive) continue;
    EXPECT_EQ(c.sets.size(), t.components.size()) << json;
    ++compared;
    by_mesh += a.euler_by_mesh;
    pieces += t.components.size();
    maxima += c.count(CriticalType::kMaximum);
  }
  EXPECT_GE(compared, 40);
  EXPECT_GE(by_mesh, compared * 3 / 4);  // the rest by the octree alone
  std::cout << compared << " fields compared, " << by_mesh
            << " of them with the mesh as well: " << pieces << " components, " << maxima
            << " maxima\n";
}

}  // namespace
}  // namespace morsel::topology
