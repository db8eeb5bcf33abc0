// SPDX-License-Identifier: Apache-2.0
#include "tools/man_options.h"

#include <fmt/format.h>

#include <vector>

namespace morsel::tools {
namespace {

// As roff prints it unchanged.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += ' ';
    else
      out += c;
  }
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

// "TEXT:{auto,bar}" as {auto,bar}: the parser says what a value is before what it must be.
std::string value_text(const CLI::Option& option) {
  if (option.get_type_size() == 0) return "";
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  return colon == std::string::npos ? type : type.substr(colon + 1);
}

std::string names_text(const CLI::Option& option) {
  std::string text;
  const auto add = [&](const char* dashes, const std::vector<std::string>& names) {
    for (const std::string& name : names)
      text += (text.empty() ? "" : ", ") + ("\\fB" + roff(dashes + name) + "\\fR");
  };
  add("-", option.get_snames());
  add("--", option.get_lnames());
  return text;
}

void add_option(const CLI::Option& option, std::string& page) {
  const std::string value = value_text(option);
  std::string help = roff(option.get_description());
  if (!option.get_default_str().empty())
    help += " (default: " + roff(option.get_default_str()) + ")";
  if (option.get_required()) help += " (required)";
  page += fmt::format(".TP\n{}{}\n{}\n", names_text(option),
                      value.empty() ? "" : " \\fI" + roff(value) + "\\fR", help);
}

void add_command(const CLI::App& command, const std::string& path, std::string& page) {
  std::string title = path;
  std::vector<const CLI::Option*> flags;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    if (option->get_positional()) {
      const std::string name = option->get_name();
      title += fmt::format(" \\fI{}{}\\fR", roff(name),
                           option->get_items_expected_max() > 1 ? "..." : "");
    } else if (option != command.get_help_ptr()) {
      flags.push_back(option);
    }
  }
  if (!flags.empty()) {
    page += fmt::format(".SS \"{}\"\n{}\n", title, roff(command.get_description()));
    for (const CLI::Option* option : flags) add_option(*option, page);
  }
  for (const CLI::App* more : command.get_subcommands({}))
    add_command(*more, path + " " + more->get_name(), page);
}

}  // namespace

std::string man_options(const CLI::App& app) {
  std::string page;
  for (const CLI::App* command : app.get_subcommands({}))
    add_command(*command, app.get_name() + " " + command->get_name(), page);
  return page;
}

}  // namespace morsel::tools
