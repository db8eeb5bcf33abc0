// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/subdivision.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>

#include "topology/morse/relaxation.h"
#include "topology/morse/zero.h"

namespace morsel::topology {
namespace {

constexpr int kTaskDepth = 4;          // boxes above this depth are tasks of their own
constexpr std::size_t kListed = 1000;  // undecided places kept in the result
// The operator's box is this much larger than the box that is tested, so that a zero on a wall is
// well inside; fields are restricted to a little more, so that rounding cannot step out.
constexpr double kInflation = 1.0625;
constexpr double kRestriction = 1.125;

Box inflated(const Box& box, double factor) {
  const Imath::V3d c = centre(box), h = half_size(box) * factor;
  return {c - h, c + h};
}

bool within(const Box& inner, const Box& outer) {
  return outer.intersects(inner.min) && outer.intersects(inner.max);
}

using Zeros = std::vector<CertifiedZero>;

// What one subtree of the subdivision found.
struct Harvest {
  Zeros zeros;
  std::vector<Unresolved> places;
  std::uint64_t boxes = 0, models = 0;

  void append(Harvest&& other) {
    zeros.insert(zeros.end(), other.zeros.begin(), other.zeros.end());
    const std::size_t room = kListed - std::min(kListed, places.size());
    places.insert(
        places.end(), other.places.begin(),
        other.places.begin() + static_cast<std::ptrdiff_t>(std::min(room, other.places.size())));
    boxes += other.boxes;
    models += other.models;
  }
};

class Subdivision {
 public:
  Subdivision(const SubdivisionOptions& options, const Execution& execution)
      : options_(options), execution_(execution) {}

  Harvest run(const ScalarField& field, const Zeros& known) {
    std::vector<const CertifiedZero*> all;
    for (const CertifiedZero& zero : known) all.push_back(&zero);
    return visit(field, options_.box, 0, all);
  }

  std::uint64_t unresolved() const { return unresolved_; }

 private:
  using Known = std::vector<const CertifiedZero*>;

  // Whether a box may hold a zero that is not yet known; if so it is to be split, unless the
  // operator settles it.
  bool undecided(const ScalarField& field, const Box& box, const Known& known, Harvest& harvest) {
    ++harvest.boxes;
    for (const CertifiedZero* zero : known)
      if (within(box, zero->unique)) return false;
    ++harvest.models;
    const LocalModel model = field.model(box);
    if (model.range().hi < 0.0) return false;
    for (int axis = 0; axis < 3; ++axis)
      if (!model.gradient_range(axis).contains(0.0)) return false;
    if (excludes_zero(model)) return false;
    const Box larger = inflated(box, kInflation);
    if (!promising(model)) return true;
    harvest.models += 2;
    const Krawczyk k = krawczyk_on(field, larger);
    if (k.zeros == ZeroCount::kUnknown) return true;
    if (k.zeros == ZeroCount::kNone) return false;
    const CertifiedZero zero = refine_zero(field, larger, k.enclosure, harvest.models);
    // In the margin only: the neighbour that holds it finds it.
    if (!zero.enclosure.intersects(box)) return false;
    ++harvest.models;
    const Sign sign = sign_on(field, zero.enclosure);
    if (sign == Sign::kPositive) harvest.zeros.push_back(zero);
    if (sign == Sign::kUncertain) report(zero.enclosure, zero.point.value, harvest);
    return false;
  }

  // Whether the operator has a chance, as the model at hand tells: it contracts only where the
  // Hessian changes by less than its own size over the box. Asked as if the zero were the centre.
  static bool promising(const LocalModel& model) {
    return krawczyk(model, {}).zeros == ZeroCount::kOne;
  }

  void report(const Box& box, double value, Harvest& harvest) {
    if (harvest.places.size() < kListed) harvest.places.push_back({box, value});
    if (++unresolved_ > options_.max_unresolved) {
      const Imath::V3d c = centre(box);
      throw NotIsolated(fmt::format(
          "critical points are not isolated near ({:.6g}, {:.6g}, {:.6g}): more than {} boxes are "
          "undecided there; add a small linear term to the field (a perturbation), or use the "
          "certified engine, which needs no critical points",
          c.x, c.y, c.z, options_.max_unresolved));
    }
  }

  Harvest visit(const ScalarField& field, const Box& box, int depth, const Known& known) {
    Harvest harvest;
    descend(field, box, depth, known, harvest);
    return harvest;
  }

  void descend(const ScalarField& field, const Box& box, int depth, const Known& known,
               Harvest& harvest) {
    execution_.check_cancel();
    const double volume = std::ldexp(1.0, -3 * depth);
    if (!undecided(field, box, known, harvest)) {
      if (depth <= kTaskDepth) progress(volume);
      return;
    }
    if (depth == options_.max_depth) {
      report(box, field.value(centre(box)), harvest);
      return;
    }
    const Box larger = inflated(box, kRestriction);
    const std::unique_ptr<ScalarField> local = field.restricted_to(larger);
    Known near;
    for (const CertifiedZero* zero : known)
      if (zero->unique.intersects(box)) near.push_back(zero);
    if (depth < kTaskDepth) {
      std::array<Harvest, 8> parts;
      tbb::parallel_for(
          0, 8, [&](int i) { parts[i] = visit(*local, child_box(box, i), depth + 1, near); });
      for (Harvest& part : parts) harvest.append(std::move(part));
    } else {
      for (int i = 0; i < 8; ++i) descend(*local, child_box(box, i), depth + 1, near, harvest);
      if (depth == kTaskDepth) progress(volume);
    }
  }

  void progress(double volume) {
    if (!execution_.progress) return;
    const std::lock_guard lock(mutex_);
    done_ += volume;
    execution_.progress(done_, "critical points");
  }

  const SubdivisionOptions& options_;
  const Execution& execution_;
  std::atomic<std::uint64_t> unresolved_{0};
  std::mutex mutex_;
  double done_ = 0.0;
};

// Keeps one of those zeros that are the same: their enclosures meet, and one lies where the other
// is alone. Enclosures that meet without such a proof are handed to `doubtful`.
template <class Doubtful>
void unite_duplicates(Zeros& zeros, Doubtful doubtful) {
  std::vector<std::uint32_t> order(zeros.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double x = zeros[a].enclosure.min.x, y = zeros[b].enclosure.min.x;
    return x < y || (x == y && a < b);
  });
  double widest = 0.0;
  for (const CertifiedZero& z : zeros)
    widest = std::max(widest, z.enclosure.max.x - z.enclosure.min.x);
  std::vector<bool> dropped(zeros.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (dropped[order[i]]) continue;
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::uint32_t a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      const CertifiedZero &first = zeros[order[i]], &second = zeros[order[j]];
      if (second.enclosure.min.x > first.enclosure.min.x + widest) break;
      if (dropped[order[j]] || !first.enclosure.intersects(second.enclosure)) continue;
      if (within(zeros[a].enclosure, zeros[b].unique) ||
          within(zeros[b].enclosure, zeros[a].unique)) {
        dropped[b] = true;
        if (b == order[i]) break;
      } else {
        doubtful(zeros[b]);
      }
    }
  }
  Zeros kept;
  for (std::size_t i = 0; i < zeros.size(); ++i)
    if (!dropped[i]) kept.push_back(zeros[i]);
  zeros = std::move(kept);
}

}  // namespace

std::uint64_t CriticalPoints::count(CriticalType type) const {
  return static_cast<std::uint64_t>(std::count_if(
      points.begin(), points.end(), [type](const CriticalPoint& p) { return p.type == type; }));
}

CriticalPoints find_critical_points(const ScalarField& field, const SubdivisionOptions& options,
                                    const Execution& execution) {
  if (options.max_depth < 0 || options.max_depth > 40)
    throw std::invalid_argument("the depth of the subdivision must lie in 0 ... 40");
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::isfinite(options.box.min[axis]) && std::isfinite(options.box.max[axis]) &&
          options.box.min[axis] < options.box.max[axis]))
      throw std::invalid_argument(
          "the box to search must be finite and have extent along every axis");
  CriticalPoints result;
  Zeros known;
  if (!options.seeds.empty()) known = relax_seeds(field, options.box, options.seeds, result.models);
  result.from_seeds = known.size();
  Subdivision subdivision(options, execution);
  Harvest harvest = subdivision.run(field, known);
  Zeros zeros = std::move(known);
  zeros.insert(zeros.end(), harvest.zeros.begin(), harvest.zeros.end());
  result.unresolved = subdivision.unresolved();
  unite_duplicates(zeros, [&](const CertifiedZero& zero) {
    ++result.unresolved;
    harvest.places.push_back({zero.enclosure, zero.point.value});
  });
  for (const CertifiedZero& zero : zeros) result.points.push_back(zero.point);
  result.places = std::move(harvest.places);
  result.boxes = harvest.boxes;
  result.models += harvest.models;
  return result;
}

}  // namespace morsel::topology
