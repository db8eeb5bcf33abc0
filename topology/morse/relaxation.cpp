// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/relaxation.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace morsel::topology {
namespace {

constexpr int kRelaxationSteps = 12;
constexpr int kNewtonSteps = 12;
// Seeds see the field within this part of the box's longest side.
constexpr double kReach = 1.0 / 32.0;

double longest_side(const Box& box) {
  const Imath::V3d size = box.max - box.min;
  return std::max({size.x, size.y, size.z});
}

Box around(const Imath::V3d& x, double half) {
  return {x - Imath::V3d(half), x + Imath::V3d(half)};
}

// Levenberg and Marquardt's damped steps for grad F = 0: downhill in |grad F|, whatever the signs
// of the eigenvalues, so that seeds reach saddles as well as maxima.
Imath::V3d relax(const ScalarField& field, Imath::V3d x, const Box& bounds) {
  Jet jet = field.jet(x);
  double damping = 0.1;
  for (int step = 0; step < kRelaxationSteps; ++step) {
    const double* h = jet.hessian;
    Eigen::Matrix3d m;
    m << h[0], h[3], h[4], h[3], h[1], h[5], h[4], h[5], h[2];
    const Eigen::Vector3d g(jet.gradient.x, jet.gradient.y, jet.gradient.z);
    Eigen::Matrix3d normal = m.transpose() * m;
    normal.diagonal().array() += damping * normal.trace() / 3.0 + 1e-300;
    const Eigen::Vector3d s = normal.ldlt().solve(-m.transpose() * g);
    if (!s.allFinite()) break;
    const Imath::V3d next = x + Imath::V3d(s[0], s[1], s[2]);
    if (!bounds.intersects(next)) {
      damping = 10.0 * damping + 1.0;
      continue;
    }
    const Jet there = field.jet(next);
    if (there.gradient.length2() < jet.gradient.length2()) {
      x = next;
      jet = there;
      damping *= 0.2;
    } else {
      damping *= 8.0;
    }
  }
  return x;
}

// The zero at x in the largest box about it, of a doubling sequence, that is proved to hold no
// other.
std::optional<CertifiedZero> certify_zero(const ScalarField& field, const Imath::V3d& x,
                                          double reach, std::uint64_t& models) {
  std::optional<Box> unique;
  Box start;
  for (double half = 1e-9 * reach; half < 0.5 * reach; half *= 2.0) {
    models += 2;
    const Box box = around(x, half);
    const Krawczyk k = krawczyk_on(field, box);
    if (k.zeros != ZeroCount::kOne) {
      if (unique) break;
      continue;
    }
    if (!unique) start = k.enclosure;
    unique = box;
  }
  if (!unique) return std::nullopt;
  return refine_zero(field, *unique, start, models);
}

}  // namespace

std::vector<CertifiedZero> relax_seeds(const ScalarField& field, const Box& box,
                                       const std::vector<Imath::V3d>& seeds,
                                       std::uint64_t& models) {
  const double reach = kReach * longest_side(box);
  std::vector<std::optional<Imath::V3d>> ends(seeds.size());
  tbb::parallel_for(std::size_t{0}, seeds.size(), [&](std::size_t i) {
    if (!Eigen::Vector3d(seeds[i].x, seeds[i].y, seeds[i].z).allFinite() ||
        !box.intersects(seeds[i]))
      return;
    const Box bounds = around(seeds[i], reach);
    const auto local = field.restricted_to(bounds);
    const auto end = newton(*local, relax(*local, seeds[i], bounds), bounds, kNewtonSteps);
    if (end && box.intersects(*end) && local->value(*end) > 0.0) ends[i] = end;
  });
  // Many seeds end at one point: sorted, those are neighbours to within rounding.
  std::vector<Imath::V3d> places;
  for (const auto& end : ends)
    if (end) places.push_back(*end);
  const double same = 1e-8 * reach;
  std::sort(places.begin(), places.end(), [](const Imath::V3d& a, const Imath::V3d& b) {
    return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z < b.z)));
  });
  std::vector<Imath::V3d> distinct;
  for (const Imath::V3d& x : places) {
    bool known = false;
    for (std::size_t j = distinct.size(); j > 0 && x.x - distinct[j - 1].x <= same && !known; --j)
      known = (x - distinct[j - 1]).length() <= same;
    if (!known) distinct.push_back(x);
  }
  std::vector<std::optional<CertifiedZero>> found(distinct.size());
  std::vector<std::uint64_t> counts(distinct.size(), 0);
  tbb::parallel_for(std::size_t{0}, distinct.size(), [&](std::size_t i) {
    const auto local = field.restricted_to(around(distinct[i], reach));
    auto zero = certify_zero(*local, distinct[i], reach, counts[i]);
    ++counts[i];
    if (zero && zero->enclosure.intersects(box) &&
        sign_on(*local, zero->enclosure) == Sign::kPositive)
      found[i] = zero;
  });
  std::vector<CertifiedZero> zeros;
  for (std::size_t i = 0; i < found.size(); ++i) {
    models += counts[i];
    if (found[i]) zeros.push_back(*found[i]);
  }
  return zeros;
}

}  // namespace morsel::topology
