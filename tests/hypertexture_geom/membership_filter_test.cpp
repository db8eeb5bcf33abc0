// SPDX-License-Identifier: Apache-2.0
// The label filter where the octree was coarsened for rays (topology/coarsen.h).
#include "hypertexture_geom/embree/membership_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace morsel::geom {
namespace {

using topology::kNoComponent;

// A long piece of debris whose F rises slowly all along the x axis and falls off a short way before
// a large ball: who climbs along the piece in steps as wide as a leaf allows leaps over the gap.
class TaperBeforeBall final : public topology::ScalarField {
 public:
  static constexpr double kFrom = -0.95, kTo = -0.02, kAxis = -0.5;
  static double half_width(double x) { return 0.02 + 0.1 * (x - kFrom); }

  double value(const Imath::V3d& x) const override { return jet(x).value; }
  topology::Jet jet(const Imath::V3d& x) const override {
    topology::Jet j;
    const Imath::V3d from_axis(0.0, x.y - kAxis, x.z - kAxis);
    const Imath::V3d from_ball = x - Imath::V3d(0.42, kAxis, kAxis);
    const double r = from_axis.length(), d = from_ball.length();
    const double side = half_width(x.x) - r, tip = 20.0 * (kTo - x.x), ball = 4.0 * (0.41 - d);
    const double taper = std::min({side, tip, 20.0 * (x.x - kFrom)});
    j.value = std::max(taper, ball);
    if (ball >= taper)
      j.gradient = from_ball * (-4.0 / std::max(d, 1e-12));
    else if (taper == side)
      j.gradient = Imath::V3d(0.1, 0.0, 0.0) - from_axis / std::max(r, 1e-12);
    else
      j.gradient = {taper == tip ? -20.0 : 20.0, 0.0, 0.0};
    // On the axis only the rise along it is left.
    if (taper == side && ball < taper && r < 1e-3) j.gradient = {0.1, 0.0, 0.0};
    return j;
  }
  topology::LocalModel model(const topology::Box& box) const override {
    topology::LocalModel m;  // nothing is known
    m.centre = topology::centre(box);
    m.half = topology::half_size(box);
    m.value_error = m.hessian_error = std::numeric_limits<double>::infinity();
    m.gradient_error = Imath::V3d(m.value_error);
    return m;
  }
  std::unique_ptr<topology::ScalarField> restricted_to(const topology::Box&) const override {
    return std::make_unique<TaperBeforeBall>(*this);
  }
};

// Eight leaves: all of the debris in the first, where x < 0, the kept ball in the second.
std::vector<topology::OctreeNode> two_leaves() {
  std::vector<topology::OctreeNode> nodes(9);
  nodes[0].first_child = 1;
  for (int i : {1, 2}) nodes[i].content = static_cast<std::uint8_t>(topology::Content::kConnected);
  nodes[2].component = 0;
  return nodes;
}

TEST(LabelFilter, DoesNotClimbOutOfACoarsenedRemovedLeaf) {
  const TaperBeforeBall field;
  const std::vector<topology::OctreeNode> nodes = two_leaves();
  const topology::OctreeView octree{{Imath::V3d(-1.0), Imath::V3d(1.0)}, nodes};
  const auto filter = make_label_filter(field, octree, {true}, 1e-3);
  int tried = 0;
  for (int i = 1; i < 90; ++i)
    for (int k = 0; k < 8; ++k) {
      const double x = -0.94 + 0.01 * i, r = TaperBeforeBall::half_width(x), a = 0.7 * k;
      if (x > TaperBeforeBall::kTo - 0.01) continue;
      const Imath::V3d start(x, TaperBeforeBall::kAxis + r * std::cos(a),
                             TaperBeforeBall::kAxis + r * std::sin(a));
      EXPECT_EQ(filter->component_at(start), kNoComponent) << start;
      EXPECT_FALSE(filter->keeps(start)) << start;
      ++tried;
    }
  EXPECT_GT(tried, 500);
  // And the ball is found.
  EXPECT_EQ(filter->component_at({0.42 + 0.41, -0.5, -0.5}), 0u);
  EXPECT_TRUE(filter->keeps({0.42, -0.5 + 0.41, -0.5}));
}

}  // namespace
}  // namespace morsel::geom
