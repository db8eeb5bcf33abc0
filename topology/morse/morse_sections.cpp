// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/morse_sections.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace morsel::topology {
namespace {

using nlohmann::json;

constexpr std::string_view kPoints = "morse.points";
constexpr std::string_view kSeparatrices = "morse.separatrices";
constexpr std::string_view kPaths = "morse.paths";
constexpr std::string_view kMeta = "morse.meta";

struct PointRecord {
  double position[3];
  double radius, value;
  double eigenvalues[3], axis[3];
  double basin;
  std::uint32_t set, type;
};
static_assert(sizeof(PointRecord) == 104);

struct SeparatrixRecord {
  std::uint32_t saddle, maximum;
  std::uint64_t first;  // in morse.paths
  std::uint64_t count;
};
static_assert(sizeof(SeparatrixRecord) == 24);

struct PathRecord {
  float x, y, z;
};

json vector_json(const Imath::V3d& v) { return {v.x, v.y, v.z}; }
Imath::V3d vector_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}
json box_json(const Box& b) { return {{"min", vector_json(b.min)}, {"max", vector_json(b.max)}}; }
Box box_of(const json& j) { return {vector_of(j.at("min")), vector_of(j.at("max"))}; }

json audit_json(const Audit& audit) {
  json disagreements = json::array();
  for (const Audit::Disagreement& d : audit.disagreements)
    disagreements.push_back({{"place", vector_json(d.place)}, {"what", d.what}});
  json euler_by = json::array();
  if (!audit.euler.empty()) euler_by.push_back("octree");
  if (audit.euler_by_mesh) euler_by.push_back("mesh");
  return {{"verdict", audit.verdict()},         {"agreed", audit.agreed()},
          {"conclusive", audit.conclusive},     {"reasons", audit.reasons},
          {"disagreements", disagreements},     {"euler", audit.euler},
          {"euler_compared_with", euler_by},    {"mesh_asked", audit.mesh_asked},
          {"perturbation", audit.perturbation}, {"seconds", audit.seconds}};
}

json meta_of(const MorseComplex& complex, const Audit* audit) {
  json places = json::array(), lost = json::array();
  for (const Unresolved& u : complex.places)
    places.push_back({{"box", box_json(u.box)}, {"value", u.value}});
  for (const LostStreamline& l : complex.lost)
    lost.push_back({{"point", l.point}, {"last", vector_json(l.last)}, {"reason", l.reason}});
  return {{"box", box_json(complex.box)},
          {"sets", complex.sets.size()},
          {"sets_bounds", {complex.sets_lo, complex.sets_hi}},
          {"unresolved_boxes", complex.unresolved_boxes},
          {"places", places},
          {"lost_ascents", lost},
          {"perturbation", complex.perturbation},
          {"boxes", complex.boxes},
          {"models", complex.models},
          {"seconds_critical_points", complex.seconds_points},
          {"seconds_separatrices", complex.seconds_separatrices},
          {"audit", audit != nullptr ? audit_json(*audit) : json()}};
}

CriticalPoint point_of(const PointRecord& r) {
  CriticalPoint p;
  p.position = Imath::V3d(r.position[0], r.position[1], r.position[2]);
  p.radius = r.radius;
  p.value = r.value;
  p.eigenvalues = Imath::V3d(r.eigenvalues[0], r.eigenvalues[1], r.eigenvalues[2]);
  p.axis = Imath::V3d(r.axis[0], r.axis[1], r.axis[2]);
  p.basin = r.basin;
  p.set = r.set;
  p.type = static_cast<CriticalType>(r.type);
  return p;
}

bool finite(const Imath::V3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void read_points(const Sections& sections, std::size_t components, std::string_view file,
                 MorseComplex& complex) {
  complex.sets.resize(components);
  for (const PointRecord& r : sections.records<PointRecord>(kPoints)) {
    const std::size_t i = complex.points.size();
    const auto bad = [&](const char* what) {
      throw CacheError(fmt::format("{}: {}: record {}: {}", file, kPoints, i, what));
    };
    if (r.type > static_cast<std::uint32_t>(CriticalType::kDegenerate)) bad("unknown type");
    if (r.set != kNoSet && r.set >= components) bad("component that is not in the table");
    const CriticalPoint p = point_of(r);
    if (!finite(p.position) || !std::isfinite(p.value) || !finite(p.axis) ||
        !std::isfinite(p.basin) || p.basin < 0.0)
      bad("number that is not finite");
    complex.points.push_back(p);
    if (p.set == kNoSet) continue;
    MorseSet& set = complex.sets[p.set];
    if (p.type == CriticalType::kMaximum && set.maxima == 0)
      set.highest = static_cast<std::uint32_t>(i);
    set.add(p.type);
  }
  for (std::uint32_t s = 0; s < complex.sets.size(); ++s)
    if (complex.main == kNoSet || complex.sets[s].maxima > complex.sets[complex.main].maxima)
      complex.main = s;
}

void read_separatrices(const Sections& sections, std::string_view file, MorseComplex& complex) {
  const std::vector<PathRecord> paths = sections.records<PathRecord>(kPaths);
  for (const SeparatrixRecord& r : sections.records<SeparatrixRecord>(kSeparatrices)) {
    const auto bad = [&](const char* what) {
      throw CacheError(fmt::format("{}: {}: record {}: {}", file, kSeparatrices,
                                   complex.separatrices.size(), what));
    };
    const auto is = [&](std::uint32_t point, CriticalType type) {
      return point < complex.points.size() && complex.points[point].type == type;
    };
    if (!is(r.saddle, CriticalType::kSaddle2)) bad("does not start from a 2-saddle");
    if (r.maximum != Separatrix::kNoMaximum && !is(r.maximum, CriticalType::kMaximum))
      bad("does not end in a maximum");
    if (r.first > paths.size() || r.count > paths.size() - r.first) bad("path beyond the end");
    Separatrix s{r.saddle, r.maximum, {}};
    for (std::uint64_t i = r.first; i < r.first + r.count; ++i)
      s.path.emplace_back(paths[i].x, paths[i].y, paths[i].z);
    complex.separatrices.push_back(std::move(s));
  }
}

}  // namespace

void put_morse(Sections& sections, const MorseComplex& complex, const Audit* audit) {
  std::vector<PointRecord> points;
  for (const CriticalPoint& p : complex.points)
    points.push_back({{p.position.x, p.position.y, p.position.z},
                      p.radius,
                      p.value,
                      {p.eigenvalues.x, p.eigenvalues.y, p.eigenvalues.z},
                      {p.axis.x, p.axis.y, p.axis.z},
                      p.basin,
                      p.set,
                      static_cast<std::uint32_t>(p.type)});
  std::vector<SeparatrixRecord> separatrices;
  std::vector<PathRecord> paths;
  for (const Separatrix& s : complex.separatrices) {
    separatrices.push_back({s.saddle, s.maximum, paths.size(), s.path.size()});
    for (const Imath::V3d& x : s.path)
      paths.push_back({static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)});
  }
  sections.put_records<PointRecord>(kPoints, points);
  sections.put_records<SeparatrixRecord>(kSeparatrices, separatrices);
  sections.put_records<PathRecord>(kPaths, paths);
  const std::string meta = meta_of(complex, audit).dump();
  const auto bytes = std::as_bytes(std::span(meta));
  sections.put({std::string(kMeta), 1, {bytes.begin(), bytes.end()}});
}

json morse_meta(const Sections& sections, std::string_view file) {
  const Section* meta = sections.find(kMeta);
  if (meta == nullptr) return {};
  try {
    const char* text = reinterpret_cast<const char*>(meta->bytes.data());
    return json::parse(text, text + meta->bytes.size());
  } catch (const json::exception& e) {
    throw CacheError(fmt::format("{}: {}: {}", file, kMeta, e.what()));
  }
}

std::optional<MorseComplex> get_morse(const Sections& sections, std::size_t components,
                                      std::string_view file) {
  if (sections.find(kPoints) == nullptr) return std::nullopt;
  MorseComplex complex;
  read_points(sections, components, file, complex);
  read_separatrices(sections, file, complex);
  const json meta = morse_meta(sections, file);
  try {
    complex.box = box_of(meta.at("box"));
    complex.sets_lo = meta.at("sets_bounds").at(0).get<std::uint64_t>();
    complex.sets_hi = meta.at("sets_bounds").at(1).get<std::uint64_t>();
    complex.unresolved_boxes = meta.at("unresolved_boxes").get<std::uint64_t>();
    for (const json& u : meta.at("places"))
      complex.places.push_back({box_of(u.at("box")), u.at("value").get<double>()});
    for (const json& l : meta.at("lost_ascents"))
      complex.lost.push_back({l.at("point").get<std::uint32_t>(), vector_of(l.at("last")),
                              l.at("reason").get<std::string>()});
    complex.perturbation = meta.at("perturbation").get<double>();
    complex.boxes = meta.at("boxes").get<std::uint64_t>();
    complex.models = meta.at("models").get<std::uint64_t>();
    complex.seconds_points = meta.at("seconds_critical_points").get<double>();
    complex.seconds_separatrices = meta.at("seconds_separatrices").get<double>();
  } catch (const json::exception& e) {
    throw CacheError(fmt::format("{}: {}: {}", file, kMeta, e.what()));
  }
  return complex;
}

}  // namespace morsel::topology
