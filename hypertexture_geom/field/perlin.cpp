// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/field/perlin.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "hypertexture_geom/field/perlin_lattice.h"
#include "hypertexture_geom/field/perlin_model.h"
#include "hypertexture_geom/field/tape_builder.h"

namespace morsel::geom {
namespace {

using topology::Box;
using topology::Interval;
using topology::Jet;
using topology::LocalModel;

// Lattice coordinates from here on are whole numbers in double precision, where the noise is 0.
constexpr double kFarthest = 0x1p51;

struct LatticeOctave {
  double amplitude, frequency;
  PerlinLattice lattice;

  double coordinate(const Imath::V3d& x, int axis) const {
    return x[axis] * frequency + lattice.offset()[axis];
  }
};

// The cells of one octave that a box meets; the directions at their corners are at `start` in a
// list, x fastest. A patch of no cells has not been listed.
struct Patch {
  std::int64_t first[3] = {0, 0, 0};
  std::uint16_t cells[3] = {0, 0, 0};
  std::uint32_t start = 0;

  bool listed() const { return cells[0] != 0; }
  // Place of a lattice point in the list.
  std::size_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const auto sx = static_cast<std::int64_t>(cells[0]) + 1;
    const auto sy = static_cast<std::int64_t>(cells[1]) + 1;
    return start +
           static_cast<std::size_t>(i - first[0] + sx * (j - first[1] + sy * (k - first[2])));
  }
  bool holds(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::int64_t p[3] = {i, j, k};
    for (int a = 0; a < 3; ++a)
      if (p[a] < first[a] || p[a] > first[a] + cells[a]) return false;
    return listed();
  }
};

// A point within a cell: coordinates in [0, 1] and the directions at the 8 corners, x fastest.
struct Local {
  double t[3];
  int direction[8];
};

double dot(const Local& p, int corner) {
  const double* g = kPerlinDirection[p.direction[corner]];
  return g[0] * (p.t[0] - (corner & 1)) + g[1] * (p.t[1] - ((corner >> 1) & 1)) +
         g[2] * (p.t[2] - (corner >> 2));
}

double noise(const Local& p) {
  double s[3];
  for (int a = 0; a < 3; ++a)
    s[a] = p.t[a] * p.t[a] * p.t[a] * (10.0 + p.t[a] * (-15.0 + 6.0 * p.t[a]));
  double v[8];
  for (int c = 0; c < 8; ++c) v[c] = dot(p, c);
  for (int c = 0; c < 8; c += 2) v[c] += s[0] * (v[c + 1] - v[c]);
  for (int c = 0; c < 8; c += 4) v[c] += s[1] * (v[c + 2] - v[c]);
  return v[0] + s[2] * (v[4] - v[0]);
}

// Adds factor * n with derivatives, `frequency` being that of the lattice.
void add_jet(const Local& p, double factor, double frequency, Jet& jet) {
  // [derivative][corner]: weights of the two ends of each axis.
  double w[3][3][2];
  for (int a = 0; a < 3; ++a) {
    const double t = p.t[a], m = 1.0 - t;
    const double f = t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
    const double f1 = 30.0 * t * t * m * m, f2 = 60.0 * t * m * (m - t);
    w[a][0][0] = 1.0 - f;
    w[a][0][1] = f;
    w[a][1][0] = -f1;
    w[a][1][1] = f1;
    w[a][2][0] = -f2;
    w[a][2][1] = f2;
  }
  const double factor1 = factor * frequency, factor2 = factor1 * frequency;
  for (int c = 0; c < 8; ++c) {
    const double* g = kPerlinDirection[p.direction[c]];
    const double v = dot(p, c);
    const int e[3] = {c & 1, (c >> 1) & 1, c >> 2};
    const auto weight = [&](int nx, int ny, int nz) {
      return w[0][nx][e[0]] * w[1][ny][e[1]] * w[2][nz][e[2]];
    };
    const double w0 = weight(0, 0, 0);
    const Imath::V3d w1(weight(1, 0, 0), weight(0, 1, 0), weight(0, 0, 1));
    jet.value += factor * w0 * v;
    for (int a = 0; a < 3; ++a) jet.gradient[a] += factor1 * (w1[a] * v + w0 * g[a]);
    jet.hessian[0] += factor2 * (weight(2, 0, 0) * v + 2.0 * w1.x * g[0]);
    jet.hessian[1] += factor2 * (weight(0, 2, 0) * v + 2.0 * w1.y * g[1]);
    jet.hessian[2] += factor2 * (weight(0, 0, 2) * v + 2.0 * w1.z * g[2]);
    jet.hessian[3] += factor2 * (weight(1, 1, 0) * v + w1.x * g[1] + w1.y * g[0]);
    jet.hessian[4] += factor2 * (weight(1, 0, 1) * v + w1.x * g[2] + w1.z * g[0]);
    jet.hessian[5] += factor2 * (weight(0, 1, 1) * v + w1.y * g[2] + w1.z * g[1]);
  }
}

class Perlin final : public Expression {
 public:
  explicit Perlin(const PerlinParameters& parameters) : patches_(parameters.octaves.size()) {
    auto octaves = std::make_shared<std::vector<LatticeOctave>>();
    for (std::size_t i = 0; i < parameters.octaves.size(); ++i)
      octaves->push_back({parameters.octaves[i].amplitude, parameters.octaves[i].frequency,
                          PerlinLattice(parameters.first_octave + static_cast<std::uint32_t>(i),
                                        parameters.seed)});
    octaves_ = std::move(octaves);
  }

  double value(const Imath::V3d& x) const override {
    double sum = 0.0;
    for (std::size_t i = 0; i < octaves_->size(); ++i)
      if (Local p; locate(i, x, p)) sum += (*octaves_)[i].amplitude * noise(p);
    return sum;
  }

  Jet jet(const Imath::V3d& x) const override {
    Jet jet;
    for (std::size_t i = 0; i < octaves_->size(); ++i)
      if (Local p; locate(i, x, p))
        add_jet(p, (*octaves_)[i].amplitude, (*octaves_)[i].frequency, jet);
    return jet;
  }

  LocalModel model(const Box& box) const override {
    double finest = 1e-300;
    for (const LatticeOctave& o : *octaves_) finest = std::max(finest, o.frequency);
    PerlinSum sum(box, finest);
    for (std::size_t n = 0; n < octaves_->size(); ++n) {
      const LatticeOctave& o = (*octaves_)[n];
      sum.add(o.amplitude, o.frequency, o.lattice.offset(),
              [&](std::int64_t i, std::int64_t j, std::int64_t k) {
                const Patch& p = patches_[n];
                return p.holds(i, j, k) ? directions_[p.index(i, j, k)]
                                        : o.lattice.direction(i, j, k);
              });
    }
    return sum.finish();
  }

  std::unique_ptr<ScalarField> restricted_to(const Box& box) const override {
    std::unique_ptr<Perlin> field(new Perlin(octaves_));
    for (std::size_t n = 0; n < octaves_->size(); ++n) field->list(n, *this, box);
    field->directions_.shrink_to_fit();
    return field;
  }

  TapeValue emit(TapeBuilder& tape) const override {
    if (octaves_->empty()) return tape.constant(0.0);
    if (!tape.single_precision()) {
      bool tabulated = true;
      double size = 0.0, steepness = 0.0;
      for (const LatticeOctave& o : *octaves_) {
        tabulated = tabulated && TapeBuilder::tabulates_perlin(tape.box(), o.frequency);
        size += std::abs(o.amplitude) * kPerlinBound[0];
        steepness += std::abs(o.amplitude) * o.frequency * kPerlinBound[1];
      }
      // About 250 roundings of half a unit each lie between the coordinates and the noise.
      if (!tabulated) return tape.opaque(*this, size, steepness);
    }
    TapeValue sum;
    for (const LatticeOctave& o : *octaves_) {
      const TapeValue octave = tape.perlin(o.amplitude, o.frequency, o.lattice);
      sum = sum.builder == nullptr ? octave : tape.add(sum, octave);
    }
    return sum;
  }

  Interval expected_range() const override {
    double bound = 0.0;
    for (const LatticeOctave& o : *octaves_) bound += kPerlinBound[0] * std::abs(o.amplitude);
    bound *= 1.0 + 1e-12;
    return {-bound, bound};
  }

  std::optional<Box> superlevel_box(double level) const override {
    if (expected_range().hi < level) return Box();
    return std::nullopt;
  }

 private:
  explicit Perlin(std::shared_ptr<const std::vector<LatticeOctave>> octaves)
      : octaves_(std::move(octaves)), patches_(octaves_->size()) {}

  // Listing pays on boxes up to a few cells wide.
  static constexpr int kMostCells = 5;

  // Looks up the directions of one octave on the box, as far as `from` knows them there.
  void list(std::size_t n, const Perlin& from, const Box& box) {
    const LatticeOctave& o = (*octaves_)[n];
    Patch p;
    for (int a = 0; a < 3; ++a) {
      // Monotone in x, rounding included: no point of the box is outside of these cells.
      const double lo = o.coordinate(box.min, a), hi = o.coordinate(box.max, a);
      if (!(lo > -kFarthest && hi < kFarthest && hi - lo <= kMostCells - 1)) return;
      p.first[a] = static_cast<std::int64_t>(std::floor(lo));
      // A box that ends on a plane needs no cell beyond it.
      const auto end = std::max(p.first[a] + 1, static_cast<std::int64_t>(std::ceil(hi)));
      p.cells[a] = static_cast<std::uint16_t>(end - p.first[a]);
    }
    p.start = static_cast<std::uint32_t>(directions_.size());
    const Patch& known = from.patches_[n];
    for (std::int64_t k = p.first[2]; k <= p.first[2] + p.cells[2]; ++k)
      for (std::int64_t j = p.first[1]; j <= p.first[1] + p.cells[1]; ++j)
        for (std::int64_t i = p.first[0]; i <= p.first[0] + p.cells[0]; ++i)
          directions_.push_back(known.holds(i, j, k)
                                    ? from.directions_[known.index(i, j, k)]
                                    : static_cast<std::uint8_t>(o.lattice.direction(i, j, k)));
    patches_[n] = p;
  }

  // The cell of octave n that x is in; false where the noise is 0 for want of precision.
  bool locate(std::size_t n, const Imath::V3d& x, Local& local) const {
    const LatticeOctave& o = (*octaves_)[n];
    if (patches_[n].listed()) {
      locate_listed(o, patches_[n], x, local);
      return true;
    }
    std::int64_t cell[3];
    for (int a = 0; a < 3; ++a) {
      const double q = o.coordinate(x, a);
      if (!(std::abs(q) < kFarthest)) return false;
      const double corner = std::floor(q);
      local.t[a] = q - corner;
      cell[a] = static_cast<std::int64_t>(corner);
    }
    for (int c = 0; c < 8; ++c)
      local.direction[c] =
          o.lattice.direction(cell[0] + (c & 1), cell[1] + ((c >> 1) & 1), cell[2] + (c >> 2));
    return true;
  }

  void locate_listed(const LatticeOctave& o, const Patch& patch, const Imath::V3d& x,
                     Local& local) const {
    int cell[3];
    for (int a = 0; a < 3; ++a) {
      local.t[a] = o.coordinate(x, a) - static_cast<double>(patch.first[a]);
      cell[a] = 0;
      if (patch.cells[a] == 1) continue;
      cell[a] = std::clamp(static_cast<int>(local.t[a]), 0, patch.cells[a] - 1);
      local.t[a] -= cell[a];
    }
    const int dy = patch.cells[0] + 1, dz = dy * (patch.cells[1] + 1);
    const std::uint8_t* at =
        directions_.data() + patch.start + (cell[0] + dy * cell[1] + dz * cell[2]);
    for (int c = 0; c < 8; ++c)
      local.direction[c] = at[(c & 1) + ((c >> 1) & 1) * dy + (c >> 2) * dz];
  }

  std::shared_ptr<const std::vector<LatticeOctave>> octaves_;
  std::vector<Patch> patches_;            // one for each octave
  std::vector<std::uint8_t> directions_;  // of all patches
};

}  // namespace

std::unique_ptr<Expression> make_perlin(const PerlinParameters& parameters) {
  for (const Octave& o : parameters.octaves)
    if (!(o.frequency > 0.0) || !std::isfinite(o.frequency) || !std::isfinite(o.amplitude))
      throw std::invalid_argument("an octave's frequency must be positive, its amplitude finite");
  return std::make_unique<Perlin>(parameters);
}

}  // namespace morsel::geom
