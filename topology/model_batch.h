// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "topology/box.h"
#include "topology/local_model.h"
#include "topology/octree.h"

namespace morsel::topology {

// The local models of the eight children of one box, side by side, so that vector instructions work
// on all at once; child i as in child_box. Each lane means what LocalModel means. Lanes nobody
// asked for hold no meaning.
struct alignas(64) ModelBatch {
  static constexpr int kSize = 8;
  double centre[3][kSize];
  double half[3][kSize];
  double c[monomial::kCount][kSize];
  double value_error[kSize];
  double gradient_error[3][kSize];
  double hessian_error[kSize];

  // Sets centres and half sizes to those of the children; the rest to zero.
  void start(const Box& parent);

  LocalModel operator[](int child) const;
  void set(int child, const LocalModel& model);

  // The sum of two fields' models of the same children, rounding included.
  void add(const ModelBatch& other);
};

// What the cascade (see cascade.h) says of the children and of their faces.
struct BatchContent {
  Content cell[ModelBatch::kSize];
  std::uint16_t faces[ModelBatch::kSize];  // as OctreeNode::faces
};

// Classifies the children whose bit is set in `wanted`: the same cascade as classify(), with the
// same guarantees; where both can say something, rounding may make one of them say less.
void classify_batch(const ModelBatch& models, unsigned wanted, BatchContent& out);

// Classifies the six faces of the children whose bit is set in `wanted`.
void classify_batch_faces(const ModelBatch& models, unsigned wanted, BatchContent& out);

}  // namespace morsel::topology
