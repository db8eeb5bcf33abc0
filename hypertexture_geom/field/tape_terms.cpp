// SPDX-License-Identifier: Apache-2.0
// The tape's functions of the point: what they read, and how far single precision can be off.
#include <algorithm>
#include <cmath>
#include <limits>

#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/perlin_model.h"
#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kUp = 1.0 + 1e-12;

Interval about_zero(double size) { return {-size, size}; }

// Lattice coordinates from here on are not told apart in double precision: noises end there.
constexpr double kFarthestCell = 0x1p51;

}  // namespace

// The bounds of a function of the point, by the chain rule where the point is computed: y is off by
// e_y, so the value by slope . e_y + bend |e_y|^2 more.
TapeValue TapeBuilder::place(const Step& step, const Local& local) {
  TapeValue v = append(step);
  v.range = local.range;
  v.error = local.error;
  if (scope_.is_input) {
    for (int i = 0; i < 3; ++i) {
      v.slope[i] = local.slope[i];
      v.slope_error[i] = local.slope_error[i];
    }
    check(v);
    return v;
  }
  double off = 0.0;
  for (const TapeValue& y : scope_.y) off += y.error;
  for (int a = 0; a < 3; ++a) v.error += local.slope[a].magnitude() * scope_.y[a].error;
  v.error += local.bend * off * off;
  for (int i = 0; i < 3; ++i) {
    v.slope[i] = Interval::point(0.0);
    double error = 0.0, size = 0.0;
    for (int a = 0; a < 3; ++a) {
      const TapeValue& y = scope_.y[a];
      const double s = local.slope[a].magnitude(), j = y.slope[i].magnitude() + y.slope_error[i];
      v.slope[i] = v.slope[i] + local.slope[a] * y.slope[i];
      const double wrong = local.slope_error[a] + local.bend * off;
      error += wrong * j + s * y.slope_error[i];
      size += (s + wrong) * j;
    }
    v.slope_error[i] = error + 4.0 * unit_ * size;
  }
  check(v);
  return v;
}

TapeValue TapeBuilder::linear(const Imath::V3d& row, const Imath::V3d& origin) {
  const Step s = step(TapeOp::kLinear);
  const double c = row.dot(scope_.centre - origin);
  constants_.insert(constants_.end(), {row.x, row.y, row.z, c});
  Local l;
  double size = std::abs(c), far = 0.0;
  l.range = Interval::point(c);
  for (int i = 0; i < 3; ++i) {
    const double a = std::abs(row[i]);
    size += a * scope_.reach[i];
    far += a * std::abs(scope_.centre[i] - origin[i]);
    l.range = l.range + about_zero(a * scope_.reach[i]);
    l.slope[i] = Interval::point(row[i]);
    l.slope_error[i] = unit_ * a;
  }
  l.error = 5.0 * unit_ * size + 4.0 * kEpsilon * far;
  l.range.lo -= l.error;
  l.range.hi += l.error;
  return place(s, l);
}

TapeValue TapeBuilder::squares(const Imath::V3d (&rows)[3], const Imath::V3d& origin,
                               double constant) {
  const Step s = step(TapeOp::kSquares);
  Local l;
  l.range = Interval::point(constant);
  double size[3] = {};
  for (const Imath::V3d& row : rows) {
    const double c = row.dot(scope_.centre - origin);
    constants_.insert(constants_.end(), {row.x, row.y, row.z, c});
    double terms = std::abs(c), far = 0.0, reach = 0.0;
    for (int i = 0; i < 3; ++i) {
      terms += std::abs(row[i]) * scope_.reach[i];
      reach += std::abs(row[i]) * scope_.reach[i];
      far += std::abs(row[i]) * std::abs(scope_.centre[i] - origin[i]);
    }
    const double e = 5.0 * unit_ * terms + 4.0 * kEpsilon * far;
    const Interval u{c - reach * kUp - e, c + reach * kUp + e};
    const double most = u.magnitude();
    l.range = l.range + topology::square(u);
    l.error += e * (2.0 * most + e);
    for (int i = 0; i < 3; ++i) {
      l.slope[i] = l.slope[i] + Interval::point(2.0 * row[i]) * u;
      l.slope_error[i] += 2.0 * std::abs(row[i]) * e;
      size[i] += 2.0 * std::abs(row[i]) * (most + e);
    }
    l.bend += 2.0 * row.length2();
  }
  constants_.push_back(constant);
  l.error += 5.0 * unit_ * (l.range.magnitude() + l.error);
  for (int i = 0; i < 3; ++i) l.slope_error[i] += 5.0 * unit_ * size[i];
  return place(s, l);
}

// With r the distance in radii and q = 1 - r^2, an impulse is w q^3 and its gradient -6 w s q^2 d.
// A coordinate of d is off by the rounding of the centre and of the difference, in radii by at most
// u (2 reach + 2), d by sqrt(3) times that, e; q by 2 r e + e^2 + 6 u. On the box q is at most Q,
// and
//   q^2 r <= min(Q^2, 0.2863),  q r^2 <= min(Q, 1/4),  q r <= min(Q, 0.385).
TapeValue TapeBuilder::impulses(const ImpulseList& list) {
  if (list.empty()) return constant(0.0);
  Step s = step(TapeOp::kImpulses);
  s.count = static_cast<std::uint32_t>((list.size() + kTapeBlock - 1) / kTapeBlock);
  constants_.resize(s.constants + std::size_t{s.count} * 5 * kTapeBlock, 0.0);
  Local l;
  double sum = 0.0, slope_sum = 0.0;
  const double longest = std::max({scope_.reach.x, scope_.reach.y, scope_.reach.z});
  for (std::size_t n = 0; n < list.size(); ++n) {
    const Impulse p = list[n];
    double* block = constants_.data() + s.constants + n / kTapeBlock * 5 * kTapeBlock;
    const std::size_t k = n % kTapeBlock;
    double nearest = 0.0, farthest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const int axis = static_cast<int>(i);
      const double c = p.centre[axis] - scope_.centre[axis];
      block[i * kTapeBlock + k] = c;
      const double away = std::max(0.0, std::abs(c) - scope_.reach[axis] * kUp);
      nearest += away * away;
      farthest = std::max(farthest, std::abs(c));
    }
    block[3 * kTapeBlock + k] = p.inverse_square;
    block[4 * kTapeBlock + k] = p.weight;
    // Far from the box no rounding makes the impulse reach it.
    const double w = std::abs(p.weight), f = std::sqrt(p.inverse_square);
    // The difference of the two centres, which are exact, is rounded once; then again to T.
    const double radii = f * std::min(farthest, longest + 1.01 / f);
    const double e = 1.7321 * (unit_ * (radii + 1.5) + kEpsilon * radii) * kUp;
    const double q_error = 2.0 * e + e * e + 6.0 * unit_;
    const double q =
        std::min(1.0, std::max(0.0, 1.0 - p.inverse_square * nearest) + 1e-12 + q_error);
    const double value = w * q * q * q;
    const double steep = 6.0 * w * f * std::min(q * q, 0.2863);
    l.range = l.range + (p.weight < 0.0 ? Interval{-value, 0.0} : Interval{0.0, value});
    l.error += w * (6.0 * e * std::min(q * q, 0.2863) + 22.0 * unit_ * q * q +
                    3.0 * q * q_error * q_error + q_error * q_error * q_error);
    const double slope_error =
        6.0 * w * f *
        (4.0 * e * std::min(q, 0.25) + 12.0 * unit_ * std::min(q, 0.385) + q * q * e +
         q_error * q_error + 6.0 * unit_ * std::min(q * q, 0.2863));
    for (int i = 0; i < 3; ++i) {
      l.slope[i] = l.slope[i] + about_zero(steep);
      l.slope_error[i] += slope_error;
    }
    // Second derivatives: at most 6 w s q^2 across the radius and 6 w s q |5 q - 4| along it.
    l.bend += 6.0 * w * p.inverse_square * std::min(1.0, 4.0 * q);
    sum += value;
    slope_sum += steep;
  }
  // A sum of n numbers in any order.
  const double terms = unit_ * static_cast<double>(list.size() + 4);
  l.error += terms * sum;
  for (double& error : l.slope_error) error += terms * slope_sum;
  return place(s, l);
}

// In lattice coordinates, at the point's own cell's corner: q = frequency x + c is off by
// u (2 |frequency x| + |c| + |q|), an impulse's place by 2^-24 more for want of its lowest bits and
// of another rounding. At most `terms` impulses are summed.
TapeValue TapeBuilder::impulse_process(const SparseConvolutionParameters& parameters,
                                       std::uint32_t octave, double bound) {
  Step s = step(TapeOp::kProcess);
  const Octave& o = parameters.octaves[octave];
  const double scale = o.amplitude * std::sqrt(3.0 / parameters.impulses_per_cell);
  double wide = 0.0, far = 0.0;
  constants_.push_back(o.frequency);
  std::int64_t cell[3];
  for (int a = 0; a < 3; ++a) {
    double q = scope_.centre[a] * o.frequency;
    if (!(std::abs(q) < kFarthestCell)) {
      far = kInfinity;
      q = 0.0;
    }
    const double corner = std::floor(q);
    cell[a] = static_cast<std::int64_t>(corner);
    constants_.push_back(q - corner);
    wide = std::max(wide, scope_.reach[a] * o.frequency);
    far = std::max(far, kEpsilon * std::abs(q));
  }
  constants_.push_back(scale);
  for (const std::int64_t c : cell)
    words_.push_back(static_cast<std::int32_t>(static_cast<std::uint32_t>(c)));
  words_.push_back(static_cast<std::int32_t>(
      impulse_process_key(parameters.first_octave + octave, parameters.seed)));
  words_.push_back(parameters.impulses_per_cell);
  const double terms = 27.0 * parameters.impulses_per_cell;
  const double w = std::abs(scale), e = 1.7321 * (unit_ * (3.0 * wide + 8.0) + far) * kUp;
  // `bound` is what all impulses in reach can come to with weights of one sign.
  const double reached = bound / w;
  Local l;
  l.range = about_zero(bound);
  const double steep = 6.0 * 0.2863 * terms * w * o.frequency;
  l.error = w * terms * (6.0 * 0.2863 * e + 3.0 * e * e * 4.0) +
            w * reached * unit_ * (24.0 + terms) + w * terms * 3.0 * unit_;
  for (int i = 0; i < 3; ++i) {
    l.slope[i] = about_zero(steep);
    l.slope_error[i] = 6.0 * w * o.frequency * terms * (2.0 * e + 4.0 * e * e + 12.0 * unit_) +
                       unit_ * (terms + 8.0) * steep;
  }
  l.bend = 6.0 * terms * w * o.frequency * o.frequency;
  if (!(wide < 0x1p22)) l.error = kInfinity;
  return place(s, l);
}

bool TapeBuilder::tabulates_perlin(const Box& box, double frequency) {
  constexpr double kMostCells = 6.0;
  const Imath::V3d size = box.max - box.min;
  return std::max({size.x, size.y, size.z}) * frequency <= kMostCells;
}

// The fade curve is off by at most 25 u, corners' linear functions differ by less than 3, and q is
// off as for the impulse process; between cells n is twice continuously differentiable, so a point
// that is taken to be across a lattice plane costs no more.
TapeValue TapeBuilder::perlin(double amplitude, double frequency, const PerlinLattice& lattice) {
  const bool table = tabulates_perlin(scope_.box, frequency);
  const Step s = step(table ? TapeOp::kPerlin : TapeOp::kPerlinHash);
  constants_.push_back(frequency);
  std::int64_t first[3], cells[3];
  double off = 0.0, far = 0.0;
  for (int a = 0; a < 3; ++a) {
    double q = scope_.centre[a] * frequency + lattice.offset()[a];
    const double reach = scope_.reach[a] * frequency * kUp;
    if (!(std::abs(q) < kFarthestCell)) {
      far = kInfinity;
      q = 0.0;
    }
    first[a] = static_cast<std::int64_t>(std::floor(table ? q - reach : q));
    cells[a] =
        std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(q + reach)) - first[a]);
    const double shift = q - static_cast<double>(first[a]);
    constants_.push_back(shift);
    off = std::max(off, unit_ * (3.0 * reach + 2.0 * shift + 1.0));
    far = std::max(far, 2.0 * kEpsilon * std::abs(q));
    if (!(reach < 0x1p22)) off = kInfinity;
  }
  constants_.push_back(amplitude);
  if (table) {
    for (const std::int64_t c : cells) words_.push_back(static_cast<std::int32_t>(c));
    for (std::int64_t k = 0; k < cells[2]; ++k)
      for (std::int64_t j = 0; j < cells[1]; ++j)
        for (std::int64_t i = 0; i < cells[0]; ++i) {
          std::uint32_t corners = 0;
          for (int n = 0; n < 8; ++n)
            corners |=
                static_cast<std::uint32_t>(lattice.direction(
                    first[0] + i + (n & 1), first[1] + j + ((n >> 1) & 1), first[2] + k + (n >> 2)))
                << (4 * n);
          words_.push_back(static_cast<std::int32_t>(corners));
        }
  } else {
    for (const std::int64_t c : first)
      words_.push_back(static_cast<std::int32_t>(static_cast<std::uint32_t>(c)));
    words_.push_back(static_cast<std::int32_t>(lattice.key()));
  }
  const double size = std::abs(amplitude), e = 3.0 * (off + far);
  Local l;
  l.range = about_zero(size * kPerlinBound[0]);
  l.error = size * (kPerlinBound[1] * e + 256.0 * unit_ + 1e4 * e * e * e);
  for (int i = 0; i < 3; ++i) {
    l.slope[i] = about_zero(size * frequency * kPerlinBound[1]);
    l.slope_error[i] = size * frequency * (kPerlinBound[2] * e + 600.0 * unit_ + 1e4 * e * e);
  }
  l.bend = size * frequency * frequency * kPerlinBound[2];
  return place(s, l);
}

TapeValue TapeBuilder::opaque(const topology::ScalarField& f, double size, double steepness) {
  Step s = step(TapeOp::kOpaque);
  s.count = static_cast<std::uint32_t>(opaque_.size());
  opaque_.push_back({&f, scope_.centre});
  const topology::LocalModel m = f.model(scope_.box);
  Local l;
  l.range = m.range();
  // The point is off by its own rounding, half a unit in the last place of |x| at most, and by the
  // four units that ScalarField allows.
  double off = 0.0;
  for (int i = 0; i < 3; ++i)
    off += 5.0 * kEpsilon * (std::abs(scope_.centre[i]) + scope_.reach[i]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) l.bend = std::max(l.bend, m.hessian_range(i, j).magnitude());
  constexpr double kRelative = topology::kFieldAccuracy;
  l.error = unit_ * l.range.magnitude() + kRelative * (1.0 + std::max(size, l.range.magnitude()));
  for (int i = 0; i < 3; ++i) {
    l.slope[i] = m.gradient_range(i);
    l.error += l.slope[i].magnitude() * off;
    l.slope_error[i] = unit_ * l.slope[i].magnitude() +
                       kRelative * (1.0 + std::max(steepness, l.slope[i].magnitude())) +
                       l.bend * off;
  }
  return place(s, l);
}

}  // namespace morsel::geom
