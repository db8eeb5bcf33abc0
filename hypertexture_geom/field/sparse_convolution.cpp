// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/sparse_convolution.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/impulse_model.h"
#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/radial_batch.h"
#include "hypertexture_geom/field/radial_model.h"
#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// Of octaves of frequency f, with u = 2^-53: an impulse of cell i lies at p with f p in [i, i + 1]
// up to a factor (1 + u)^2, since the sum and the quotient that make p are rounded, and it is 0
// from f |x - p| = 1 + u on, since f^2 is rounded. Where it is not 0, therefore, i <= f x + 1 and
// i + 1 >= f x - 1 but for 3 u (1 + |f x|). Rounding f x and two sums here adds 3 u more: 6 u in
// all, and this is 8 u. No more than 2 cells as far as there are cells, so that a box always asks
// for few.
constexpr double kCellMargin = 0x1p-50;

// Cells farther out hold no impulses: a double has two bits left there for a place within one.
// Scenes come to 10^15, a coordinate of 10^6 at 10^9 cells per unit; warps, and callers of the
// library, may go beyond.
constexpr double kFarthestCell = 0x1p51;

// Bound on |n| of one octave with unit amplitude: the worst place sees every cell's impulses at the
// cell's nearest point with weight 1. Worst over a grid of places with a margin for what lies
// between.
double octave_bound(int impulses_per_cell) {
  constexpr int kSteps = 16;
  constexpr double kSpacing = 0.5 / kSteps;
  double worst = 0.0;
  for (int a = 0; a <= kSteps; ++a)
    for (int b = a; b <= kSteps; ++b)
      for (int c = b; c <= kSteps; ++c) {
        const Imath::V3d p(a * kSpacing, b * kSpacing,
                           c * kSpacing);  // the cell's symmetry covers the rest
        double sum = 0.0;
        for (int i = -1; i <= 1; ++i)
          for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k) {
              double square = 0.0;
              const int cell[3] = {i, j, k};
              for (int axis = 0; axis < 3; ++axis) {
                // Distance to the cell, less what a place between the grid's can be nearer.
                const double away =
                    std::max({cell[axis] - p[axis], p[axis] - cell[axis] - 1.0, 0.0});
                const double low = std::max(0.0, away - kSpacing);
                square += low * low;
              }
              if (square < 1.0) sum += std::pow(1.0 - square, 3);
            }
        worst = std::max(worst, sum);
      }
  return worst * impulses_per_cell * std::sqrt(3.0 / impulses_per_cell);
}

class SparseConvolution final : public Expression {
 public:
  explicit SparseConvolution(const SparseConvolutionParameters& parameters)
      : unlisted_((1ull << parameters.octaves.size()) - 1) {
    const double bound = octave_bound(parameters.impulses_per_cell);
    auto process = std::make_shared<Process>();
    process->parameters = parameters;
    for (const Octave& o : parameters.octaves)
      process->bounds.push_back(bound * std::abs(o.amplitude) * (1.0 + 1e-9));
    process_ = std::move(process);
  }

  double value(const Imath::V3d& x) const override {
    double sum = listed_.value(x);
    if (unlisted_ != 0) sum += near(x).value(x);
    return sum;
  }

  Jet jet(const Imath::V3d& x) const override {
    Jet jet;
    add_jet(listed_, x, jet);
    if (unlisted_ != 0) add_jet(near(x), x, jet);
    return jet;
  }

  LocalModel model(const Box& box) const override {
    RadialSum sum(box);
    add_terms(listed_, sum);
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted_ >> i) & 1) == 0) continue;
      if (small_enough(box, octaves()[i])) {
        ImpulseList impulses;
        list(static_cast<std::uint32_t>(i), box, impulses);
        add_terms(impulses, sum);
      } else {
        constexpr double kUnknown = std::numeric_limits<double>::infinity();
        sum.add_constant(0.0, process_->bounds[i], kUnknown, kUnknown);
      }
    }
    return sum.finish();
  }

  void child_models(const Box& box, unsigned wanted, topology::ModelBatch& out) const override {
    if (unlisted_ != 0) return ScalarField::child_models(box, wanted, out);
    out.start(box);
    child_models_of(listed_, out);
  }

  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    std::unique_ptr<SparseConvolution> field(new SparseConvolution(process_));
    const RadialSum frame(box);
    field->unlisted_ = unlisted_;
    field->listed_.append_reaching(listed_, frame.centre(), frame.half());
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted_ >> i) & 1) == 0 || !small_enough(box, octaves()[i])) continue;
      list(static_cast<std::uint32_t>(i), box, field->listed_);
      field->unlisted_ &= ~(1ull << i);
    }
    return field;
  }

  TapeValue emit(TapeBuilder& tape) const override {
    if (unlisted_ != 0 && !tape.single_precision()) return tape.opaque(*this);
    TapeValue sum = tape.impulses(listed_);
    for (std::size_t i = 0; i < octaves().size(); ++i)
      if ((unlisted_ >> i) & 1)
        sum =
            tape.add(sum, tape.impulse_process(process_->parameters, static_cast<std::uint32_t>(i),
                                               process_->bounds[i]));
    return sum;
  }

  Interval expected_range() const override {
    // 6.2 standard deviations of every octave at once.
    double bound = 0.0;
    for (const Octave& o : octaves()) bound += 6.2 * 0.5345 * std::abs(o.amplitude);
    return {-bound, bound};
  }

  std::optional<Box> superlevel_box(double level) const override {
    if (expected_range().hi < level) return Box();
    return std::nullopt;
  }

 private:
  // What all restrictions of one noise share.
  struct Process {
    SparseConvolutionParameters parameters;
    std::vector<double> bounds;  // of |octave|
  };

  explicit SparseConvolution(std::shared_ptr<const Process> process)
      : process_(std::move(process)) {}

  const std::vector<Octave>& octaves() const { return process_->parameters.octaves; }

  // Listing an octave's impulses pays once the box is a few cells wide.
  static bool small_enough(const Box& box, const Octave& octave) {
    const Imath::V3d size = box.max - box.min;
    return std::max({size.x, size.y, size.z}) * octave.frequency <= 4.0;
  }

  // Adds the impulses of one octave that reach the box.
  void list(std::uint32_t octave, const Box& box, ImpulseList& out) const {
    const SparseConvolutionParameters& parameters = process_->parameters;
    const Octave& o = parameters.octaves[octave];
    const RadialSum frame(box);
    std::int64_t lo[3], hi[3];
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kBeyond = 2.0 * kFarthestCell;  // where the range of cells is empty
      const double a = std::clamp(box.min[axis] * o.frequency, -kBeyond, kBeyond);
      const double b = std::clamp(box.max[axis] * o.frequency, -kBeyond, kBeyond);
      if (!(a <= b)) return;  // not numbers
      const double first = std::floor(a - 1.0 - kCellMargin * (1.0 + std::abs(a)));
      const double last = std::floor(b + 1.0 + kCellMargin * (1.0 + std::abs(b)));
      lo[axis] = static_cast<std::int64_t>(std::max(first, -kFarthestCell));
      hi[axis] = static_cast<std::int64_t>(std::min(last, kFarthestCell));
    }
    const double scale = o.amplitude * std::sqrt(3.0 / parameters.impulses_per_cell);
    Impulse p;
    p.inverse_square = o.frequency * o.frequency;
    for (std::int64_t k = lo[2]; k <= hi[2]; ++k)
      for (std::int64_t j = lo[1]; j <= hi[1]; ++j)
        for (std::int64_t i = lo[0]; i <= hi[0]; ++i)
          for (int n = 0; n < parameters.impulses_per_cell; ++n) {
            const CellImpulse c = cell_impulse(i, j, k, static_cast<std::uint32_t>(n),
                                               parameters.first_octave + octave, parameters.seed);
            p.centre = Imath::V3d((static_cast<double>(i) + c.x) / o.frequency,
                                  (static_cast<double>(j) + c.y) / o.frequency,
                                  (static_cast<double>(k) + c.z) / o.frequency);
            p.weight = scale * c.weight;
            if (reaches(p, frame.centre(), frame.half())) out.push_back(p);
          }
  }

  ImpulseList near(const Imath::V3d& x) const {
    ImpulseList impulses;
    for (std::size_t i = 0; i < octaves().size(); ++i)
      if ((unlisted_ >> i) & 1) list(static_cast<std::uint32_t>(i), Box(x, x), impulses);
    return impulses;
  }

  std::shared_ptr<const Process> process_;
  ImpulseList listed_;
  std::uint64_t unlisted_ = 0;  // octaves whose impulses are not in listed_: bit i
};

}  // namespace

std::vector<Octave> fbm_octaves(double amplitude, double frequency, int layers, double lacunarity,
                                double hurst) {
  std::vector<Octave> octaves;
  for (int i = 0; i < layers; ++i) {
    octaves.push_back({amplitude * std::pow(lacunarity, -hurst * i), frequency});
    frequency *= lacunarity;
  }
  return octaves;
}

std::unique_ptr<Expression> make_sparse_convolution(const SparseConvolutionParameters& parameters) {
  return std::make_unique<SparseConvolution>(parameters);
}

}  // namespace morsel::geom
