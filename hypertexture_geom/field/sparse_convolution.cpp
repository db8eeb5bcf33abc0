// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/sparse_convolution.h"

#include <algorithm>
#include <cmath>

#include "hypertexture_geom/field/impulse_list.h"
#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/radial_model.h"
#include "hypertexture_geom/field/truncated_cube.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// Squared distance from a point at `d` from the box's centre to the nearest and to the farthest
// point of the box.
struct Distances {
  double nearest, farthest;
};

Distances distances(const Imath::V3d& d, const Imath::V3d& half) {
  Distances r{0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double a = std::abs(d[i]);
    const double low = std::max(0.0, a - half[i]), high = a + half[i];
    r.nearest += low * low;
    r.farthest += high * high;
  }
  return r;
}

// Relative slack on squared distances: far above their rounding, far below anything that matters.
constexpr double kSlack = 1e-12;

bool reaches(const Impulse& impulse, const Imath::V3d& centre, const Imath::V3d& half) {
  return impulse.inverse_square * distances(centre - impulse.centre, half).nearest < 1.0 + kSlack;
}

RadialTerm radial_term(const Impulse& impulse, const Imath::V3d& centre, const Imath::V3d& half) {
  RadialTerm t;
  t.d = centre - impulse.centre;
  t.s = -impulse.inverse_square;
  t.weight = impulse.weight;
  const Distances r = distances(t.d, half);
  const double near = impulse.inverse_square * r.nearest, far = impulse.inverse_square * r.farthest;
  const double q0 = 1.0 - impulse.inverse_square * t.d.length2();
  t.size = 1.0 + far;
  const double lo = 1.0 - far - kSlack * t.size, hi = 1.0 - near + kSlack * t.size;
  const CubicPiece piece = truncated_cube(q0, lo, hi);
  std::copy(piece.a, piece.a + 4, t.a);
  std::copy(piece.error, piece.error + 3, t.error);
  const double z = t.size;
  t.a_size[0] = z * z * z;
  t.a_size[1] = 3.0 * z * z;
  t.a_size[2] = 3.0 * z;
  t.a_size[3] = 1.0;
  // In a box much wider than the kernel the polynomial says less than the plain range.
  const double top = std::clamp(hi, 0.0, 1.0);
  const double reach = 2.0 * impulse.inverse_square * std::sqrt(r.farthest);  // of |grad q|
  if (reach * (half.x + half.y + half.z) > 2.0) {
    const double bottom = std::clamp(lo, 0.0, 1.0);
    const double high = top * top * top, low = bottom * bottom * bottom;
    t.a[0] = 0.5 * (high + low);
    t.a[1] = t.a[2] = t.a[3] = 0.0;
    t.error[0] = 0.5 * (high - low);
    t.error[1] = 3.0 * top * top;
    t.error[2] = 6.0 * top;
  }
  return t;
}

void add_jet(const ImpulseList& impulses, const Imath::V3d& x, Jet& jet) {
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    const Impulse p = impulses[n];
    const Imath::V3d d = x - p.centre;
    const double q = 1.0 - p.inverse_square * d.length2();
    if (q <= 0.0) continue;
    // grad q = -2 s d, Hessian of q = -2 s I.
    const double s2 = 2.0 * p.inverse_square;
    const double first = 3.0 * p.weight * q * q, second = 6.0 * p.weight * q * s2 * s2;
    jet.value += p.weight * (q * q * q);
    jet.gradient -= d * (first * s2);
    jet.hessian[0] += second * d.x * d.x - first * s2;
    jet.hessian[1] += second * d.y * d.y - first * s2;
    jet.hessian[2] += second * d.z * d.z - first * s2;
    jet.hessian[3] += second * d.x * d.y;
    jet.hessian[4] += second * d.x * d.z;
    jet.hessian[5] += second * d.y * d.z;
  }
}

void add_terms(const ImpulseList& impulses, RadialSum& sum) {
  for (std::size_t n = 0; n < impulses.size(); ++n)
    if (const Impulse p = impulses[n]; reaches(p, sum.centre(), sum.half()))
      sum.add(radial_term(p, sum.centre(), sum.half()));
}

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

  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    std::unique_ptr<SparseConvolution> field(new SparseConvolution(process_));
    const RadialSum frame(box);
    field->unlisted_ = unlisted_;
    for (std::size_t n = 0; n < listed_.size(); ++n)
      if (const Impulse p = listed_[n]; reaches(p, frame.centre(), frame.half()))
        field->listed_.push_back(p);
    for (std::size_t i = 0; i < octaves().size(); ++i) {
      if (((unlisted_ >> i) & 1) == 0 || !small_enough(box, octaves()[i])) continue;
      list(static_cast<std::uint32_t>(i), box, field->listed_);
      field->unlisted_ &= ~(1ull << i);
    }
    return field;
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
      // One cell is the kernel's radius; the margin covers the rounding of the products.
      const double a = box.min[axis] * o.frequency, b = box.max[axis] * o.frequency;
      lo[axis] = static_cast<std::int64_t>(std::floor(a - 1.0 - 1e-9 * (1.0 + std::abs(a))));
      hi[axis] = static_cast<std::int64_t>(std::floor(b + 1.0 + 1e-9 * (1.0 + std::abs(b))));
    }
    const double scale = o.amplitude * std::sqrt(3.0 / parameters.impulses_per_cell);
    Impulse p;
    p.inverse_square = o.frequency * o.frequency;
    for (std::int64_t k = lo[2]; k <= hi[2]; ++k)
      for (std::int64_t j = lo[1]; j <= hi[1]; ++j)
        for (std::int64_t i = lo[0]; i <= hi[0]; ++i)
          for (int n = 0; n < parameters.impulses_per_cell; ++n) {
            const CellImpulse c =
                cell_impulse(i, j, k, static_cast<std::uint32_t>(n), octave, parameters.seed);
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
