// SPDX-License-Identifier: Apache-2.0
// Calls of the C API, in any order with any arguments that are pointers to what they should point
// to: each byte chooses a function, those that follow its arguments. Handles are any that were
// made, of any kind, released or not.
#include <morsel/hypertexture_geom.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "hypertexture_geom/embree/compat.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/target.h"

namespace {

using morsel::test::Input;
using morsel::test::require;

RTCDevice device() {
  static RTCDevice const device = rtcNewDevice("threads=1");
  return device;
}

// Small fields in given boxes, of which a build takes milliseconds, and mistakes.
#define BOUNDS R"(, "bounds": {"min": [-1.5, -1.5, -1.5], "max": [1.5, 1.5, 1.5]}})"
constexpr const char* kFields[] = {
    R"({"field": {"density": {"type": "sphere", "radius": 1}})" BOUNDS,
    R"({"field": {"density": {"type": "union", "width": 0.01, "densities": [
      {"type": "sphere", "radius": 0.5}, {"type": "sphere", "radius": 0.2, "center": [1, 0, 0]},
      {"type": "sphere", "radius": 0.1, "center": [0, 0, 1]}]}}, "keep": "largest:2")" BOUNDS,
    R"({"field": {"density": {"type": "rounded_box", "half_size": [0.5, 0.4, 0.3],
      "rounding": 0.1}})" BOUNDS,
    R"({"field": {"density": {"type": "sphere", "radius": 0.4}, "modulations": [{"type": "fbm",
      "noise": "perlin", "amplitude": 0.3, "frequency": 2, "layers": 1}]}, "keep": "all")" BOUNDS,
    R"({"field": {"density": {"type": "torus", "major_radius": 1, "minor_radius": 0.3}})" BOUNDS,
    R"({"density": {"type": "sphere", "radius": 1}})",
    R"({"density": {"type": "sphere", "radius": -1}})",
    R"({"density": 3})",
    R"({)",
};
#undef BOUNDS
constexpr const char* kKeeps[] = {
    "main",       "largest:2", "volume:0.001",   "touching:0,0,0", "all",
    "detached",   "ids:0,1",   "ids:4000000000", "touching:9,9,9", "",
    "largest:-1", "volume:nan"};

// A struct in as many bytes as the library may look at, with its size and a few bytes changed.
template <class T>
struct Argument {
  alignas(16) std::array<unsigned char, 8192> bytes{};
  T& get() { return *reinterpret_cast<T*>(bytes.data()); }

  explicit Argument(Input& in) {
    get().struct_size = size_of(in);
    for (std::uint32_t changes = in.byte() % 4; changes > 0; --changes) {
      const std::size_t at = 8 + in.word() % (2 * sizeof(T));
      bytes[at] = static_cast<unsigned char>(in.byte());
    }
  }
  static std::size_t size_of(Input& in) {
    const std::uint32_t choice = in.byte();
    if (choice < 200) return sizeof(T);
    return choice < 250 ? 8 * (choice - 200) : std::numeric_limits<std::size_t>::max();
  }
};

class Calls {
 public:
  explicit Calls(Input in) : in_(in) {}

  void run() {
    for (int n = 0; n < kMost && !in_.empty(); ++n) call(in_.byte() % 32);
    // Whatever its kind and count.
    for (void* h : handles_) {
      while (morsel_release_query(static_cast<MorselQuery>(h)) == MORSEL_OK) continue;
      while (morsel_release_geometry(static_cast<MorselGeometry>(h)) == MORSEL_OK) continue;
      while (morsel_release_topology(static_cast<MorselTopology>(h)) == MORSEL_OK) continue;
      while (morsel_release_field(static_cast<MorselField>(h)) == MORSEL_OK) continue;
    }
  }

 private:
  static constexpr int kMost = 60;
  // What takes time is not to be had without end.
  static constexpr int kMostBuilds = 8;
  bool may_build() { return ++builds_ <= kMostBuilds; }

  // Any handle, as one of the wanted kind: mostly, but not always, it is one.
  template <class H>
  H handle() {
    const std::uint32_t choice = in_.byte();
    if (choice == 255 || handles_.empty()) return nullptr;
    return static_cast<H>(handles_[handles_.size() - 1 - choice % handles_.size()]);
  }
  double number() {
    constexpr double kSpecial[] = {0.0,
                                   -0.0,
                                   1e-40,
                                   1e300,
                                   1e9,
                                   2e9,
                                   -1.0,
                                   0.5,
                                   1e-10,
                                   1.0,
                                   std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::quiet_NaN()};
    const std::uint32_t choice = in_.byte();
    if (choice < std::size(kSpecial)) return kSpecial[choice];
    return (static_cast<double>(choice) - 133.0) / 50.0;
  }
  template <class T>
  void fill(T (&x)[3]) {
    for (T& v : x) v = static_cast<T>(number());
  }
  std::string path() {
    constexpr const char* kNames[] = {"a.topo", "b.topo", "no/such/folder.topo", ""};
    return (morsel::test::scratch_folder() / kNames[in_.byte() % 4]).string();
  }

  // What must hold of every answer; outputs of calls that fail are untouched.
  bool good(MorselResult r) {
    require(r == MORSEL_OK || r == MORSEL_ERROR_INVALID_HANDLE ||
                r == MORSEL_ERROR_INVALID_ARGUMENT || r == MORSEL_ERROR_INVALID_INPUT ||
                r == MORSEL_ERROR_FILE || r == MORSEL_ERROR_CANCELLED,
            "the result is one that the caller is to blame for");
    if (r != MORSEL_OK) require(morsel_last_error_text()[0] != 0, "an error has a text");
    return r == MORSEL_OK;
  }
  // `made` is what the call wrote to: by reference, since the call may come after it.
  template <class H>
  void keep(MorselResult r, const H& made) {
    require(good(r) == (made != nullptr), "a handle comes with success");
    if (made != nullptr) handles_.push_back(made);
  }

  MorselBuildOptions* build_options(Argument<MorselBuildOptions>& a) {
    MorselBuildOptions& o = a.get();
    o.progress = [](void*, double fraction, const char* phase) {
      require(fraction >= 0.0 && fraction <= 1.0 && phase != nullptr, "progress is a fraction");
    };
    o.cancel = [](void* user) -> std::int32_t { return --*static_cast<int*>(user) < 0; };
    polls_ = in_.byte() < 40 ? static_cast<int>(in_.byte()) : 500;
    o.user = &polls_;
    if (o.threads < 4096) o.threads = 1;
    return in_.byte() % 8 == 0 ? nullptr : &o;
  }

  void call(std::uint32_t function) {
    switch (function) {
      case 0:
      case 1:
        return create_field();
      case 2:
      case 3:
      case 4: {
        if (!may_build()) return;
        Argument<MorselBuildOptions> a(in_);
        MorselTopology made = nullptr;
        const auto field = handle<MorselField>();
        MorselBuildOptions* options = build_options(a);
        if (function == 2) return keep(morsel_build_topology(field, options, &made), made);
        const std::string file = path();
        if (function == 3)
          return keep(morsel_open_topology(field, file.c_str(), options, &made), made);
        return keep(morsel_load_topology_with(field, file.c_str(), options, &made), made);
      }
      case 5: {
        MorselTopology made = nullptr;
        const auto field = handle<MorselField>();
        return keep(morsel_load_topology(field, path().c_str(), &made), made);
      }
      case 6: {
        const auto topology = handle<MorselTopology>();
        good(morsel_save_topology(topology, path().c_str()));
        return;
      }
      case 7:
      case 8:
        return create_geometry();
      case 9:
      case 10: {
        MorselQuery made = nullptr;
        return keep(morsel_create_query(handle<MorselGeometry>(), device(), &made), made);
      }
      case 11:
        return trace();
      case 12:
      case 13:
      case 14:
        return query();
      case 15: {
        Argument<MorselShading> a(in_);
        float point[3];
        fill(point);
        const std::uint32_t prim = in_.byte() < 250 ? in_.byte() : ~0u;
        const auto error = static_cast<float>(number());
        good(morsel_shade(handle<MorselGeometry>(), prim, point, error, &a.get()));
        return;
      }
      case 16: {
        Argument<MorselDetail> a(in_);
        double point[3];
        fill(point);
        const std::uint32_t prim = in_.byte();
        good(morsel_shade_detail(handle<MorselGeometry>(), prim, point, &a.get()));
        return;
      }
      case 17: {
        Argument<MorselTopologyInfo> a(in_);
        good(morsel_topology_info(handle<MorselTopology>(), &a.get()));
        return;
      }
      case 18: {
        Argument<MorselGeometryInfo> a(in_);
        good(morsel_geometry_info(handle<MorselGeometry>(), &a.get()));
        return;
      }
      case 19:
      case 20:
        return tables(function == 19);
      case 21: {
        double points[6], values[2] = {}, gradients[6] = {};
        for (double& x : points) x = number();
        const std::size_t count = in_.byte() % 3;
        double* const slopes = in_.byte() % 2 != 0 ? gradients : nullptr;
        good(morsel_evaluate_field(handle<MorselField>(), points, count, values, slopes));
        return;
      }
      case 22: {
        double lower[3], upper[3];
        if (good(morsel_field_bounds(handle<MorselField>(), lower, upper)))
          for (int i = 0; i < 3; ++i) require(lower[i] < upper[i], "a field's box has extent");
        return;
      }
      case 23: {
        const char* text = nullptr;
        const auto field = handle<MorselField>();
        const bool hash = in_.byte() % 2 != 0;
        const bool done =
            good(hash ? morsel_field_hash(field, &text) : morsel_field_json(field, &text));
        require(done == (text != nullptr) && (!done || text[0] != 0), "a text comes with success");
        return;
      }
      case 24: {
        std::int32_t kept = 0;
        const auto geometry = handle<MorselGeometry>();
        good(morsel_geometry_keeps(geometry, in_.byte() < 200 ? in_.byte() : ~0u, &kept));
        return;
      }
      case 25: {
        std::uint32_t component = 0;
        const auto geometry = handle<MorselGeometry>();
        good(morsel_geometry_component(geometry, in_.word(), &component));
        return;
      }
      case 26:
      case 27:
        return count_references(function == 26);
      default:
        morsel_object_error_text(handle<void*>());
        morsel_result_name(static_cast<MorselResult>(in_.byte()) - 100);
    }
  }

  void create_field() {
    if (!may_build()) return;
    MorselField made = nullptr;
    std::string text = kFields[in_.byte() % std::size(kFields)];
    // A character or two of it may be another.
    for (std::uint32_t changes = in_.byte() % 8; changes > 5; --changes) {
      const std::size_t at = in_.word() % text.size();
      text[at] = static_cast<char>(in_.byte());
    }
    keep(morsel_create_field(text.c_str(), in_.byte() % 2 ? "a name" : nullptr, &made), made);
  }

  void create_geometry() {
    if (!may_build()) return;
    Argument<MorselGeometryOptions> a(in_);
    MorselGeometryOptions& o = a.get();
    if (o.threads < 4096) o.threads = 1;
    if (in_.byte() % 2 != 0) o.far_distance = number();
    o.keep = in_.byte() % 4 == 0 ? nullptr : kKeeps[in_.byte() % std::size(kKeeps)];
    o.progress = nullptr;
    o.cancel = [](void* user) -> std::int32_t { return --*static_cast<int*>(user) < 0; };
    polls_ = in_.byte() < 40 ? static_cast<int>(in_.byte()) : 500;
    o.user = &polls_;
    MorselGeometry made = nullptr;
    const auto field = handle<MorselField>();
    const auto topology = handle<MorselTopology>();
    keep(morsel_create_geometry(field, topology, in_.byte() % 8 == 0 ? nullptr : &o, &made), made);
  }

  void trace() {
    RTCGeometry geometry = nullptr;
    const auto handle_of = handle<MorselGeometry>();
    const bool done =
        good(morsel_create_rtc_geometry(handle_of, device(), in_.byte() % 3, &geometry));
    require(done == (geometry != nullptr), "a geometry comes with success");
    if (!done) return;
    RTCScene scene = rtcNewScene(device());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    // It outlives the handle.
    if (in_.byte() % 4 == 0) good(morsel_release_geometry(handle_of));
    float origin[3], direction[3];
    fill(origin);
    fill(direction);
    RTCRayHit ray = morsel::geom::make_ray_hit(
        morsel::geom::make_ray(origin[0], origin[1], origin[2], direction[0], direction[1],
                               direction[2], 0.0f, static_cast<float>(number())));
    morsel::geom::intersect1(scene, ray);
    rtcReleaseScene(scene);
  }

  void query() {
    const auto query = handle<MorselQuery>();
    MorselRay ray;
    fill(ray.origin);
    fill(ray.direction);
    ray.tnear = static_cast<float>(std::abs(number()));
    ray.tfar =
        in_.byte() % 2 ? std::numeric_limits<float>::infinity() : static_cast<float>(number());
    const std::size_t hit_size = in_.byte() < 240 ? sizeof(MorselHit) : 8 * in_.byte();
    std::vector<unsigned char> hits(8 * std::max<std::size_t>(hit_size, sizeof(MorselHit)));
    auto* first = reinterpret_cast<MorselHit*>(hits.data());
    std::int32_t found = -1, any = -1;
    std::size_t count = 0;
    const bool one = good(morsel_query_first_hit(query, &ray, hit_size, first, &found));
    if (one && found != 0 && hit_size >= sizeof first->t)
      require(first->t >= ray.tnear && first->t <= ray.tfar, "hits are within the ray");
    if (good(morsel_query_any_hit(query, &ray, &any)) && one)
      require((any != 0) == (found != 0), "any hit and the first hit agree that there is one");
    const std::size_t room = in_.byte() % 9;
    if (good(morsel_query_all_hits(query, &ray, hit_size, first, room, &count)) && one)
      require((count != 0) == (found != 0), "all hits and the first hit agree that there is one");
  }

  void tables(bool components) {
    const auto topology = handle<MorselTopology>();
    const std::size_t begin = in_.byte() % 16, count = in_.byte() % 4;
    const std::size_t own = components ? sizeof(MorselComponent) : sizeof(MorselCriticalPoint);
    const std::size_t size = in_.byte() < 200 ? own : 8 * in_.byte();
    std::vector<unsigned char> out(std::max<std::size_t>(4 * size, 1));
    if (components)
      good(morsel_topology_components(topology, begin, count, size,
                                      reinterpret_cast<MorselComponent*>(out.data())));
    else
      good(morsel_topology_critical_points(topology, begin, count, size,
                                           reinterpret_cast<MorselCriticalPoint*>(out.data())));
  }

  void count_references(bool retain) {
    const std::uint32_t kind = in_.byte() % 4;
    void* h = handle<void*>();
    auto* f = static_cast<MorselField>(h);
    auto* t = static_cast<MorselTopology>(h);
    auto* g = static_cast<MorselGeometry>(h);
    auto* q = static_cast<MorselQuery>(h);
    if (kind == 0) good(retain ? morsel_retain_field(f) : morsel_release_field(f));
    if (kind == 1) good(retain ? morsel_retain_topology(t) : morsel_release_topology(t));
    if (kind == 2) good(retain ? morsel_retain_geometry(g) : morsel_release_geometry(g));
    if (kind == 3) good(retain ? morsel_retain_query(q) : morsel_release_query(q));
  }

  Input in_;
  std::vector<void*> handles_;
  int polls_ = 0, builds_ = 0;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 2048;
  if (size > kLongest) return 0;
  Calls({data, size}).run();
  for (const char* name : {"a.topo", "b.topo"}) {
    std::error_code ignored;
    std::filesystem::remove(morsel::test::scratch_folder() / name, ignored);
  }
  return 0;
}
