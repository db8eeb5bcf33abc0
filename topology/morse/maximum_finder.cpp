// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/maximum_finder.h"

#include <algorithm>
#include <nanoflann.hpp>
#include <vector>

namespace morsel::topology {
namespace {

// What nanoflann asks of a set of points.
struct Points {
  std::vector<Imath::V3d> position;
  std::vector<double> basin;
  std::vector<std::uint32_t> index;

  std::size_t kdtree_get_point_count() const { return position.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return position[i][static_cast<int>(axis)];
  }
  template <class Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

using Index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3>;

// Collects the one point whose own radius reaches the query.
class BasinHit {
 public:
  using DistanceType = double;  // newer versions of nanoflann ask for it

  BasinHit(const Points& points, double largest_square) : points_(points), worst_(largest_square) {}

  // NOLINTBEGIN(readability-identifier-naming): nanoflann asks for these names.
  bool addPoint(double square, std::size_t i) {
    if (square <= points_.basin[i] * points_.basin[i]) hit_ = points_.index[i];
    return !hit_;
  }
  double worstDist() const { return worst_; }
  // NOLINTEND(readability-identifier-naming)
  std::size_t size() const { return hit_ ? 1 : 0; }
  bool full() const { return hit_.has_value(); }
  bool empty() const { return !hit_; }
  void sort() {}
  std::optional<std::uint32_t> hit() const { return hit_; }

 private:
  const Points& points_;
  double worst_;
  std::optional<std::uint32_t> hit_;
};

}  // namespace

struct MaximumFinder::Tree {
  Points points;
  double largest_square = 0.0;
  std::unique_ptr<Index> index;
};

MaximumFinder::MaximumFinder(std::span<const CriticalPoint> points)
    : tree_(std::make_unique<Tree>()) {
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (points[i].type != CriticalType::kMaximum) continue;
    tree_->points.position.push_back(points[i].position);
    tree_->points.basin.push_back(points[i].basin);
    tree_->points.index.push_back(i);
    tree_->largest_square =
        std::max(tree_->largest_square, points[i].basin * points[i].basin * (1.0 + 1e-12));
  }
  if (tree_->points.index.empty()) return;
  tree_->index = std::make_unique<Index>(3, tree_->points);
  tree_->index->buildIndex();
}

MaximumFinder::~MaximumFinder() = default;
MaximumFinder::MaximumFinder(MaximumFinder&&) noexcept = default;
MaximumFinder& MaximumFinder::operator=(MaximumFinder&&) noexcept = default;

std::optional<std::uint32_t> MaximumFinder::basin_of(const Imath::V3d& x) const {
  if (!tree_->index) return std::nullopt;
  BasinHit hit(tree_->points, tree_->largest_square);
  tree_->index->findNeighbors(hit, &x.x, {});
  return hit.hit();
}

std::optional<std::uint32_t> MaximumFinder::nearest(const Imath::V3d& x) const {
  if (!tree_->index) return std::nullopt;
  std::size_t found = 0;
  double square = 0.0;
  nanoflann::KNNResultSet<double> result(1);
  result.init(&found, &square);
  tree_->index->findNeighbors(result, &x.x, {});
  return tree_->points.index[found];
}

}  // namespace morsel::topology
