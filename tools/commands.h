// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/session.h"

// One function and one file a subcommand; main.cpp and render_main.cpp call them. A new subcommand
// is one more of each.
namespace morsel::tools {

void add_bench(CLI::App& parent, Session& session);
void add_bench_topology(CLI::App& parent, Session& session);
void add_cache_build(CLI::App& parent, Session& session);
void add_cache_compare(CLI::App& parent, Session& session);
void add_cache_export(CLI::App& parent, Session& session);
void add_cache_info(CLI::App& parent, Session& session);
void add_cache_verify(CLI::App& parent, Session& session);
void add_field_eval(CLI::App& parent, Session& session);
void add_field_sample(CLI::App& parent, Session& session);
void add_merge(CLI::App& parent, Session& session);
void add_mesh(CLI::App& parent, Session& session);
void add_render(CLI::App& parent, Session& session);
void add_scene_check(CLI::App& parent, Session& session);
void add_scene_new(CLI::App& parent, Session& session);
void add_scene_schema(CLI::App& parent, Session& session);

}  // namespace morsel::tools
