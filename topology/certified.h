// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "topology/box.h"
#include "topology/components.h"
#include "topology/octree.h"
#include "topology/scalar_field.h"

namespace morsel::topology {

// What to compute.
struct CertifyOptions {
  Box box;            // contains the surface, or cuts it (then `touches_box` says so)
  int min_depth = 3;  // cells that hold surface are subdivided at least this often
  int max_depth =
      24;  // cells at this depth are not subdivided; what is undecided there is reported
};

class Checkpoint;

// How: threads come from the caller's TBB arena.
struct Execution {
  const std::atomic<bool>* cancel = nullptr;  // set to stop; then Cancelled is thrown
  std::function<void(double fraction, const char* phase)>
      progress;  // called from any thread, not concurrently
  // Memory that the octree, or the mesh, may take while it is made; beyond, MemoryLimit is thrown.
  // 0: no limit.
  std::uint64_t max_bytes = 0;
  // Where finished trees are kept and taken from, or null. Trees are kept once the build has lasted
  // `checkpoint_after` seconds: what a short build loses is not worth the file.
  Checkpoint* checkpoint = nullptr;
  double checkpoint_after = 5.0;

  // Throws Cancelled if that was asked for.
  void check_cancel() const;
};

// Raised instead of taking more memory than the caller allowed.
struct MemoryLimit : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Raised where the field, or what its models say of it, is not finite: no subdivision would end.
struct NotFinite : std::runtime_error {
  NotFinite(const Imath::V3d& place, double value);  // value: F there
};

struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("cancelled") {}
};

inline void Execution::check_cancel() const {
  if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
}

// A cell or face that stayed undecided: at the depth limit, or where cells of no size would be
// decided since F is zero all along an edge of the octree.
struct Unresolved {
  Box box;           // no extent along one axis for a face
  double value = 0;  // F at its centre
};

inline constexpr std::size_t kListedUnresolved = 1000;

// The labelled octree and what follows from it.
struct Topology {
  Box box;
  std::vector<OctreeNode> nodes;
  std::vector<Component> components;
  bool certified = false;  // nothing is unresolved
  std::uint64_t components_lo = 0;
  std::optional<std::uint64_t>
      components_hi;  // empty: not bounded (an unresolved cell may hide any number)
  std::uint64_t unresolved_cells = 0;
  std::uint64_t unresolved_faces = 0;
  std::vector<Unresolved> unresolved;     // the first kListedUnresolved: cells, then faces
  std::optional<Imath::V3d> touches_box;  // a place where S may reach the box's boundary
  std::uint64_t leaves = 0;
  int depth = 0;             // of the deepest leaf
  std::uint64_t models = 0;  // local models evaluated
  std::string engine = "certified";

  OctreeView octree() const { return {box, nodes}; }
};

// Labels the components of {F >= 0} within the box by the monotone retraction cascade: see
// topology/README.md for the method and its proof. The result does not depend on the number of
// threads. Throws Cancelled, MemoryLimit and NotFinite.
Topology certify(const ScalarField& field, const CertifyOptions& options,
                 const Execution& execution = {});

// Deepest level that an octree may have: its planes are then exact in double (see dyadic_box).
inline constexpr int kMaxDepth = 26;

// The smallest box around `box` whose planes, and those of every octree cell in it down to
// kMaxDepth, are exact in double precision. Throws std::invalid_argument unless `box` is finite and
// has extent.
Box dyadic_box(const Box& box);

}  // namespace morsel::topology
