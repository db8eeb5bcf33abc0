// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "hypertexture_geom/params/parameter.h"
#include "renderer/scene/scene_json.h"
#include "tools/commands.h"
#include "tools/scene_options.h"
#include "topology/certified.h"

namespace morsel::tools {
namespace {

struct Options {
  SceneOptions scene;
  std::string geometry;
  std::string points;
  int threads = 0;
};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// Exactly three finite numbers separated by blanks; empty when the line is anything else.
// Independent of the locale.
std::optional<Imath::V3d> parse_point(const std::string& line) {
  Imath::V3d point;
  const char* at = line.data();
  const char* const end = at + line.size();
  for (int i = 0; i < 3; ++i) {
    const char* const before = at;
    while (at != end && is_space(*at)) ++at;
    if (i > 0 && at == before) return std::nullopt;
    if (at != end && *at == '+') ++at;
    const auto [rest, error] = std::from_chars(at, end, point[i]);
    if (error != std::errc() || !std::isfinite(point[i])) return std::nullopt;
    at = rest;
  }
  while (at != end && is_space(*at)) ++at;
  if (at != end) return std::nullopt;
  return point;
}

bool is_blank(const std::string& line) {
  for (const char c : line)
    if (!is_space(c)) return false;
  return true;
}

// Lines without anything in them are skipped.
std::vector<Imath::V3d> read_points(std::istream& in, const std::string& name,
                                    const Session& session) {
  std::vector<Imath::V3d> points;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (is_blank(line)) continue;
    const std::optional<Imath::V3d> point = parse_point(line);
    if (!point)
      throw UsageError(fmt::format("{}: line {}: must be three numbers x y z, not \"{}\"", name,
                                   number, line.substr(0, 80)));
    for (int axis = 0; axis < 3; ++axis)
      if (const double x = (*point)[axis]; std::abs(x) > params::kFarthest)
        throw UsageError(
            fmt::format("{}: line {}: {} is {:.6g}, must be between {:.15g} and {:.15g}", name,
                        number, "xyz"[axis], x, -params::kFarthest, params::kFarthest));
    points.push_back(*point);
  }
  if (session.cancel->load()) throw topology::Cancelled();
  if (in.bad()) throw std::runtime_error(name + ": cannot read");
  return points;
}

std::vector<Imath::V3d> read_points(const std::string& file, const Session& session) {
  if (file == "-") return read_points(std::cin, "standard input", session);
  std::ifstream in(file);
  if (!in) throw UsageError(file + ": cannot open");
  return read_points(in, file, session);
}

int run(const Options& options, const Session& session) {
  const render::SceneDocument document(options.scene.scene, options.scene.overrides());
  const auto field =
      render::read_field(document, render::find_hypertexture(document, options.geometry));
  const std::vector<Imath::V3d> points = read_points(options.points, session);

  const auto threads = limit_threads(options.threads);
  std::vector<topology::Jet> jets(points.size());
  oneapi::tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (session.cancel->load(std::memory_order_relaxed)) return;
    jets[i] = field->jet(points[i]);
  });
  if (session.cancel->load()) throw topology::Cancelled();
  for (const topology::Jet& jet : jets)
    std::cout << fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}\n", jet.value, jet.gradient.x,
                             jet.gradient.y, jet.gradient.z);
  return kDone;
}

}  // namespace

void add_field_eval(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      parent.add_subcommand("eval", "Print `F gx gy gz` for each line `x y z` of a file");
  add_scene_options(*command, options->scene);
  command->add_option("--geometry", options->geometry,
                      "Hypertexture geometry; may be left out if there is only one");
  command->add_option("--points", options->points, "File of points, or - for standard input")
      ->required();
  add_threads_option(*command, options->threads);
  command->callback([options, &session] {
    session.run = [options, &session] { return run(*options, session); };
  });
}

}  // namespace morsel::tools
