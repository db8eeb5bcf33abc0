// SPDX-License-Identifier: Apache-2.0
// The search for critical points of equation (13):
//   - the subdivision with 1 thread and with 2;
//   - with seeds from the noise's impulses and without;
//   - the paper's tests (8) and (9) on boxes down to 1/512 of the search box, with bounds from
//   local
//     models and from plain interval arithmetic: boxes and time.
//   bench_morse [LAYERS [SEED [HALF]]]    HALF: half the side of the box that is searched
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cstdlib>
#include <functional>

#include "hypertexture_geom/field/impulse_list.h"
#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "tests/hypertexture_geom/test_fields.h"
#include "topology/morse/subdivision.h"

namespace {

using namespace morsel;
using topology::Box;
using topology::Interval;

constexpr int kRounds = 3;

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// All impulses of equation (13) that reach the box.
std::vector<geom::Impulse> impulses_of(int layers, std::uint32_t seed, const Box& box) {
  std::vector<geom::Impulse> all;
  const auto octaves = geom::fbm_octaves(0.8, 3.0, layers, 2.0, 0.8);
  for (std::uint32_t o = 0; o < octaves.size(); ++o) {
    const double f = octaves[o].frequency;
    std::int64_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = static_cast<std::int64_t>(std::floor(box.min[a] * f)) - 1;
      hi[a] = static_cast<std::int64_t>(std::floor(box.max[a] * f)) + 1;
    }
    for (std::int64_t i = lo[0]; i <= hi[0]; ++i)
      for (std::int64_t j = lo[1]; j <= hi[1]; ++j)
        for (std::int64_t k = lo[2]; k <= hi[2]; ++k)
          for (std::uint32_t n = 0; n < 3; ++n) {
            const geom::CellImpulse c = geom::cell_impulse(i, j, k, n, o, seed);
            const Imath::V3d cell(static_cast<double>(i), static_cast<double>(j),
                                  static_cast<double>(k));
            all.push_back(
                {(cell + Imath::V3d(c.x, c.y, c.z)) / f, f * f, octaves[o].amplitude * c.weight});
          }
  }
  return all;
}

// F and grad F of equation (13) on a box by interval arithmetic, term by term.
struct PlainBounds {
  Interval value;
  Interval gradient[3];
};
PlainBounds plain_bounds(const std::vector<geom::Impulse>& impulses, const Box& box) {
  PlainBounds b;
  Interval x[3], square = Interval::point(1e-4);  // the sphere's smoothing, squared
  for (int a = 0; a < 3; ++a) {
    x[a] = {box.min[a], box.max[a]};
    square = square + topology::square(x[a]);
  }
  const Interval r = topology::sqrt(square);
  b.value = Interval::point(1.0) - r;
  for (int a = 0; a < 3; ++a) b.gradient[a] = -(x[a] / r);
  for (const geom::Impulse& p : impulses) {
    const Interval s = Interval::point(p.inverse_square), w = Interval::point(p.weight);
    Interval d[3], q = Interval::point(1.0);
    for (int a = 0; a < 3; ++a) {
      d[a] = x[a] - Interval::point(p.centre[a]);
      q = q - s * topology::square(d[a]);
    }
    if (q.hi <= 0.0) continue;
    q.lo = std::max(q.lo, 0.0);
    const Interval q2 = topology::square(q);
    b.value = b.value + w * (q2 * q);
    for (int a = 0; a < 3; ++a)
      b.gradient[a] = b.gradient[a] + Interval::point(-6.0) * w * s * q2 * d[a];
  }
  return b;
}

bool reaches(const geom::Impulse& p, const Box& box) {
  double square = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double away = std::max({box.min[a] - p.centre[a], p.centre[a] - box.max[a], 0.0});
    square += away * away;
  }
  return square * p.inverse_square <= 1.0 + 1e-9;
}

bool discarded(const Interval& value, const Interval* gradient) {
  if (value.hi < 0.0) return true;
  for (int a = 0; a < 3; ++a)
    if (!gradient[a].contains(0.0)) return true;
  return false;
}

struct Tally {
  std::uint64_t boxes = 0, left = 0;
};

void by_models(const topology::ScalarField& field, const Box& box, int depth, Tally& tally) {
  ++tally.boxes;
  const topology::LocalModel m = field.model(box);
  const Interval g[3] = {m.gradient_range(0), m.gradient_range(1), m.gradient_range(2)};
  if (discarded(m.range(), g)) return;
  if (depth == 0) {
    ++tally.left;
    return;
  }
  const auto local = field.restricted_to(box);
  for (int i = 0; i < 8; ++i) by_models(*local, topology::child_box(box, i), depth - 1, tally);
}

void by_intervals(const std::vector<geom::Impulse>& impulses, const Box& box, int depth,
                  Tally& tally) {
  ++tally.boxes;
  const PlainBounds b = plain_bounds(impulses, box);
  if (discarded(b.value, b.gradient)) return;
  if (depth == 0) {
    ++tally.left;
    return;
  }
  for (int i = 0; i < 8; ++i) {
    const Box child = topology::child_box(box, i);
    std::vector<geom::Impulse> near;
    for (const geom::Impulse& p : impulses)
      if (reaches(p, child)) near.push_back(p);
    by_intervals(near, child, depth - 1, tally);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int layers = argc > 1 ? std::atoi(argv[1]) : 1, seed = argc > 2 ? std::atoi(argv[2]) : 1;
  const double half = argc > 3 ? std::atof(argv[3]) : 2.9;
  const auto field = geom::testing::field_of(geom::testing::eq13_json(layers, seed));
  topology::SubdivisionOptions plain;
  plain.box = Box(Imath::V3d(-half), Imath::V3d(half));
  topology::SubdivisionOptions seeded = plain;
  const auto impulses = impulses_of(layers, static_cast<std::uint32_t>(seed), plain.box);
  for (const geom::Impulse& p : impulses)
    if (field->value(p.centre) > -0.2) seeded.seeds.push_back(p.centre);
  fmt::print("equation (13), {} layers, seed {}, box of half side {}; {} seeds\n", layers, seed,
             half, seeded.seeds.size());
  // The searches in turn, and the best of each: what else the machine does meets all of them.
  struct Search {
    const char* name;
    int threads;
    const topology::SubdivisionOptions& options;
    topology::CriticalPoints found = {};
    double best = 1e300;
  } searches[] = {{"subdivision, 1 thread", 1, plain},
                  {"subdivision, 2 threads", 2, plain},
                  {"relaxation and subdivision, 1 thread", 1, seeded}};
  for (int round = 0; round < kRounds; ++round)
    for (Search& s : searches) {
      tbb::task_arena arena(s.threads);
      s.best = std::min(
          s.best, seconds([&] {
            arena.execute([&] { s.found = topology::find_critical_points(*field, s.options); });
          }));
    }
  for (const Search& s : searches)
    fmt::print("{:<38} {:8} boxes {:8} models {:6} points ({} from seeds) {:8.3f} s\n", s.name,
               s.found.boxes, s.found.models, s.found.points.size(), s.found.from_seeds, s.best);
  fmt::print("2 threads against 1: {:.2f}\n", searches[0].best / searches[1].best);
  fmt::print("with seeds against without: {:.2f} x time, {:.2f} x models\n",
             searches[2].best / searches[0].best,
             static_cast<double>(searches[2].found.models) /
                 static_cast<double>(searches[0].found.models));

  constexpr int kDepth = 9;
  Tally models, intervals;
  const double t_models = seconds([&] { by_models(*field, plain.box, kDepth, models); });
  const double t_intervals = seconds([&] { by_intervals(impulses, plain.box, kDepth, intervals); });
  fmt::print("tests (8) and (9) to 1/512, local models {:12} boxes {:9} left {:9.3f} s\n",
             models.boxes, models.left, t_models);
  fmt::print("tests (8) and (9) to 1/512, intervals    {:12} boxes {:9} left {:9.3f} s\n",
             intervals.boxes, intervals.left, t_intervals);
  fmt::print("intervals against local models: {:.1f} x boxes, {:.1f} x time\n",
             static_cast<double>(intervals.boxes) / static_cast<double>(models.boxes),
             t_intervals / t_models);
}
