// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/morse_complex.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "topology/morse/perturbed_field.h"
#include "topology/morse/segment.h"
#include "topology/morse/separatrix.h"
#include "topology/morse/subdivision.h"

namespace morsel::topology {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::uint64_t MorseComplex::count(CriticalType type) const {
  return static_cast<std::uint64_t>(std::count_if(
      points.begin(), points.end(), [type](const CriticalPoint& p) { return p.type == type; }));
}

MorseComplex morse_complex(const ScalarField& field, const MorseOptions& options,
                           const Execution& execution) {
  if (!(options.perturbation >= 0.0) || !std::isfinite(options.perturbation))
    throw std::invalid_argument("a perturbation must be finite and not negative");
  if (options.perturbation > 0.0) {
    MorseOptions plain = options;
    plain.perturbation = 0.0;
    MorseComplex complex =
        morse_complex(perturbed(field, options.box, options.perturbation), plain, execution);
    complex.perturbation = options.perturbation;
    return complex;
  }
  MorseComplex complex;
  complex.box = options.box;
  auto start = std::chrono::steady_clock::now();
  SubdivisionOptions subdivision;
  subdivision.box = options.box;
  subdivision.max_depth = options.max_depth;
  CriticalPoints found = find_critical_points(field, subdivision, execution);
  complex.points = std::move(found.points);
  std::stable_sort(
      complex.points.begin(), complex.points.end(),
      [](const CriticalPoint& a, const CriticalPoint& b) { return a.value > b.value; });
  complex.unresolved_boxes = found.unresolved;
  complex.places = std::move(found.places);
  complex.boxes = found.boxes;
  complex.models = found.models;
  complex.seconds_points = seconds_since(start);

  start = std::chrono::steady_clock::now();
  if (execution.progress) execution.progress(0.0, "separatrices");
  find_basins(field, complex);
  std::vector<std::uint32_t> ends;
  trace_separatrices(field, complex, options.paths, ends, execution);
  segment(complex, ends);
  complex.seconds_separatrices = seconds_since(start);
  return complex;
}

}  // namespace morsel::topology
