// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "hypertexture_geom/params/json_reader.h"
#include "tools/commands.h"
#include "tools/debug_pixel.h"
#include "tools/interrupt.h"
#include "tools/output_file.h"
#include "tools/render_job.h"
#include "tools/render_options.h"
#include "tools/render_statistics.h"
#include "tools/scene_check.h"
#include "tools/scene_options.h"
#include "topology/certified.h"

namespace morsel::tools {
namespace {

int check(const RenderFlags& flags, Reporter& reporter) {
  int code = kDone;
  for (const std::string& scene : flags.scenes)
    code = std::max(code, print_problems(scene, render_overrides(flags, scene), reporter, false));
  return code;
}

// One scene: its document; several: an array of them.
void write_statistics(const StatisticsTarget& target, const nlohmann::json& all, bool several) {
  const nlohmann::json& document = several || all.empty() ? all : all.front();
  if (target.json) std::cout << document.dump(2) << '\n';
  if (target.text)
    for (const nlohmann::json& one : all) std::cout << statistics_text(one);
  if (target.file.empty()) return;
  OutputFile file(target.file);
  file.stream() << document.dump(2) << '\n';
  file.commit();
}

int run(const RenderFlags& flags, const Session& session) {
  Reporter reporter(flags.reporting);
  if (flags.check) return check(flags, reporter);
  const auto threads = limit_threads(flags.threads);
  if (!flags.debug_pixel.empty())
    return debug_pixel(flags.scenes.front(), render_overrides(flags, flags.scenes.front()),
                       flags.debug_pixel, reporter, *session.cancel);
  const StatisticsTarget target = parse_statistics(flags.stats);
  const std::vector<RenderPlan> plans = plan_renders(flags);
  if (!target.file.empty()) topology::require_replaceable(target.file);

  install_picture_handler();
  int code = kDone;
  nlohmann::json statistics = nlohmann::json::array();
  for (const RenderPlan& plan : plans) {
    RenderedScene rendered;
    try {
      rendered = render_scene(plan, target.wanted(), reporter, *session.cancel);
    } catch (const topology::Cancelled&) {
      reporter.error("interrupted");
      code = kInterrupted;
      break;
    } catch (const std::exception& e) {
      // The other scenes are rendered all the same; that this one was not is not forgotten.
      const int failed = exit_code_of(e);
      if (plans.size() == 1) throw;
      reporter.error(e.what());
      code = code == kDone ? failed : code;
      continue;
    }
    if (target.wanted()) statistics.push_back(std::move(rendered.statistics));
    if (!target.json)
      for (const auto& file : rendered.files) std::cout << file.string() << std::endl;
    if (rendered.interrupted) {
      reporter.error(plan.checkpoint.empty()
                         ? "interrupted; the picture is partial"
                         : "interrupted; the picture is partial, and --resume goes on from " +
                               plan.checkpoint.string());
      code = kInterrupted;
      break;
    }
  }
  if (target.wanted()) write_statistics(target, statistics, plans.size() > 1);
  return code;
}

}  // namespace

void add_render(CLI::App& parent, Session& session) {
  auto flags = std::make_shared<RenderFlags>();
  CLI::App* command = parent.add_subcommand("render", "Render scenes");
  add_render_flags(*command, *flags);
  command->callback(
      [flags, &session] { session.run = [flags, &session] { return run(*flags, session); }; });
}

}  // namespace morsel::tools
