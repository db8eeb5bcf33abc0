// SPDX-License-Identifier: Apache-2.0
#include "topology/bound_solid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <vector>

namespace morsel::topology {
namespace {

constexpr int kBlock = 8;  // points along a side of a block, which shares one restricted field
constexpr int kFirstBlocks = 4;    // along a side of the first grid
constexpr int kFaceDepth = 12;     // cells of a face this small stay undecided
constexpr int kFaceTaskDepth = 3;  // pieces of a face above this depth are tasks of their own
constexpr double kMargin = 0.04;   // of the solid's size, on each side

Box intersection(Box a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    a.min[axis] = std::max(a.min[axis], b.min[axis]);
    a.max[axis] = std::min(a.max[axis], b.max[axis]);
  }
  return a;
}

// Calls visit(block, x, F(x)) for the points of a grid in `region` that are not in `known`, blocks
// * kBlock along each axis, those of a block one after another, blocks in parallel; there are
// blocks^3.
template <class Visit>
void sample(const ScalarField& field, const Box& region, const Box& known, int blocks,
            const Execution& execution, const Visit& visit) {
  const Imath::V3d step = (region.max - region.min) / (blocks * kBlock);
  tbb::parallel_for(0, blocks * blocks * blocks, [&](int b) {
    execution.check_cancel();
    const Imath::V3d corner =
        region.min +
        // NOLINTNEXTLINE(bugprone-integer-division): whole numbers are meant.
        step * Imath::V3d(b % blocks, b / blocks % blocks, b / (blocks * blocks)) * double{kBlock};
    const Box block(corner, corner + step * double{kBlock});
    if (known.intersects(block.min) && known.intersects(block.max)) return;
    const std::unique_ptr<ScalarField> local = field.restricted_to(block);
    for (int k = 0; k < kBlock; ++k)
      for (int j = 0; j < kBlock; ++j)
        for (int i = 0; i < kBlock; ++i) {
          const Imath::V3d x = corner + step * Imath::V3d(i + 0.5, j + 0.5, k + 0.5);
          if (!known.intersects(x)) visit(static_cast<std::size_t>(b), x, local->value(x));
        }
  });
}

std::size_t cube(int n) { return static_cast<std::size_t>(n) * n * n; }

// `known`, extended by the grid points of `region` where F >= 0: those within it need not be looked
// at.
Box sampled_solid(const ScalarField& field, const Box& region, const Box& known, int blocks,
                  const Execution& execution) {
  std::vector<Box> found(cube(blocks));
  sample(field, region, known, blocks, execution,
         [&](std::size_t block, const Imath::V3d& x, double value) {
           if (value >= 0.0) found[block].extendBy(x);
         });
  Box all = known;
  for (const Box& box : found) all.extendBy(box);
  return all;
}

// Looks for a place on a face, a box without extent along an axis, where F < 0 is not proved.
class FaceProof {
 public:
  FaceProof(int axis, const Execution& execution) : axis_(axis), execution_(execution) {}

  // Empty when F < 0 is proved on all of the face. Does not depend on the number of threads.
  std::optional<Imath::V3d> not_proved(const ScalarField& field, const Box& face, int depth) const {
    execution_.check_cancel();
    const Interval range = field.model(face).range();
    if (range.hi < 0.0) return std::nullopt;
    const Imath::V3d middle = centre(face);
    if (range.lo >= 0.0 || depth == kFaceDepth || field.value(middle) >= 0.0) return middle;
    const std::unique_ptr<ScalarField> local = field.restricted_to(face);
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    const auto visit = [&](int i) {
      Box quarter = face;
      ((i & 1) ? quarter.min : quarter.max)[u] = middle[u];
      ((i & 2) ? quarter.min : quarter.max)[v] = middle[v];
      return not_proved(*local, quarter, depth + 1);
    };
    if (depth >= kFaceTaskDepth) {
      for (int i = 0; i < 4; ++i)
        if (const auto place = visit(i)) return place;
      return std::nullopt;
    }
    // The first quarter that has one, as in a loop: later ones may be left out, not earlier ones.
    std::array<std::optional<Imath::V3d>, 4> places;
    std::atomic<int> first{4};
    tbb::parallel_for(0, 4, [&](int i) {
      if (first.load(std::memory_order_relaxed) < i) return;
      places[i] = visit(i);
      if (!places[i]) return;
      int old = first.load();
      while (i < old && !first.compare_exchange_weak(old, i)) {
      }
    });
    // In a loop within another that was cancelled, quarters may not have been visited.
    execution_.check_cancel();
    return first < 4 ? places[static_cast<std::size_t>(first.load())] : std::nullopt;
  }

 private:
  int axis_;
  const Execution& execution_;
};

// The face towards `axis`, upper or lower.
Box face_of(const Box& box, int axis, bool upper) {
  Box face = box;
  (upper ? face.min : face.max)[axis] = (upper ? box.max : box.min)[axis];
  return face;
}

std::optional<Imath::V3d> not_proved_empty(const ScalarField& field, const Box& box, int side,
                                           const Execution& execution) {
  const int axis = side / 2;
  return FaceProof(axis, execution).not_proved(field, face_of(box, axis, side % 2 == 1), 0);
}

}  // namespace

Box find_solid(const ScalarField& field, const Box& outer, const Execution& execution) {
  Box inside;
  Box region = outer;
  int blocks = kFirstBlocks;
  for (int pass = 0; pass < 4; ++pass) {
    const Imath::V3d step = (region.max - region.min) / (blocks * kBlock);
    inside = sampled_solid(field, region, inside, blocks, execution);
    if (inside.isEmpty()) return inside;
    region = intersection(Box(inside.min - step * 2.0, inside.max + step * 2.0), outer);
    blocks = 8;
  }
  const Imath::V3d extent = inside.max - inside.min;
  const Imath::V3d margin(kMargin * std::max({extent.x, extent.y, extent.z}));
  Box box = intersection(Box(inside.min - margin, inside.max + margin), outer);
  for (bool grown = true; grown;) {
    grown = false;
    for (int i = 0; i < 6; ++i) {
      const int axis = i / 2;
      const bool upper = i % 2 == 1;
      double& plane = upper ? box.max[axis] : box.min[axis];
      const double limit = upper ? outer.max[axis] : outer.min[axis];
      if (plane == limit) continue;
      if (!not_proved_empty(field, box, i, execution)) continue;
      plane = upper ? std::min(limit, plane + margin[axis]) : std::max(limit, plane - margin[axis]);
      grown = true;
    }
  }
  return box;
}

std::optional<Imath::V3d> place_where_cut(const ScalarField& field, const Box& box,
                                          const Execution& execution) {
  for (int i = 0; i < 6; ++i)
    if (const auto place = not_proved_empty(field, box, i, execution)) return place;
  return std::nullopt;
}

std::optional<Imath::V3d> place_beyond(const ScalarField& field, const Box& outer, const Box& box) {
  struct Best {
    double value = -1.0;
    Imath::V3d x{0.0};
  };
  if (outer.isEmpty()) return std::nullopt;
  std::vector<Best> found(cube(kFirstBlocks));
  sample(field, outer, box, kFirstBlocks, {},
         [&](std::size_t block, const Imath::V3d& x, double value) {
           if (value >= 0.0 && value > found[block].value) found[block] = {value, x};
         });
  Best best;
  for (const Best& b : found)
    if (b.value > best.value) best = b;
  if (best.value < 0.0) return std::nullopt;
  return best.x;
}

}  // namespace morsel::topology
