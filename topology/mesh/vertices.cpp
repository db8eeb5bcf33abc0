// SPDX-License-Identifier: Apache-2.0
#include "topology/mesh/vertices.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

namespace morsel::topology::meshing {
namespace {

// What vertices may be off the surface in order to stay apart from corners and faces of a cell with
// the given side, and how near to the surface they are brought otherwise.
double clearance(double error, double side) { return std::min(0.05 * error, side / 64.0); }
double precision(double error, double side) { return 1e-3 * std::min(error, side); }

// A bound on |F| at a point of the cell: what the model of a box without extent leaves unknown is
// rounding.
double proved_residual(const CellSet& cells, std::uint32_t cell, const Imath::V3d& x) {
  const LocalModel model = cells.field(cell).model({x, x});
  return std::abs(model.c[monomial::k1]) + model.value_error + cells.level();
}

}  // namespace

Vertex vertex_on(const CellSet& cells, const Corners& corners, const CutEdge& edge) {
  const MeshCell& cell = cells[edge.cell];
  const ScalarField& field = cells.field(edge.cell);
  const int axis = edge.axis;
  const Imath::V3d low = cells.grid().point(cell.corner(edge.low_corner));
  const double a = low[axis];
  const double b = cells.grid().point(cell.corner(edge.high_corner()))[axis];
  const auto at = [&](double t) {
    Imath::V3d p = low;
    p[axis] = t;
    return p;
  };
  const auto value = [&](double t) { return field.value(at(t)); };
  double fa = corners.value(edge.cell, edge.low_corner);
  double fb = corners.value(edge.cell, edge.high_corner());
  double t;
  if (fa != 0.0 && fb != 0.0 && std::signbit(fa) != std::signbit(fb)) {
    const double width = precision(cells.error(), b - a);
    std::uintmax_t steps = 60;
    const auto [lo, hi] = boost::math::tools::toms748_solve(
        value, a, b, fa, fb, [&](double l, double h) { return std::abs(h - l) <= width; }, steps);
    t = 0.5 * (lo + hi);
  } else {  // an end is a root, or its sign was changed because it is as good as one
    t = std::abs(fa) <= std::abs(fb) ? a : b;
  }
  const double away = clearance(cells.error(), b - a);
  Vertex v;
  v.position = at(std::clamp(t, a + away, b - away));
  v.residual = proved_residual(cells, edge.cell, v.position);
  return v;
}

Vertex apex_in(const CellSet& cells, std::uint32_t cell, std::span<const Imath::V3d> boundary) {
  const ScalarField& field = cells.field(cell);
  const Box box = cells.grid().box(cells[cell]);
  const double side = shortest_side(box);
  const double away = clearance(cells.error(), side);
  const auto into_cell = [&](Imath::V3d p) {
    for (int i = 0; i < 3; ++i) p[i] = std::clamp(p[i], box.min[i] + away, box.max[i] - away);
    return p;
  };
  Imath::V3d mean(0.0);
  for (const Imath::V3d& p : boundary) mean += p;
  mean = into_cell(mean / static_cast<double>(boundary.size()));

  Vertex best{mean, std::abs(field.value(mean))};
  Imath::V3d at = mean;
  constexpr int kNewtonSteps = 4;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Jet jet = field.jet(at);
    const double square = jet.gradient.length2();
    const double enough = precision(cells.error(), side) * std::sqrt(square);
    if (!(square > 0.0) || std::abs(jet.value) <= enough) break;
    const Imath::V3d next = into_cell(at - jet.gradient * (jet.value / square));
    const double residual = std::abs(field.value(next));
    if (!(residual < best.residual)) break;
    best = {next, residual};
    at = next;
  }
  best.residual = proved_residual(cells, cell, best.position);
  return best;
}

}  // namespace morsel::topology::meshing
