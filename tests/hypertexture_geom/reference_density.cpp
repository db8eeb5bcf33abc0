// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>

#include "hypertexture_geom/field/formula.h"
#include "tests/hypertexture_geom/reference_dual.h"

namespace morsel::geom::testing {
namespace {

using nlohmann::json;

std::array<double, 3> vector_of(const json& j) {
  if (j.is_number()) return {j.get<double>(), j.get<double>(), j.get<double>()};
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}
Imath::V3d imath(const json& j) {
  const auto a = vector_of(j);
  return {a[0], a[1], a[2]};
}

Dual linear(const Point& x, const Imath::V3d& row, const Imath::V3d& origin) {
  Dual sum;
  for (int i = 0; i < 3; ++i)
    sum = sum + static_cast<Real>(row[i]) * (x[i] + -static_cast<Real>(origin[i]));
  return sum;
}

// A density given by a function, with its special places.
class Formula final : public ReferenceField {
 public:
  Formula(std::function<Dual(const Point&)> f, std::vector<Imath::V3d> places)
      : f_(std::move(f)), places_(std::move(places)) {}
  Dual at(const Point& x) const override { return f_(x); }
  void special_places(Places& places) const override {
    for (const Imath::V3d& p : places_) places.push_back({p.x, p.y, p.z});
  }

 private:
  std::function<Dual(const Point&)> f_;
  std::vector<Imath::V3d> places_;
};

Dual excess(const Point& x, const Imath::V3d& axis, const Imath::V3d& origin, Real half, Real k) {
  const Dual u = linear(x, axis, origin);
  return 0.5L * (smooth_absolute(u + -half, k) + smooth_absolute(u + half, k)) + (k - half);
}

Reference joined(const std::vector<Reference>& parts, std::size_t first, std::size_t last,
                 Real outward, Real k);

Reference join(Reference a, Reference b, Real other, Real outward, Real k) {
  Places places;
  a->special_places(places);
  b->special_places(places);
  std::vector<Imath::V3d> list;
  for (const auto& p : places) list.emplace_back(p[0], p[1], p[2]);
  return std::make_shared<Formula>(
      [=](const Point& x) {
        const Dual f = a->at(x), c = other * b->at(x);
        return 0.5L * (f + c + outward * (smooth_absolute(f - c, k) + k));
      },
      list);
}

Reference joined(const std::vector<Reference>& parts, std::size_t first, std::size_t last,
                 Real outward, Real k) {
  if (last - first == 1) return parts[first];
  const std::size_t middle = first + (last - first + 1) / 2;
  return join(joined(parts, first, middle, outward, k), joined(parts, middle, last, outward, k),
              1.0L, outward, k);
}

Reference metaballs(const json& d) {
  struct Ball {
    Imath::V3d centre;
    double inverse_square, weight;
  };
  std::vector<Ball> balls;
  std::vector<Imath::V3d> places;
  for (const json& b : d["balls"]) {
    const double r = b["radius"].get<double>();
    balls.push_back({imath(b["center"]), 1.0 / (r * r), b["weight"].get<double>()});
    places.push_back(imath(b["center"]));
    for (int axis = 0; axis < 3; ++axis) {  // the border of its support
      places.push_back(imath(b["center"]));
      places.back()[axis] += r;
    }
  }
  const Real level = d["level"].get<double>();
  return std::make_shared<Formula>(
      [=](const Point& x) {
        Dual sum;
        for (const Ball& b : balls) {
          Dual square;
          for (int i = 0; i < 3; ++i) square = square + squared(x[i] + -Real(b.centre[i]));
          const Dual q = -Real(b.inverse_square) * square + 1.0L;
          if (q.v > 0.0L) sum = sum + Real(b.weight) * (q * q * q);
        }
        return sum + -level;
      },
      places);
}

}  // namespace

Reference reference_density(const json& d) {
  const std::string type = d["type"];
  if (type == "metaballs") return metaballs(d);
  if (type == "union" || type == "intersection" || type == "difference") {
    std::vector<Reference> parts;
    for (const json& p : d["densities"]) parts.push_back(reference_density(p));
    const Real k = d["width"].get<double>();
    if (type != "difference") return joined(parts, 0, parts.size(), type == "union" ? 1 : -1, k);
    return join(parts[0], joined(parts, 1, parts.size(), 1.0L, k), -1.0L, -1.0L, k);
  }
  const double s = d["smoothing"].get<double>();
  const double square = s * s;
  if (type == "sphere") {
    const Imath::V3d c = imath(d["center"]);
    const Real radius = d["radius"].get<double>();
    return std::make_shared<Formula>(
        [=](const Point& x) {
          Dual sum;
          for (int i = 0; i < 3; ++i) sum = sum + squared(x[i] + -Real(c[i]));
          return -1.0L * root(sum + Real(square)) + radius;
        },
        std::vector{c});
  }
  if (type == "ellipsoid") {
    const Imath::V3d c = imath(d["center"]), radii = imath(d["radii"]);
    const double smallest = std::min({radii.x, radii.y, radii.z});
    return std::make_shared<Formula>(
        [=](const Point& x) {
          Dual sum;
          for (int i = 0; i < 3; ++i) {
            const double row = smallest / radii[i];
            sum = sum + squared(Real(row) * (x[i] + -Real(c[i])));
          }
          return -1.0L * root(sum + Real(square)) + Real(smallest);
        },
        std::vector{c});
  }
  if (type == "rounded_box") {
    const Imath::V3d c = imath(d["center"]), half = imath(d["half_size"]);
    const double rounding = d["rounding"].get<double>(), crown = d["crown"].get<double>();
    const Imath::V3d inner = half - Imath::V3d(rounding);
    const double norm = 1.0 / std::sqrt(1.0 + crown * crown);
    return std::make_shared<Formula>(
        [=](const Point& x) {
          Dual sum;
          sum.v = square;
          for (int i = 0; i < 3; ++i) {
            Imath::V3d axis(0.0);
            axis[i] = 1.0;
            const double row = crown * rounding / half[i];
            sum = sum + squared(Real(row) * (x[i] + -Real(c[i]))) +
                  squared(excess(x, axis, c, inner[i], s));
          }
          return Real(norm) * (-1.0L * root(sum) + Real(rounding));
        },
        std::vector{c, c + inner, c + half});
  }
  if (type == "torus") {
    const Imath::V3d c = imath(d["center"]), axis = imath(d["axis"]).normalized();
    const double major = d["major_radius"].get<double>(), minor = d["minor_radius"].get<double>();
    const Perpendiculars p = perpendiculars(axis);
    return std::make_shared<Formula>(
        [=](const Point& x) {
          const Dual rho =
              root(squared(linear(x, p.u, c)) + squared(linear(x, p.v, c)) + Real(square));
          const Dual tube =
              squared(rho + -Real(major)) + (squared(linear(x, axis, c)) + Real(square));
          return -1.0L * root(tube) + Real(minor);
        },
        std::vector{c, c + p.u * major});
  }
  if (type == "capsule") {
    const Imath::V3d a = imath(d["start"]), b = imath(d["end"]);
    const Imath::V3d axis = (b - a).normalized(), c = (a + b) * 0.5;
    const double half = (b - a).length() * 0.5, radius = d["radius"].get<double>();
    const double t = d["crown"].get<double>() * radius / (half + radius);
    const double norm = 1.0 / std::sqrt(1.0 + t * t);
    const Perpendiculars p = perpendiculars(axis);
    const Imath::V3d along = axis * t;
    return std::make_shared<Formula>(
        [=](const Point& x) {
          const Dual squares = squared(linear(x, p.u, c)) + squared(linear(x, p.v, c)) +
                               squared(linear(x, along, c)) + Real(square);
          const Dual distance = root(squared(excess(x, axis, c, half, s)) + squares);
          return Real(norm) * (-1.0L * distance + Real(radius));
        },
        std::vector{a, b, c});
  }
  if (type == "slab") {
    const Imath::V3d c = imath(d["center"]), axis = imath(d["axis"]).normalized();
    const double half = d["half_thickness"].get<double>();
    return std::make_shared<Formula>(
        [=](const Point& x) {
          return -1.0L * smooth_absolute(linear(x, axis, c), s) + Real(half - s);
        },
        std::vector{c});
  }
  throw std::logic_error("the reference knows no density " + type);
}

}  // namespace morsel::geom::testing
