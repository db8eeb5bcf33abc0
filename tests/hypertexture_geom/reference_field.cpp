// SPDX-License-Identifier: Apache-2.0
#include "tests/hypertexture_geom/reference_field.h"

#include <array>
#include <cmath>

#include "hypertexture_geom/field/impulse_process.h"
#include "hypertexture_geom/field/perlin_lattice.h"
#include "hypertexture_geom/field/sparse_convolution.h"
#include "tests/hypertexture_geom/reference_dual.h"

namespace morsel::geom::testing {
namespace {

using nlohmann::json;

// One octave of either noise with amplitude 1, as amplitude * n.
class Noise final : public ReferenceField {
 public:
  Noise(const json& m, const Octave& octave, std::uint32_t number)
      : perlin_(m["noise"] == "perlin"),
        octave_(octave),
        seed_(m["seed"].get<std::uint32_t>()),
        number_(number),
        impulses_(perlin_ ? 0 : m["impulses_per_cell"].get<int>()),
        lattice_(number, seed_) {}

  Dual at(const Point& x) const override { return perlin_ ? perlin(x) : sparse(x); }

  void special_places(Places& places) const override {
    for (int n = -2; n <= 2; ++n) {
      std::array<double, 3> p{};
      for (int a = 0; a < 3; ++a)
        p[static_cast<std::size_t>(a)] =
            (n + a - (perlin_ ? lattice_.offset()[a] : 0.0)) / octave_.frequency;
      places.push_back(p);
      if (perlin_) continue;
      const CellImpulse c = cell_impulse(n, 0, -n, 0, number_, seed_);
      places.push_back(
          {(n + c.x) / octave_.frequency, c.y / octave_.frequency, (-n + c.z) / octave_.frequency});
      places.push_back({(n + c.x + 1.0) / octave_.frequency, c.y / octave_.frequency,
                        (-n + c.z) / octave_.frequency});
      places.push_back({(n + c.x + 0.6) / octave_.frequency, (c.y - 0.8) / octave_.frequency,
                        (-n + c.z) / octave_.frequency});
    }
  }

 private:
  Dual sparse(const Point& x) const {
    const double f = octave_.frequency, s = f * f;
    std::int64_t cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(x[a].v * f));
    Dual sum;
    for (std::int64_t k = cell[2] - 1; k <= cell[2] + 1; ++k)
      for (std::int64_t j = cell[1] - 1; j <= cell[1] + 1; ++j)
        for (std::int64_t i = cell[0] - 1; i <= cell[0] + 1; ++i)
          for (int n = 0; n < impulses_; ++n) {
            const CellImpulse c =
                cell_impulse(i, j, k, static_cast<std::uint32_t>(n), number_, seed_);
            const double centre[3] = {(static_cast<double>(i) + c.x) / f,
                                      (static_cast<double>(j) + c.y) / f,
                                      (static_cast<double>(k) + c.z) / f};
            Real square = 0.0L;
            for (int a = 0; a < 3; ++a) square += (x[a].v - centre[a]) * (x[a].v - centre[a]);
            const Real q = 1.0L - s * square;
            if (q <= 0.0L) continue;
            sum.v += Real(c.weight) * q * q * q;
            const Real slope = -6.0L * c.weight * s * q * q;
            for (int a = 0; a < 3; ++a) {
              const Real g = slope * (x[a].v - centre[a]);
              for (int b = 0; b < 3; ++b) sum.g[b] += g * x[a].g[b];
            }
          }
    return Real(octave_.amplitude * std::sqrt(3.0 / impulses_)) * sum;
  }

  Dual perlin(const Point& x) const {
    Dual t[3], fade[3];
    std::int64_t cell[3];
    for (int a = 0; a < 3; ++a) {
      const Dual q = Real(octave_.frequency) * x[a] + Real(lattice_.offset()[a]);
      const Real corner = std::floor(q.v);
      cell[a] = static_cast<std::int64_t>(corner);
      t[a] = q + -corner;
      const Real v = t[a].v;
      fade[a] = chain(v * v * v * (10.0L + v * (-15.0L + 6.0L * v)),
                      30.0L * v * v * (1.0L - v) * (1.0L - v), t[a]);
    }
    Dual sum;
    for (int c = 0; c < 8; ++c) {
      const int e[3] = {c & 1, (c >> 1) & 1, c >> 2};
      const double* g =
          kPerlinDirection[lattice_.direction(cell[0] + e[0], cell[1] + e[1], cell[2] + e[2])];
      Dual dot, weight;
      weight.v = 1.0L;
      for (int a = 0; a < 3; ++a) {
        dot = dot + Real(g[a]) * (t[a] + -Real(e[a]));
        weight = weight * (e[a] ? fade[a] : -1.0L * fade[a] + 1.0L);
      }
      sum = sum + weight * dot;
    }
    return Real(octave_.amplitude) * sum;
  }

  bool perlin_;
  Octave octave_;
  std::uint32_t seed_, number_;
  int impulses_;
  PerlinLattice lattice_;
};

std::vector<Octave> octaves_of(const json& m) {
  return fbm_octaves(m["amplitude"].get<double>(), m["frequency"].get<double>(),
                     m["layers"].get<int>(), m["lacunarity"].get<double>(),
                     m["hurst"].get<double>());
}

class Mask {
 public:
  explicit Mask(const json& m) : given_(m.contains("mask")) {
    if (!given_) return;
    const json& mask = m["mask"];
    const double from = mask["from"].get<double>(), width = mask["to"].get<double>() - from;
    factor_ = 1.0 / width;
    offset_ = -from / width;
    if (mask["type"] == "density") {
      density_ = reference_density(mask["density"]);
    } else {
      axis_ = mask["axis"].get<std::string>()[0] - 'x';
      ends_ = {from, mask["to"].get<double>()};
    }
  }
  // mask(x) f(x), f not asked where the mask is 0.
  template <class F>
  Dual operator()(const Point& x, const F& f) const {
    if (!given_) return f();
    const Dual t = Real(factor_) * (density_ ? density_->at(x) : x[axis_]) + Real(offset_);
    if (t.v <= 0.0L) return Dual();
    if (t.v >= 1.0L) return f();
    const Real v = t.v;
    return chain(v * v * v * (10.0L + v * (-15.0L + 6.0L * v)),
                 30.0L * v * v * (1.0L - v) * (1.0L - v), t) *
           f();
  }
  void special_places(Places& places) const {
    if (density_) density_->special_places(places);
    if (!given_ || density_) return;
    for (const double end : ends_) {
      std::array<double, 3> p{0.1, -0.2, 0.3};
      p[static_cast<std::size_t>(axis_)] = end;
      places.push_back(p);
    }
  }

 private:
  bool given_;
  double factor_ = 1.0, offset_ = 0.0;
  int axis_ = 0;
  std::array<double, 2> ends_{};
  Reference density_;
};

class Modulation final : public ReferenceField {
 public:
  Modulation(const json& m, Reference previous)
      : type_(m["type"].get<std::string>()), m_(m), previous_(std::move(previous)), mask_(m) {
    if (m.contains("noise")) {
      const std::vector<Octave> octaves = octaves_of(m);
      const std::uint32_t streams = type_ == "warp" ? 3 : 1;
      for (std::uint32_t stream = 0; stream < streams; ++stream)
        for (std::size_t i = 0; i < octaves.size(); ++i) {
          Octave o = octaves[i];
          amplitudes_.push_back(o.amplitude);
          if (type_ == "turbulence" || type_ == "ridged") o.amplitude = 1.0;
          const std::uint32_t offset = type_ == "warp" ? (1 + stream) << 16 : 0;
          noises_.emplace_back(m, o, offset + static_cast<std::uint32_t>(i));
        }
      layers_ = octaves.size();
    }
  }

  Dual at(const Point& x) const override {
    if (type_ == "warp") {
      Dual y[3];
      for (std::size_t a = 0; a < 3; ++a)
        y[a] = x[a] + mask_(x, [&] { return octaves(x, a * layers_); });
      return previous_->at(y);
    }
    const Dual h = previous_->at(x);
    if (type_ == "fbm") return h + mask_(x, [&] { return octaves(x, 0); });
    if (type_ == "turbulence" || type_ == "ridged") return h + mask_(x, [&] { return folded(x); });
    if (type_ == "scale_offset")
      return Real(m_["scale"].get<double>()) * h + Real(m_["offset"].get<double>());
    return bent(h);
  }

  void special_places(Places& places) const override {
    previous_->special_places(places);
    mask_.special_places(places);
    for (const Noise& n : noises_) n.special_places(places);
  }

 private:
  Dual octaves(const Point& x, std::size_t first) const {
    Dual sum;
    for (std::size_t i = first; i < first + layers_; ++i) sum = sum + noises_[i].at(x);
    return sum;
  }

  Dual folded(const Point& x) const {
    const Real k = m_["smoothing"].get<double>();
    Dual sum;
    for (std::size_t i = 0; i < layers_; ++i) {
      const Dual crease = smooth_absolute(noises_[i].at(x), k);
      const Real amplitude = amplitudes_[i];
      if (type_ == "turbulence") {
        sum = sum + amplitude * crease;
        continue;
      }
      const Dual ridge = -1.0L * crease + Real(m_["offset"].get<double>());
      sum = sum + amplitude * (m_["squared"].get<bool>() ? ridge * ridge : ridge);
    }
    return sum;
  }

  // Bias and gain.
  Dual bent(const Dual& h) const {
    const double from = m_["from"].get<double>(), width = m_["to"].get<double>() - from;
    const double middle = from + 0.5 * width;
    const Dual u = h + -Real(middle);
    if (type_ == "bias") {
      const double b = m_["bias"].get<double>();
      const double e = std::min(1.0, 0.5 / std::sqrt(std::max(1e-12, std::abs(1.0 - 2.0 * b))));
      const double k = (e * e - 0.25) / (2.0 * e), c = 4.0 * e * (0.5 - b);
      const double constant = middle - c * width * 0.25 / e, bend = k * width;
      return u + Real(c) * smooth_absolute(u, bend) + Real(constant);
    }
    const double slope = -std::log2(1.0 - m_["gain"].get<double>());
    const double k = 0.5 / std::sqrt(slope * slope + 1.0), q = 1.0 / std::sqrt(0.25 + k * k);
    const double beta = (slope - 1.0) / (1.0 / k - q), alpha = 1.0 - beta * q;
    const double bend = k * width, sign = beta * width;
    const Real r = std::sqrt(u.v * u.v + Real(bend) * bend);
    return Real(alpha) * u + Real(sign) * chain(u.v / r, Real(bend) / r * (Real(bend) / r) / r, u) +
           Real(middle);
  }

  std::string type_;
  json m_;
  Reference previous_;
  Mask mask_;
  std::vector<Noise> noises_;
  std::vector<double> amplitudes_;
  std::size_t layers_ = 0;
};

}  // namespace

std::shared_ptr<const ReferenceField> reference_field(const json& canonical) {
  Reference field = reference_density(canonical["density"]);
  for (const json& m : canonical["modulations"]) field = std::make_shared<Modulation>(m, field);
  return field;
}

}  // namespace morsel::geom::testing
