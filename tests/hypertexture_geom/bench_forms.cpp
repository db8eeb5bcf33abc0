// SPDX-License-Identifier: Apache-2.0
// Kernels and forms of local models for sparse convolution against one another, on equation (13):
// how tight bounds are, how many boxes a subdivision needs with them, and how long it takes.
//   bench_forms [LAYERS [BOXES]]       (1, 200)
// Tightness: (width of the bound) / (sampled range) on boxes that meet the surface, of sides 1/10,
// 1/5 and 2/5 of the finest kernel's radius: median and 95 %, of the value and of the gradient's
// components. Subdivision: boxes until F or one of its slopes keeps its sign on each, down to a
// depth at which boxes are left undecided; with the alternatives' own bounds, without the
// vectorised evaluation that the library has for its form, so that all are timed alike.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <random>

#include "hypertexture_geom/field/density_sphere.h"
#include "hypertexture_geom/field/impulse_model.h"
#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/model_algebra.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "tests/hypertexture_geom/model_forms.h"

namespace {

using namespace morsel;
using geom::Impulse;
using geom::ImpulseList;
using geom::testing::Border;
using geom::testing::Bounds;
using topology::Box;
using topology::Interval;
using topology::LocalModel;

constexpr double kHalf = 2.5;  // of the box that is subdivided
constexpr int kDepth = 9;
constexpr std::uint32_t kSeed = 1;

// The field of equation (13) with kernels max(0, 1 - (r / R)^2)^power, R being `radius` cells, and
// the standard deviation of the field as it is.
struct Rock {
  Rock(int layers, int kernel_power, double radius) : power(kernel_power) {
    // 1 / 2 B(3 / 2, 2 power + 1) is the integral of kernel^2 r^2 for R = 1.
    const double deviation = std::sqrt(std::beta(1.5, 2.0 * power + 1.0) / std::beta(1.5, 7.0) *
                                       radius * radius * radius);
    const auto octaves = geom::fbm_octaves(0.8, 3.0, layers, 2.0, 0.8);
    for (std::uint32_t n = 0; n < octaves.size(); ++n) {
      const double f = octaves[n].frequency;
      const auto far = static_cast<std::int64_t>(std::ceil(kHalf * f + radius));
      for (std::int64_t i = -far; i < far; ++i)
        for (std::int64_t j = -far; j < far; ++j)
          for (std::int64_t k = -far; k < far; ++k)
            for (std::uint32_t m = 0; m < 3; ++m) {
              const geom::CellImpulse c = geom::cell_impulse(i, j, k, m, n, kSeed);
              impulses.push_back(
                  {Imath::V3d(static_cast<double>(i) + c.x, static_cast<double>(j) + c.y,
                              static_cast<double>(k) + c.z) /
                       f,
                   f * f / (radius * radius), octaves[n].amplitude * c.weight / deviation});
            }
      finest_radius = radius / f;
    }
  }

  int power;
  double finest_radius = 0.0;
  ImpulseList impulses;
  std::unique_ptr<geom::Expression> sphere = geom::make_sphere(Imath::V3d(0.0), 1.0, 0.01);
};

ImpulseList reaching(const ImpulseList& all, const Box& box) {
  const Imath::V3d centre = topology::centre(box), half = topology::half_size(box);
  ImpulseList near;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (geom::reaches(all[n], centre, half)) near.push_back(all[n]);
  return near;
}

// Bounds of the field on a box, given the impulses that reach it.
using Form = std::function<Bounds(const Rock&, const ImpulseList&, const Box&)>;

LocalModel library_model(const Rock& rock, const ImpulseList& list, const Box& box) {
  geom::RadialSum sum(box);
  geom::add_terms(list, sum);
  return geom::add(rock.sphere->model(box), sum.finish());
}

LocalModel own_model(const Rock& rock, const ImpulseList& list, const Box& box, Border border) {
  return geom::add(rock.sphere->model(box),
                   geom::testing::radial_model(list, box, rock.power, border));
}

geom::testing::Sextic sextic(const Rock& rock, const ImpulseList& list, const Box& box) {
  const LocalModel sphere = rock.sphere->model(box);
  geom::testing::Sextic s(sphere.centre, sphere.half);
  s.add(sphere);
  for (std::size_t n = 0; n < list.size(); ++n) s.add(list[n], Border::kFit);
  return s;
}

// Whether some impulse's border crosses the box.
bool has_border(const ImpulseList& list, const Box& box) {
  for (std::size_t n = 0; n < list.size(); ++n) {
    const Impulse p = list[n];
    double farthest = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double d = std::max(box.max[a] - p.centre[a], p.centre[a] - box.min[a]);
      farthest += d * d;
    }
    if (p.inverse_square * farthest > 1.0) return true;
  }
  return false;
}

// The eight parts of a box that a border crosses, each with a model of its own.
Bounds in_octants(const Rock& rock, const ImpulseList& list, const Box& box) {
  if (!has_border(list, box))
    return geom::testing::as_built(own_model(rock, list, box, Border::kFit));
  const Imath::V3d middle = topology::centre(box);
  Bounds all;
  for (int n = 0; n < 8; ++n) {
    Box part = box;
    for (int a = 0; a < 3; ++a) ((n >> a) & 1 ? part.min : part.max)[a] = middle[a];
    const Bounds b =
        geom::testing::as_built(own_model(rock, reaching(list, part), part, Border::kNearest));
    all.value = n == 0 ? b.value : topology::hull(all.value, b.value);
    for (int a = 0; a < 3; ++a)
      all.slope[a] = n == 0 ? b.slope[a] : topology::hull(all.slope[a], b.slope[a]);
  }
  return all;
}

std::string median_and_95(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return fmt::format("{:6.3f} {:6.3f}", v[v.size() / 2], v[v.size() * 95 / 100]);
}

std::string tightness(const Rock& rock, const Form& form, double side, int boxes) {
  constexpr int kSteps = 12;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> value, slope;
  const auto ratio = [](Interval bound, Interval seen) {
    return bound.width() / std::max(seen.width(), 1e-300);
  };
  while (static_cast<int>(value.size()) < boxes) {
    const Imath::V3d c(1.9 * unit(random), 1.9 * unit(random), 1.9 * unit(random));
    const Box box(c - Imath::V3d(0.5 * side), c + Imath::V3d(0.5 * side));
    const ImpulseList list = reaching(rock.impulses, box);
    const auto jet = [&](const Imath::V3d& x) {
      topology::Jet j = rock.sphere->jet(x);
      for (std::size_t n = 0; n < list.size(); ++n)
        geom::testing::add_impulse(list[n], rock.power, x, j.value, j.gradient);
      return j;
    };
    if (std::abs(jet(c).value) > 16.0 * side) continue;
    const double infinity = std::numeric_limits<double>::infinity();
    Interval seen{infinity, -infinity}, slopes[3] = {seen, seen, seen};
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; j <= kSteps; ++j)
        for (int k = 0; k <= kSteps; ++k) {
          const topology::Jet at = jet(box.min + Imath::V3d(i, j, k) * (side / kSteps));
          seen = topology::hull(seen, Interval::point(at.value));
          for (int a = 0; a < 3; ++a)
            slopes[a] = topology::hull(slopes[a], Interval::point(at.gradient[a]));
        }
    if (seen.lo > 0.0 || seen.hi < 0.0) continue;
    const Bounds b = form(rock, list, box);
    value.push_back(ratio(b.value, seen));
    for (int a = 0; a < 3; ++a) slope.push_back(ratio(b.slope[a], slopes[a]));
    if (!(b.value.lo <= seen.lo && b.value.hi >= seen.hi)) fmt::print("a bound is broken!\n");
  }
  return median_and_95(value) + "  " + median_and_95(slope);
}

struct Count {
  long boxes = 0, undecided = 0;
};

void subdivide(const Rock& rock, const Form& form, const ImpulseList& list, const Box& box,
               int depth, Count& count) {
  const ImpulseList near = reaching(list, box);
  ++count.boxes;
  const Bounds b = form(rock, near, box);
  const auto decided = [](Interval i) { return !(i.lo < 0.0 && i.hi > 0.0); };
  if (decided(b.value)) return;
  for (const Interval& slope : b.slope)
    if (decided(slope)) return;
  if (depth == kDepth) {
    ++count.undecided;
    return;
  }
  const Imath::V3d middle = topology::centre(box);
  for (int n = 0; n < 8; ++n) {
    Box part = box;
    for (int a = 0; a < 3; ++a) ((n >> a) & 1 ? part.min : part.max)[a] = middle[a];
    subdivide(rock, form, near, part, depth + 1, count);
  }
}

void report(const char* name, const Rock& rock, const Form& form, int boxes) {
  std::string text;
  for (const double part : {0.1, 0.2, 0.4})
    text += "  " + tightness(rock, form, part * rock.finest_radius, boxes);
  const std::clock_t start = std::clock();
  Count count;
  subdivide(rock, form, rock.impulses, Box(Imath::V3d(-kHalf), Imath::V3d(kHalf)), 0, count);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  fmt::print("{:34}{}  {:8} {:5} {:7.2f}\n", name, text, count.boxes, count.undecided, seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int layers = argc > 1 ? std::clamp(std::atoi(argv[1]), 1, 3) : 1;
  const int boxes = argc > 2 ? std::max(20, std::atoi(argv[2])) : 200;
  fmt::print(
      "equation (13), {} layers: bound / sampled range on {} boxes (value: median, 95 %; gradient: "
      "median, 95 %) at sides of 1/10, 1/5 and 2/5 of the finest radius; subdivision: boxes, "
      "undecided, seconds\n",
      layers, boxes);
  using namespace geom::testing;
  const Rock c2(layers, 3, 1.0);
  report(
      "as built", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) {
        return as_built(library_model(r, l, b));
      },
      boxes);
  fmt::print("ranges of the same polynomial\n");
  report(
      "  monomial by monomial", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) {
        return by_monomials(library_model(r, l, b));
      },
      boxes);
  report(
      "  Bernstein", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) {
        return by_bernstein(library_model(r, l, b));
      },
      boxes);
  fmt::print("what becomes of degrees 4 to 6 (general code, several times slower than need be)\n");
  report(
      "  Taylor: bounded by their sizes", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) {
        return as_built(sextic(r, l, b).truncated());
      },
      boxes);
  report(
      "  kept: Bernstein of degree 6", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) { return sextic(r, l, b).bernstein(); },
      boxes);
  fmt::print("impulses whose border crosses the box\n");
  report(
      "  cube or zero, no fit", c2,
      [](const Rock& r, const ImpulseList& l, const Box& b) {
        return as_built(own_model(r, l, b, Border::kNearest));
      },
      boxes);
  report("  cube or zero in eight parts", c2, in_octants, boxes);
  fmt::print("kernels (forms as built)\n");
  const auto fitted = [](const Rock& r, const ImpulseList& l, const Box& b) {
    return as_built(own_model(r, l, b, Border::kFit));
  };
  report("  C2, (1 - r^2)^3", c2, fitted, boxes);
  report("  C3, (1 - r^2)^4, same radius", Rock(layers, 4, 1.0), fitted, boxes);
  report("  C3, same curvature at its centre", Rock(layers, 4, std::sqrt(4.0 / 3.0)), fitted,
         boxes);
}
