// SPDX-License-Identifier: Apache-2.0
#include "topology/verify.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <random>

#include "topology/bound_solid.h"
#include "topology/cascade.h"
#include "topology/component_bounds.h"
#include "topology/morse/engine.h"
#include "topology/tree_labels.h"

namespace morsel::topology {
namespace {

constexpr std::size_t kListed = 100;
// Levels below a cell that a proof of emptiness may go down: eight empty cells became one.
constexpr int kBelow = 12;
// Leaves below one cell of this depth are proved by one task, with the field restricted on the way.
constexpr int kTaskDepth = 4;

const char* name_of(Content content) {
  constexpr const char* kNames[] = {"empty", "connected", "full", "undecided"};
  return kNames[static_cast<int>(content)];
}

std::string text_of(const Box& b) {
  return fmt::format("[{}, {}] x [{}, {}] x [{}, {}]", b.min.x, b.max.x, b.min.y, b.max.y, b.min.z,
                     b.max.z);
}

class Verifier {
 public:
  Verifier(const ScalarField& field, const Topology& topology, const VerifyOptions& options,
           const Execution& execution)
      : field_(field), topology_(topology), options_(options), execution_(execution) {}

  VerifyReport run() {
    for (const Component& c : topology_.components) all_cells_ += static_cast<double>(c.cells);
    check_labels();
    draw();
    prove_all();
    return std::move(report_);
  }

 private:
  void fail(std::string what) {
    const std::lock_guard lock(mutex_);
    ++report_.failure_count;
    if (report_.failures.size() < kListed) report_.failures.push_back(std::move(what));
  }

  // Joins the leaves anew and compares with what is written.
  void check_labels() {
    execution_.check_cancel();
    Tree tree;
    tree.box = topology_.box;
    tree.nodes = topology_.nodes;
    const TreeLabels labels = label_tree(tree, topology_.box);
    report_.leaves = labels.leaves;
    report_.joins_checked = labels.joins;
    if (labels.leaves != topology_.leaves || labels.depth != topology_.depth)
      fail(fmt::format("{} leaves and depth {} instead of {} and {}", labels.leaves, labels.depth,
                       topology_.leaves, topology_.depth));
    // The Morse engine certifies no labels, however well its cells are decided; faces are nothing
    // to it, and what it left undecided may part a component's cells.
    const bool by_morse = topology_.engine == to_string(Engine::kMorse);
    const std::uint64_t cells = labels.unresolved_cells.size();
    const bool may_be_parted = by_morse && cells + labels.undecided_faces.size() > 0;
    // Those between cells of one piece change nothing.
    const auto faces = static_cast<std::uint64_t>(std::count_if(
        labels.undecided_faces.begin(), labels.undecided_faces.end(), [&](const auto& face) {
          return tree.nodes[face[0]].component != tree.nodes[face[1]].component;
        }));
    const std::vector<std::uint32_t> component = compare_pieces(tree, labels, may_be_parted);
    if (cells != topology_.unresolved_cells || (by_morse ? 0 : faces) != topology_.unresolved_faces)
      fail(fmt::format("{} cells and {} faces are undecided, not {} and {}", cells, faces,
                       topology_.unresolved_cells, topology_.unresolved_faces));
    if (topology_.certified != (!by_morse && cells + faces == 0))
      fail(fmt::format("says certified: {}", topology_.certified));
    // Where a leaf's own face does not show it, smaller pieces of the boundary may.
    const bool touches = labels.touches && place_where_cut(field_, topology_.box, execution_);
    if (topology_.touches_box.has_value() != touches)
      fail("whether the solid may reach the box's boundary is said wrongly");
    if (report_.failure_count > 0) return;  // what follows would be of another labelling
    if (by_morse)
      check_sums(labels, component);
    else
      check_bounds(labels, component, touches);
  }

  // A piece is a component, and the other way about. Gives the component of every piece.
  std::vector<std::uint32_t> compare_pieces(const Tree& tree, const TreeLabels& labels,
                                            bool may_be_parted) {
    std::vector<std::uint32_t> component(labels.pieces.size(), kNoComponent);
    std::vector<std::uint32_t> piece(topology_.components.size(), kNoComponent);
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
      const OctreeNode& written = topology_.nodes[n];
      if (!written.is_leaf()) continue;
      const std::uint32_t p = tree.nodes[n].component, c = written.component;
      if (p == kNoComponent || labels.unresolved[p]) {
        if (p == kNoComponent && c != kNoComponent)
          fail(fmt::format("node {}: empty, yet of component {}", n, c));
        continue;
      }
      if (c >= piece.size()) {
        fail(fmt::format("node {}: of no component", n));
        continue;
      }
      if (piece[c] == kNoComponent) piece[c] = p;
      if (component[p] == kNoComponent) component[p] = c;
      if (piece[c] != p && !may_be_parted)
        fail(fmt::format("node {}: component {} is in two pieces", n, c));
      if (component[p] != c)
        fail(fmt::format("node {}: components {} and {} are one", n, component[p], c));
    }
    if (!may_be_parted)
      for (std::size_t c = 0; c < piece.size(); ++c)
        if (piece[c] == kNoComponent) fail(fmt::format("component {} has no leaf", c));
    return component;
  }

  static std::vector<Component> sums(const TreeLabels& labels,
                                     const std::vector<std::uint32_t>& component,
                                     std::size_t count) {
    std::vector<Component> rows(count);
    for (std::size_t p = 0; p < labels.pieces.size(); ++p)
      if (component[p] != kNoComponent) merge(rows[component[p]], labels.pieces[p]);
    return rows;
  }

  // The Morse engine's table: plain sums; a component of it may have no cell.
  void check_sums(const TreeLabels& labels, const std::vector<std::uint32_t>& component) {
    const std::vector<Component> rows = sums(labels, component, topology_.components.size());
    for (std::size_t c = 0; c < rows.size(); ++c)
      if (rows[c].cells > 0) check_row(c, rows[c]);
    const std::uint64_t count = topology_.components.size();
    if (topology_.components_lo > count ||
        (topology_.components_hi && *topology_.components_hi < count))
      fail("the bounds of the number of components do not hold the number");
  }

  // What the certified engine says of the count and of the components.
  void check_bounds(const TreeLabels& labels, const std::vector<std::uint32_t>& component,
                    bool touches) {
    std::vector<Component> rows = sums(labels, component, topology_.components.size());
    const Undecided undecided{labels.unresolved, labels.unresolved_cells, labels.possible};
    const CountBounds bounds = bound_components(field_, undecided, UnionFind(labels.pieces.size()),
                                                component, touches, rows);
    for (std::size_t c = 0; c < rows.size(); ++c) check_row(c, rows[c]);
    const auto text = [](std::uint64_t lo, const std::optional<std::uint64_t>& hi) {
      return fmt::format("[{}, {}]", lo, hi ? fmt::to_string(*hi) : "null");
    };
    if (bounds.lo != topology_.components_lo || bounds.hi != topology_.components_hi)
      fail(fmt::format("the number of components has the bounds {}, not {}",
                       text(bounds.lo, bounds.hi),
                       text(topology_.components_lo, topology_.components_hi)));
    const std::uint64_t all = topology_.unresolved_cells + topology_.unresolved_faces;
    bool listed = topology_.unresolved.size() == std::min<std::uint64_t>(all, kListedUnresolved);
    for (std::size_t i = 0; listed && i < undecided.cells.size() && i < kListedUnresolved; ++i) {
      const Box &box = topology_.unresolved[i].box, &cell = undecided.cells[i].second;
      listed = box.min == cell.min && box.max == cell.max;
    }
    if (!listed) fail("the list of undecided places is not that of the octree");
  }

  void check_row(std::size_t c, const Component& leaves) {
    const Component& row = topology_.components[c];
    // Sums of so many volumes, each rounded outward.
    const double unit = 4.0 * std::numeric_limits<double>::epsilon() *
                        (4.0 + all_cells_ + static_cast<double>(topology_.unresolved_cells));
    const auto near = [&](double a, double b) { return std::abs(a - b) <= unit * std::abs(b); };
    if (row.cells != leaves.cells || row.bounds.min != leaves.bounds.min ||
        row.bounds.max != leaves.bounds.max || !near(row.volume_lo, leaves.volume_lo) ||
        !near(row.volume_hi, leaves.volume_hi))
      fail(fmt::format("component {}: the table has other cells, bounds or volumes than its leaves",
                       c));
  }

  void draw() {
    drawn_.assign(topology_.nodes.size(), options_.full);
    if (options_.full) return;
    std::vector<std::uint32_t> leaves;
    for (std::size_t n = 0; n < topology_.nodes.size(); ++n)
      if (topology_.nodes[n].is_leaf()) leaves.push_back(static_cast<std::uint32_t>(n));
    std::mt19937_64 random(options_.seed);
    std::vector<std::uint32_t> sample;
    std::sample(leaves.begin(), leaves.end(), std::back_inserter(sample), options_.samples, random);
    for (const std::uint32_t n : sample) drawn_[n] = true;
  }

  struct Task {
    std::uint32_t node;
    int depth;
    Box box;
  };

  void prove_all() {
    std::vector<Task> tasks;
    const auto collect = [&](auto&& self, const Task& t) -> void {
      const OctreeNode& node = topology_.nodes[t.node];
      if (node.is_leaf() || t.depth == kTaskDepth) {
        tasks.push_back(t);
        return;
      }
      for (std::uint32_t i = 0; i < 8; ++i)
        self(self, {node.first_child + i, t.depth + 1, child_box(t.box, static_cast<int>(i))});
    };
    collect(collect, {0, 0, topology_.box});
    std::vector<bool> wanted = drawn_;
    const auto spread = [&](auto&& self, std::uint32_t n) -> bool {
      const OctreeNode& node = topology_.nodes[n];
      if (node.is_leaf()) return wanted[n];
      bool any = false;
      for (std::uint32_t i = 0; i < 8; ++i)
        if (self(self, node.first_child + i)) any = true;
      wanted[n] = any;
      return any;
    };
    spread(spread, 0);
    double done = 0.0;
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
      execution_.check_cancel();
      Count count;
      descend(field_, tasks[i], wanted, count);
      const std::lock_guard lock(mutex_);
      report_.cells_proved += count.cells;
      report_.faces_proved += count.faces;
      report_.undecided += count.undecided;
      done += std::ldexp(1.0, -3 * tasks[i].depth);
      if (execution_.progress) execution_.progress(done, "verifying");
    });
  }

  struct Count {
    std::uint64_t cells = 0, faces = 0, undecided = 0;
  };

  void descend(const ScalarField& field, const Task& t, const std::vector<bool>& wanted,
               Count& count) {
    if (!wanted[t.node]) return;
    const std::unique_ptr<ScalarField> local = field.restricted_to(t.box);
    const OctreeNode& node = topology_.nodes[t.node];
    if (node.is_leaf()) {
      prove_leaf(*local, t, count);
      return;
    }
    for (std::uint32_t i = 0; i < 8; ++i)
      descend(*local, {node.first_child + i, t.depth + 1, child_box(t.box, static_cast<int>(i))},
              wanted, count);
  }

  // Does a proof of `found` prove what is claimed?
  static bool proves(Content found, Content claim) {
    return found == claim || (claim == Content::kConnected && found == Content::kFull);
  }

  void prove_leaf(const ScalarField& field, const Task& t, Count& count) {
    const OctreeNode& node = topology_.nodes[t.node];
    const Content claim = node.cell_content();
    const LocalModel model = field.model(t.box);
    if (claim == Content::kEmpty || claim == Content::kFull) {
      // Nothing else can be true of the faces.
      if (classify(model) != claim && !prove_parts(field, t.box, claim, kBelow))
        fail(fmt::format("node {}: {}: \"{}\" is not proved", t.node, text_of(t.box),
                         name_of(claim)));
      else
        ++count.cells;
      return;
    }
    // By eight at a time the cascade takes other roundings and another order of questions: what it
    // proved and the scalar one does not quite is asked of it again.
    Content content = classify(model);
    OctreeNode faces;
    classify_faces(model, faces);
    if (!agree(content, faces, node)) again(field, t, content, faces, node);
    if (claim == Content::kUndecided)
      ++count.undecided;
    else if (proves(content, claim))
      ++count.cells;
    else
      fail(fmt::format("node {}: {}: \"{}\" is not proved, but \"{}\"", t.node, text_of(t.box),
                       name_of(claim), name_of(content)));
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const Content said = node.face_content(axis, side), found = faces.face_content(axis, side);
        if (said == Content::kUndecided)
          ++count.undecided;
        else if (proves(found, said))
          ++count.faces;
        else
          fail(fmt::format("node {}: {}: face {}{}: \"{}\" is not proved, but \"{}\"", t.node,
                           text_of(t.box), side == 0 ? '-' : '+', "xyz"[axis], name_of(said),
                           name_of(found)));
      }
    }
  }

  static bool agree(Content content, const OctreeNode& faces, const OctreeNode& node) {
    if (node.cell_content() != Content::kUndecided && !proves(content, node.cell_content()))
      return false;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        if (node.face_content(axis, side) != Content::kUndecided &&
            !proves(faces.face_content(axis, side), node.face_content(axis, side)))
          return false;
    return true;
  }

  // The same cell as the first of eight; keeps what was proved before.
  static void again(const ScalarField& field, const Task& t, Content& content, OctreeNode& faces,
                    const OctreeNode& node) {
    const Box twice(t.box.min, t.box.max + (t.box.max - t.box.min));
    const Box first = child_box(twice, 0);
    if (first.min != t.box.min || first.max != t.box.max) return;
    ModelBatch batch;
    BatchContent found;
    field.child_models(twice, 1u, batch);
    classify_batch(batch, 1u, found);
    classify_batch_faces(batch, 1u, found);
    if (!proves(content, node.cell_content())) content = found.cell[0];
    OctreeNode other;
    other.faces = found.faces[0];
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        if (!proves(faces.face_content(axis, side), node.face_content(axis, side)))
          faces.set_face_content(axis, side, other.face_content(axis, side));
  }

  bool prove_parts(const ScalarField& field, const Box& box, Content claim, int levels) const {
    if (levels == 0) return false;
    execution_.check_cancel();
    for (int i = 0; i < 8; ++i) {
      const Box part = child_box(box, i);
      const std::unique_ptr<ScalarField> local = field.restricted_to(part);
      const Content says = classify(local->model(part));
      if (says == claim) continue;
      if (says == Content::kEmpty || !prove_parts(*local, part, claim, levels - 1)) return false;
    }
    return true;
  }

  const ScalarField& field_;
  const Topology& topology_;
  const VerifyOptions& options_;
  const Execution& execution_;
  std::mutex mutex_;
  VerifyReport report_;
  std::vector<bool> drawn_;
  double all_cells_ = 0.0;  // decided ones that hold solid
};

}  // namespace

VerifyReport verify(const ScalarField& field, const Topology& topology,
                    const VerifyOptions& options, const Execution& execution) {
  return Verifier(field, topology, options, execution).run();
}

}  // namespace morsel::topology
