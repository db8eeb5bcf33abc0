// SPDX-License-Identifier: Apache-2.0
// Evaluators of a field against one another, in one run: nanoseconds a point.
//   ninja bench_fields && bin/bench_fields            with the widest vectors of the machine
//   MORSEL_BENCH_TARGET=AVX2 bin/bench_fields         with no more than those of AVX2
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "hypertexture_geom/field/compiled_field.h"
#include "tests/hypertexture_geom/test_fields.h"

namespace morsel::geom {
namespace {

using topology::Box;

constexpr std::size_t kPoints = 1024;

std::shared_ptr<const Field> field(int perlin, int layers) {
  return testing::field_of(perlin ? testing::perlin_json(layers, 1)
                                  : testing::eq13_json(layers, 1));
}

// A box of a brick's size: a quarter of the finest kernel's radius.
Box brick(int layers) {
  const double side = 1.0 / (3.0 * std::ldexp(1.0, layers - 1)) / 4.0;
  const Imath::V3d corner(0.71, 0.43, 0.35);
  return Box(corner, corner + Imath::V3d(side));
}

const Box kEverywhere(Imath::V3d(-2.0), Imath::V3d(2.0));

template <class T>
struct Points {
  explicit Points(const Box& box) {
    std::mt19937_64 random(1);
    const Imath::V3d half = topology::half_size(box), centre = topology::centre(box);
    std::uniform_real_distribution<double> unit(-0.999999, 0.999999);
    for (std::size_t i = 0; i < kPoints; ++i)
      for (int a = 0; a < 3; ++a) x[a].push_back(static_cast<T>(unit(random) * half[a]));
    for (std::size_t i = 0; i < kPoints; ++i)
      absolute.push_back(centre + Imath::V3d(x[0][i], x[1][i], x[2][i]));
  }
  std::vector<T> x[3];
  std::vector<Imath::V3d> absolute;
};

// The field's own value or jet, a point at a time. Pruned: restricted to the box of the points,
// where sums of impulses are vectorised over impulses.
void scalar_double(benchmark::State& state, const topology::ScalarField& f, const Box& box,
                   bool jet) {
  const Points<double> points(box);
  for (auto _ : state)
    for (const Imath::V3d& x : points.absolute)
      if (jet)
        benchmark::DoNotOptimize(f.jet(x));
      else
        benchmark::DoNotOptimize(f.value(x));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kPoints));
}

enum class Mode { kBatch, kBatchGradient, kSingle, kSingleGradient };

template <class T>
void compiled(benchmark::State& state, const topology::ScalarField& f, const Box& box,
              const Box& points_in, Mode mode) {
  const CompiledField<T> c(f, box);
  const Points<T> points(points_in);
  std::vector<T> x[3], value(kPoints), gradient[3];
  const Imath::V3d shift = topology::centre(points_in) - c.centre();
  for (int a = 0; a < 3; ++a) {
    gradient[a].resize(kPoints);
    for (const T t : points.x[a]) x[a].push_back(t + static_cast<T>(shift[a]));
  }
  const T* const p[3] = {x[0].data(), x[1].data(), x[2].data()};
  T* const g[3] = {gradient[0].data(), gradient[1].data(), gradient[2].data()};
  for (auto _ : state) {
    switch (mode) {
      case Mode::kBatch:
        c.values(p, kPoints, value.data());
        break;
      case Mode::kBatchGradient:
        c.gradients(p, kPoints, value.data(), g);
        break;
      case Mode::kSingle:
        for (std::size_t i = 0; i < kPoints; ++i) value[i] = c.value({x[0][i], x[1][i], x[2][i]});
        break;
      case Mode::kSingleGradient:
        for (std::size_t i = 0; i < kPoints; ++i) {
          Imath::Vec3<T> slope;
          value[i] = c.value_and_gradient({x[0][i], x[1][i], x[2][i]}, slope);
          gradient[0][i] = slope.x;
        }
        break;
    }
    benchmark::DoNotOptimize(value.data());
    benchmark::DoNotOptimize(gradient[0].data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kPoints));
}

void build(benchmark::State& state, const topology::ScalarField& f, const Box& box) {
  for (auto _ : state) {
    const CompiledField<float> c(f, box);
    benchmark::DoNotOptimize(c.bytes());
  }
}

void register_all() {
  for (const int perlin : {0, 1})
    for (const int layers : {1, 3}) {
      const auto f = field(perlin, layers);
      const Box small = brick(layers);
      const std::shared_ptr<const topology::ScalarField> pruned = f->restricted_to(small);
      const std::string name =
          std::string(perlin ? "perlin" : "sparse") + "/L" + std::to_string(layers) + "/";
      const auto add = [&](const char* what, auto run) {
        benchmark::RegisterBenchmark((name + what).c_str(), run);
      };
      const auto at = [&](const char* what, const Box& box, const Box& points) {
        const std::string prefix = what;
        const auto each = [&](const char* how, Mode mode) {
          add((prefix + how + "/float").c_str(),
              [=](benchmark::State& s) { compiled<float>(s, *f, box, points, mode); });
          if (prefix == "pruned/")
            add((prefix + how + "/double").c_str(),
                [=](benchmark::State& s) { compiled<double>(s, *f, box, points, mode); });
        };
        each("batch", Mode::kBatch);
        each("batch+gradient", Mode::kBatchGradient);
        if (prefix == "pruned/") {
          each("single", Mode::kSingle);
          each("single+gradient", Mode::kSingleGradient);
        }
      };
      add("whole/scalar double",
          [=](benchmark::State& s) { scalar_double(s, *f, kEverywhere, false); });
      add("whole/scalar double jet",
          [=](benchmark::State& s) { scalar_double(s, *f, kEverywhere, true); });
      at("whole/", kEverywhere, kEverywhere);
      add("pruned/scalar double",
          [=](benchmark::State& s) { scalar_double(s, *pruned, small, false); });
      add("pruned/scalar double jet",
          [=](benchmark::State& s) { scalar_double(s, *pruned, small, true); });
      at("pruned/", small, small);
      add("compile", [=](benchmark::State& s) { build(s, *f, small); });
    }
}

}  // namespace
}  // namespace morsel::geom

int main(int argc, char** argv) {
  if (const char* name = std::getenv("MORSEL_BENCH_TARGET")) {
    std::int64_t allowed = 0;
    for (std::int64_t all = hwy::SupportedTargets(); all != 0; all &= all - 1) {
      // Worse targets have higher bits.
      const std::int64_t target = all & -all;
      if (std::strcmp(hwy::TargetName(target), name) == 0 || allowed != 0) allowed |= target;
    }
    if (allowed != 0) hwy::SetSupportedTargetsForTest(allowed);
  }
  morsel::geom::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
