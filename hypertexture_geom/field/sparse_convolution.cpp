// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/sparse_convolution.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/impulse_model.h"
#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/impulse_range.h"
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
    double sum = whole_.value(x) + cut_.value(x);
    if (unlisted_ != 0) sum += near(x).value(x);
    return sum;
  }

  Jet jet(const Imath::V3d& x) const override {
    Jet jet;
    add_jet(whole_, x, jet);
    add_jet(cut_, x, jet);
    if (unlisted_ != 0) add_jet(near(x), x, jet);
    return jet;
  }

  LocalModel model(const Box& box) const override {
    RadialSum sum(box);
    sum.add(polynomial_);
    const double width = width_of(box);
    Split split;
    add_terms(split_at(width, split), sum);
    std::uint64_t wide = unlisted_;
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted_ >> i) & 1) == 0 || is_wide(width, octaves()[i].frequency)) continue;
      ImpulseList impulses;
      list(static_cast<std::uint32_t>(i), box, impulses);
      add_terms(impulses, sum);
      wide &= ~(1ull << i);
    }
    if (wide != 0 || !split.wide.empty()) {
      const ImpulseRange r = range_on(box, sum.centre(), sum.half(), split.wide, wide);
      sum.add_constant(middle(r), half_range(r),
                       Imath::V3d(r.gradient[0], r.gradient[1], r.gradient[2]), r.hessian);
    }
    return sum.finish();
  }

  void child_models(const Box& box, unsigned wanted, topology::ModelBatch& out) const override {
    const double width = 0.5 * width_of(box);
    for (std::size_t i = 0; i < octaves().size(); ++i)
      if (((unlisted_ >> i) & 1) != 0 && !is_wide(width, octaves()[i].frequency))
        return ScalarField::child_models(box, wanted, out);
    out.start(box);
    Split split;
    child_models_of(split_at(width, split), polynomial_, out);
    if (unlisted_ == 0 && split.wide.empty()) return;
    topology::ModelBatch rest;
    rest.start(box);
    for (int i = 0; i < topology::ModelBatch::kSize; ++i) {
      if (((wanted >> i) & 1) == 0) continue;
      const Imath::V3d centre(rest.centre[0][i], rest.centre[1][i], rest.centre[2][i]);
      const Imath::V3d half(rest.half[0][i], rest.half[1][i], rest.half[2][i]);
      const ImpulseRange r =
          range_on(topology::child_box(box, i), centre, half, split.wide, unlisted_);
      rest.c[topology::monomial::k1][i] = middle(r);
      rest.value_error[i] = half_range(r);
      for (int axis = 0; axis < 3; ++axis) rest.gradient_error[axis][i] = r.gradient[axis];
      rest.hessian_error[i] = r.hessian;
    }
    out.add(rest);
  }

  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    std::unique_ptr<SparseConvolution> field(new SparseConvolution(process_));
    RadialSum sum(box);
    ImpulseList whole;
    field->unlisted_ = unlisted_;
    cut_.sort(sum.centre(), sum.half(), whole, field->cut_);
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted_ >> i) & 1) == 0 || !can_range(box, octaves()[i])) continue;
      ImpulseList hashed;
      const ImpulseList& impulses = pool(i, box, hashed);
      if (small_enough(box, octaves()[i])) {
        impulses.sort(sum.centre(), sum.half(), whole, field->cut_);
        field->unlisted_ &= ~(1ull << i);
      } else {
        field->pools_.resize(octaves().size());
        impulses.sort(sum.centre(), sum.half(), field->pools_[i], field->pools_[i]);
        field->pooled_ |= 1ull << i;
      }
    }
    sum.add(polynomial_);
    add_terms(whole, sum);
    field->polynomial_ = sum.polynomial();
    field->whole_.reserve(whole_.size() + whole.size());
    field->whole_.append(whole_);
    field->whole_.append(whole);
    return field;
  }

  TapeValue emit(TapeBuilder& tape) const override {
    if (unlisted_ != 0 && !tape.single_precision()) return tape.opaque(*this);
    ImpulseList listed = whole_;
    listed.append(cut_);
    TapeValue sum = tape.impulses(listed);
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

  static double width_of(const Box& box) {
    const Imath::V3d size = box.max - box.min;
    return std::max({size.x, size.y, size.z});
  }

  // Listing an octave's impulses pays once the box is a few cells wide.
  static bool small_enough(const Box& box, const Octave& octave) {
    return width_of(box) * octave.frequency <= 4.0;
  }

  // Up to this width ranges of the octave's impulses say more than its bounds over all space.
  static bool can_range(const Box& box, const Octave& octave) {
    return width_of(box) * octave.frequency <= 8.0;
  }

  // The impulses of an octave that is not listed, at least those that reach the box; made in
  // `hashed` unless they are at hand.
  const ImpulseList& pool(std::size_t octave, const Box& box, ImpulseList& hashed) const {
    if ((pooled_ >> octave & 1) != 0) return pools_[octave];
    list(static_cast<std::uint32_t>(octave), box, hashed);
    return hashed;
  }

  // On boxes wider than a kernel's radius a cubic says no more than a range does.
  static bool is_wide(double width, double frequency) { return !(width * frequency <= 1.0); }

  // What cut_ holds, in parts: impulses whose kernels are not small for a box, and lists of the
  // others, one an octave.
  struct Split {
    ImpulseList narrow;
    std::vector<ImpulseList> wide;
  };

  // Returns the impulses that are not `wide`, which are in `split` if there are others.
  const ImpulseList& split_at(double width, Split& split) const {
    const double limit = 1.0 / (width * width);
    std::size_t narrow = 0;
    for (std::size_t n = 0; n < cut_.size(); ++n)
      if (cut_.inverse_square(n) <= limit) ++narrow;
    if (narrow == cut_.size()) return cut_;
    split.narrow.reserve(narrow);
    for (std::size_t n = 0; n < cut_.size(); ++n) {
      const Impulse p = cut_[n];
      if (p.inverse_square <= limit) {
        split.narrow.push_back(p);
        continue;
      }
      if (split.wide.empty() || split.wide.back().inverse_square(0) != p.inverse_square)
        split.wide.emplace_back().reserve(cut_.size());
      split.wide.back().push_back(p);
    }
    return split.narrow;
  }

  // Of listed impulses, and of the octaves whose bits are set.
  ImpulseRange range_on(const Box& box, const Imath::V3d& centre, const Imath::V3d& half,
                        const std::vector<ImpulseList>& listed, std::uint64_t unlisted) const {
    ImpulseRange range;
    for (const ImpulseList& impulses : listed) range += range_of(impulses, centre, half);
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted >> i) & 1) == 0) continue;
      if (can_range(box, octaves()[i])) {
        ImpulseList hashed;
        range += range_of(pool(i, box, hashed), centre, half);
      } else {
        constexpr double kUnknown = std::numeric_limits<double>::infinity();
        const double bound = process_->bounds[i];
        range += {-bound, bound, {kUnknown, kUnknown, kUnknown}, kUnknown};
      }
    }
    return range;
  }

  static double middle(const ImpulseRange& r) { return 0.5 * (r.lo + r.hi); }
  static double half_range(const ImpulseRange& r) { return 0.5 * (r.hi - r.lo) * (1.0 + 1e-12); }

  // Adds the impulses of one octave that may reach the box, and others of cells that do.
  void list(std::uint32_t octave, const Box& box, ImpulseList& out) const {
    const SparseConvolutionParameters& parameters = process_->parameters;
    const Octave& o = parameters.octaves[octave];
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
    const std::uint32_t key =
        impulse_process_key(parameters.first_octave + octave, parameters.seed);
    for (std::int64_t k = lo[2]; k <= hi[2]; ++k)
      for (std::int64_t j = lo[1]; j <= hi[1]; ++j)
        for (std::int64_t i = lo[0]; i <= hi[0]; ++i) {
          const std::uint32_t cell = impulse_cell_key(key, i, j, k);
          for (int n = 0; n < parameters.impulses_per_cell; ++n) {
            const CellImpulse c = cell_impulse(cell, static_cast<std::uint32_t>(n));
            p.centre = Imath::V3d((static_cast<double>(i) + c.x) / o.frequency,
                                  (static_cast<double>(j) + c.y) / o.frequency,
                                  (static_cast<double>(k) + c.z) / o.frequency);
            p.weight = scale * c.weight;
            out.push_back(p);
          }
        }
  }

  ImpulseList near(const Imath::V3d& x) const {
    ImpulseList impulses;
    for (std::size_t i = 0; i < octaves().size(); ++i)
      if ((unlisted_ >> i) & 1) list(static_cast<std::uint32_t>(i), Box(x, x), impulses);
    return impulses;
  }

  std::shared_ptr<const Process> process_;
  std::uint64_t unlisted_ = 0;  // octaves whose impulses are in neither whole_ nor cut_: bit i
  // Impulses whose kernels hold all of the box, which polynomial_ is the sum of, and those whose
  // kernels' borders cross it.
  ImpulseList whole_, cut_;
  RadialPolynomial polynomial_;
  // On boxes too wide for an octave's impulses to be listed, those of octave i that children will
  // choose from: bit i of pooled_.
  std::vector<ImpulseList> pools_;
  std::uint64_t pooled_ = 0;
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
