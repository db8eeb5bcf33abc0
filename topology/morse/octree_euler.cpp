// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/octree_euler.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <array>

#include "topology/morse/field_descent.h"

namespace morsel::topology {
namespace {

constexpr int kEdgeDepth = 30;  // halvings of an edge before it is given up
constexpr std::size_t kGrain = 512;

// A leaf at, or holding, the place where a cell of the same size would be.
struct Neighbour {
  bool outside = false;
  bool empty = false, full = false;
  int depth = 0;
  const OctreeNode* node = nullptr;
};

// Neighbours by offset (dx, dy, dz) in -1 ... 1; the cell itself in the middle.
class Neighbourhood {
 public:
  Neighbourhood(const OctreeView& octree, const OctreeView::Leaf& leaf) {
    const Imath::V3d c = centre(leaf.box), size = leaf.box.max - leaf.box.min;
    for (int n = 0; n < 27; ++n) {
      // NOLINTNEXTLINE(bugprone-integer-division): whole numbers are meant.
      const Imath::V3d x = c + size * Imath::V3d(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      Neighbour& neighbour = all_[static_cast<std::size_t>(n)];
      neighbour.outside = !octree.box.intersects(x);
      if (neighbour.outside) continue;
      const OctreeView::Leaf found = n == 13 ? leaf : octree.locate(x);
      neighbour.depth = found.depth;
      neighbour.node = &octree.nodes[found.node];
      neighbour.empty = neighbour.node->cell_content() == Content::kEmpty;
      neighbour.full = neighbour.node->cell_content() == Content::kFull;
    }
  }
  const Neighbour& at(const std::array<int, 3>& offset) const {
    const int n = offset[0] + 1 + 3 * (offset[1] + 1) + 9 * (offset[2] + 1);
    return all_[static_cast<std::size_t>(n)];
  }

 private:
  std::array<Neighbour, 27> all_;
};

// What is known of the piece where the cell meets its neighbours towards `offset`.
enum class Piece { kNotOurs, kEmpty, kFull, kOpen };

// The cell counts the piece if it is among the smallest cells there, and the first of equal ones.
Piece piece_of(const Neighbourhood& around, int depth, const std::array<int, 3>& offset) {
  bool empty = false, full = false;
  for (int mask = 0; mask < 8; ++mask) {
    std::array<int, 3> o{};
    bool repeated = false;
    for (int i = 0; i < 3; ++i) {
      if (((mask >> i) & 1) == 0) continue;
      repeated = repeated || offset[i] == 0;
      o[i] = offset[i];
    }
    if (repeated) continue;
    const Neighbour& n = around.at(o);
    if (n.outside || n.depth > depth) return Piece::kNotOurs;
    const bool before = o[2] < 0 || (o[2] == 0 && (o[1] < 0 || (o[1] == 0 && o[0] < 0)));
    if (n.depth == depth && before) return Piece::kNotOurs;
    empty = empty || n.empty;
    full = full || n.full;
  }
  if (empty) return Piece::kEmpty;
  return full ? Piece::kFull : Piece::kOpen;
}

class Counter {
 public:
  Counter(const ScalarField& field, const Topology& topology)
      : fields_(field, topology.box), sums_(topology.components.size(), 0) {}

  void count(const OctreeView& octree, const OctreeView::Leaf& leaf) {
    const OctreeNode& node = octree.nodes[leaf.node];
    const Neighbourhood around(octree, leaf);
    std::int64_t sum = 1;  // the cell itself
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) sum -= face(around, leaf, node, axis, side);
    for (int axis = 0; axis < 3; ++axis)
      for (const int u : {-1, 1})
        for (const int v : {-1, 1}) sum += edge(around, leaf, node, axis, u, v);
    for (int corner = 0; corner < 8; ++corner) sum -= vertex(around, leaf, node, corner);
    sums_[node.component] += sum;
  }

  const std::vector<std::int64_t>& sums() const { return sums_; }
  const std::vector<Unresolved>& undecided() const { return undecided_; }

 private:
  // A face of the cell towards the offset that is proved empty or full decides its edges as well.
  static Piece by_faces(const OctreeNode& node, const std::array<int, 3>& offset) {
    for (int axis = 0; axis < 3; ++axis) {
      if (offset[axis] == 0) continue;
      const Content content = node.face_content(axis, offset[axis] > 0 ? 1 : 0);
      if (content == Content::kEmpty) return Piece::kEmpty;
      if (content == Content::kFull) return Piece::kFull;
    }
    return Piece::kOpen;
  }

  int face(const Neighbourhood& around, const OctreeView::Leaf& leaf, const OctreeNode& node,
           int axis, int side) {
    std::array<int, 3> offset{};
    offset[axis] = side;
    const Piece piece = piece_of(around, leaf.depth, offset);
    if (piece == Piece::kNotOurs || piece == Piece::kEmpty) return 0;
    if (piece == Piece::kFull) return 1;
    Content content = node.face_content(axis, side > 0 ? 1 : 0);
    const Neighbour& other = around.at(offset);
    if (content == Content::kUndecided && other.depth == leaf.depth)
      content = other.node->face_content(axis, side > 0 ? 0 : 1);
    return content == Content::kEmpty ? 0 : 1;
  }

  int edge(const Neighbourhood& around, const OctreeView::Leaf& leaf, const OctreeNode& node,
           int axis, int u, int v) {
    std::array<int, 3> offset{};
    offset[(axis + 1) % 3] = u;
    offset[(axis + 2) % 3] = v;
    Piece piece = piece_of(around, leaf.depth, offset);
    if (piece == Piece::kOpen) piece = by_faces(node, offset);
    if (piece == Piece::kNotOurs || piece == Piece::kEmpty) return 0;
    if (piece == Piece::kFull) return 1;
    Box box = leaf.box;
    for (int i = 0; i < 3; ++i) {
      if (offset[i] < 0) box.max[i] = box.min[i];
      if (offset[i] > 0) box.min[i] = box.max[i];
    }
    return pieces_on(fields_.at(leaf.box), box, axis, 0);
  }

  int vertex(const Neighbourhood& around, const OctreeView::Leaf& leaf, const OctreeNode& node,
             int corner) {
    std::array<int, 3> offset{};
    Imath::V3d x;
    for (int i = 0; i < 3; ++i) {
      const bool upper = ((corner >> i) & 1) != 0;
      offset[i] = upper ? 1 : -1;
      x[i] = upper ? leaf.box.max[i] : leaf.box.min[i];
    }
    Piece piece = piece_of(around, leaf.depth, offset);
    if (piece == Piece::kOpen) piece = by_faces(node, offset);
    if (piece == Piece::kNotOurs || piece == Piece::kEmpty) return 0;
    if (piece == Piece::kFull) return 1;
    return inside(fields_.at(leaf.box), x);
  }

  int inside(const ScalarField& field, const Imath::V3d& x) {
    const Interval range = field.model(Box(x, x)).range();
    if (range.lo < 0.0 && range.hi >= 0.0) undecided_.push_back({Box(x, x), field.value(x)});
    return range.lo >= 0.0 ? 1 : 0;
  }

  // The number of intervals that S cuts out of an edge: its Euler characteristic.
  int pieces_on(const ScalarField& field, const Box& edge, int axis, int depth) {
    const LocalModel model = field.model(edge);
    const Interval range = model.range();
    if (range.hi < 0.0) return 0;
    if (range.lo >= 0.0) return 1;
    const Interval slope = model.gradient_range(axis);
    if (slope.lo >= 0.0) return inside(field, edge.max);
    if (slope.hi <= 0.0) return inside(field, edge.min);
    if (depth == kEdgeDepth) {
      undecided_.push_back({edge, field.value(centre(edge))});
      return 0;
    }
    Box lower = edge, upper = edge;
    lower.max[axis] = upper.min[axis] = centre(edge)[axis];
    return pieces_on(field, lower, axis, depth + 1) + pieces_on(field, upper, axis, depth + 1) -
           inside(field, lower.max);
  }

  FieldDescent fields_;
  std::vector<std::int64_t> sums_;
  std::vector<Unresolved> undecided_;
};

}  // namespace

OctreeEuler octree_euler(const ScalarField& field, const Topology& topology,
                         const Execution& execution) {
  const OctreeView octree = topology.octree();
  std::vector<OctreeView::Leaf> leaves;
  octree.for_each_leaf([&](const OctreeView::Leaf& leaf) {
    const Content content = octree.nodes[leaf.node].cell_content();
    if (content == Content::kConnected || content == Content::kFull) leaves.push_back(leaf);
  });
  tbb::enumerable_thread_specific<Counter> counters([&] { return Counter(field, topology); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      execution.check_cancel();
                      Counter& counter = counters.local();
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        counter.count(octree, leaves[i]);
                    });
  OctreeEuler result;
  result.of_component.assign(topology.components.size(), 0);
  for (const Counter& counter : counters) {
    for (std::size_t i = 0; i < result.of_component.size(); ++i)
      result.of_component[i] += counter.sums()[i];
    result.undecided.insert(result.undecided.end(), counter.undecided().begin(),
                            counter.undecided().end());
  }
  return result;
}

}  // namespace morsel::topology
