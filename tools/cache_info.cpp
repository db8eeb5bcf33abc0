// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "tools/commands.h"
#include "topology/cache_file.h"

namespace morsel::tools {
namespace {

struct Options {
  std::string file;
  std::string keep = "main";
  bool json = false;
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

int run(const Options& options) {
  const topology::KeepRule keep = parse_keep(options.keep);
  const topology::TopologyCache cache = topology::read_cache(options.file);
  const nlohmann::json description = topology::describe(cache, keep);
  if (options.json) {
    std::cout << description.dump(2) << '\n';
  } else {
    print_flat(description, "");
  }
  return kDone;
}

}  // namespace

void add_cache_info(CLI::App& parent, Session& session) {
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("info", "Describe a topology cache");
  command->add_option("FILE", options->file, "Topology cache (.topo)")->required();
  command->add_flag("--json", options->json, "Print one JSON document");
  command
      ->add_option("--keep", options->keep,
                   "Rule that `kept` is counted by: main, largest:K, volume:V, touching:X,Y,Z, "
                   "all, detached, ids:I,J,...")
      ->capture_default_str();
  command->callback([options, &session] { session.run = [options] { return run(*options); }; });
}

}  // namespace morsel::tools
