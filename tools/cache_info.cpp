// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "topology/cache_file.h"

namespace morsel::tools {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string keep = "main";
  bool json = false;
  std::size_t components = 20;
};

topology::KeepRule parse_keep(const std::string& text) {
  try {
    return topology::KeepRule::parse(text);
  } catch (const std::invalid_argument& e) {
    throw UsageError(fmt::format("--keep: {}", e.what()));
  }
}

// Tables are for --json; here their length will do.
std::string text_of(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array() && !value.empty() && value[0].is_structured())
    return fmt::format("({} entries; see --json)", value.size());
  return value.dump();
}

// "octree.leaves  160920" for every value that is not an object, aligned.
void print_flat(const nlohmann::json& object, const std::string& prefix) {
  for (const auto& item : object.items()) {
    if (item.value().is_object())
      print_flat(item.value(), prefix + item.key() + ".");
    else
      std::cout << fmt::format("{:<28} {}\n", prefix + item.key(), text_of(item.value()));
  }
}

// The largest components, which come first.
void print_table(const topology::Topology& t, const std::vector<bool>& kept, std::size_t rows) {
  if (t.components.empty() || rows == 0) return;
  std::cout << fmt::format(
      "\n{:>8}  {:>4}  {:>26}  {:>10}  {}\n", "id", "kept",
      t.engine == "morse" ? "volume (sums of cells)" : "volume (certified bounds)", "cells", "box");
  for (std::size_t i = 0; i < std::min(rows, t.components.size()); ++i) {
    const topology::Component& c = t.components[i];
    std::cout << fmt::format(
        "{:>8}  {:>4}  {:>12.6g} {:>13.6g}  {:>10}  [{:.4g}, {:.4g}] x [{:.4g}, {:.4g}] x [{:.4g}, "
        "{:.4g}]\n",
        i, kept[i] ? "yes" : "no", c.volume_lo, c.volume_hi, c.cells, c.bounds.min.x,
        c.bounds.max.x, c.bounds.min.y, c.bounds.max.y, c.bounds.min.z, c.bounds.max.z);
  }
  if (rows < t.components.size())
    std::cout << fmt::format("{:>8}  ({} more; --components shows them)\n", "...",
                             t.components.size() - rows);
}

void print_text(const topology::TopologyCache& cache, const topology::KeepRule& keep,
                const nlohmann::json& description, std::size_t rows) {
  print_flat(description, "");
  const topology::Topology& t = cache.topology;
  print_table(t, topology::kept_components(keep, t.components, t.octree()), rows);
}

// Several files are what `rock-*.topo` is once a field has changed.
int run(const Options& options) {
  const topology::KeepRule keep = parse_keep(options.keep);
  const bool several = options.files.size() > 1;
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    const topology::TopologyCache cache = topology::read_cache(options.files[i]);
    nlohmann::json description = topology::describe(cache, keep);
    if (several) description["file"] = options.files[i];
    if (!options.json) {
      if (several) std::cout << fmt::format("{}{}:\n", i > 0 ? "\n" : "", options.files[i]);
      print_text(cache, keep, description, options.components);
    }
    all.push_back(std::move(description));
  }
  if (options.json) std::cout << (several ? all : all[0]).dump(2) << '\n';
  return kDone;
}

}  // namespace

void add_cache_info(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("info", "Describe a topology cache");
  command
      ->add_option("FILE", options->files, "Topology cache (.topo); several are described in turn")
      ->required();
  command->add_flag("--json", options->json, "Print one JSON document; an array for several files");
  command
      ->add_option("--components", options->components,
                   "How many components to list, largest volume first")
      ->capture_default_str();
  command
      ->add_option("--keep", options->keep,
                   "Rule that `kept` is counted by: main, largest:K, volume:V, touching:X,Y,Z, "
                   "all, detached, ids:I,J,...")
      ->capture_default_str();
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
