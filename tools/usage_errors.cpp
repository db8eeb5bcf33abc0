// SPDX-License-Identifier: Apache-2.0
#include "tools/usage_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "hypertexture_geom/params/parameter.h"

namespace morsel::tools {
namespace {

// Flags as other renderers call them, where the spelling does not lead to ours.
constexpr struct {
  std::string_view other, ours;
} kFlagsElsewhere[] = {{"cropwindow", "crop"},     {"height", "resolution"},
                       {"interactive", "preview"}, {"samples", "spp"},
                       {"size", "resolution"},     {"timeout", "time-limit"},
                       {"width", "resolution"},    {"verbosity", "log-level"}};

// The command that the parser had come to: "cache build" of `morsel cache build --frob`.
struct Reached {
  const CLI::App* command;
  std::string path;  // empty: none
};
Reached reached(const CLI::App& app) {
  Reached at{&app, ""};
  while (!at.command->get_subcommands().empty()) {
    at.command = at.command->get_subcommands().back();
    at.path += (at.path.empty() ? "" : " ") + at.command->get_name();
  }
  return at;
}

std::vector<std::string> subcommands_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

std::string did_you_mean(const std::string& name) {
  return name.empty() ? "" : fmt::format(", did you mean \"{}\"?", name);
}

// `word` as it was typed, with a value behind '='. Empty when no flag is like it.
std::string nearest_flag(const CLI::App& command, std::string_view word) {
  const std::string_view name = word.substr(0, word.find('=')).substr(2);
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_group().empty())
      for (const std::string& each : option->get_lnames()) names.push_back(each);
  // By its own name, by that of others, or nearly one of the two.
  const std::size_t own = names.size();
  for (const auto& [other, ours] : kFlagsElsewhere)
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(own), ours) !=
        names.begin() + static_cast<std::ptrdiff_t>(own))
      names.emplace_back(other);
  std::string near = std::find(names.begin(), names.end(), name) != names.end()
                         ? std::string(name)
                         : params::nearest_name(name, names);
  for (const auto& [other, ours] : kFlagsElsewhere)
    if (near == other) near = ours;
  return near.empty() ? "" : "--" + near;
}

// Of a word that the parser had no place for.
std::string unexpected(const CLI::App& command, const std::string& word) {
  if (word.starts_with("--") && word.size() > 2)
    return fmt::format("{}: unknown flag{}", word, did_you_mean(nearest_flag(command, word)));
  // Of "-q=3" the parser says that there is no flag "-=3".
  if (word.starts_with("-=")) return fmt::format("{}: a flag of one letter takes no value", word);
  if (word.starts_with('-') && word.size() > 1) return fmt::format("{}: unknown flag", word);
  const std::vector<std::string> names = subcommands_of(command);
  // A command with commands below takes no other words, unless it is one in its own right.
  if (names.empty() || command.get_require_subcommand_min() == 0)
    return fmt::format("{}: there is no place for this argument", word);
  return fmt::format("{}: unknown command{}; commands: {}", word,
                     did_you_mean(params::nearest_name(word, names)), fmt::join(names, ", "));
}

// The flag of one value that has none: the parser's text begins with its name, "--spp: 1 required".
const CLI::Option* without_value(const CLI::App& command, std::string_view said) {
  for (const CLI::Option* option : command.get_options())
    if (!option->get_positional() && option->get_items_expected_min() == 1 &&
        said.starts_with(option->get_name() + ": 1 required"))
      return option;
  return nullptr;
}

// What a flag takes. The parser has "INT", "FLOAT:POSITIVE", "UINT:INT in [2 - 8192]", "TEXT", and
// "TEXT:{model,segment,sphere}".
std::string type_of(const CLI::Option& option) {
  const std::string name = option.get_type_name();
  const std::string type = name.substr(0, name.find(':')), check = name.substr(type.size());
  if (type == "TEXT") return check.empty() ? "text" : check.substr(1);
  if (type != "INT" && type != "UINT" && type != "FLOAT") return name;
  const std::string number = type == "FLOAT" ? "a number" : "a whole number";
  if (check == ":POSITIVE") return number + " above 0";
  if (check == ":NONNEGATIVE") return number + ", 0 or more";
  const std::size_t from = check.find('['), to = check.find(" - ");
  if (from == std::string::npos || to == std::string::npos) return number;
  return fmt::format("{} from {} to {}", number, check.substr(from + 1, to - from - 1),
                     check.substr(to + 3, check.find(']') - to - 3));
}

std::string missing_value(const CLI::Option& option) {
  return fmt::format("{}: a value is missing ({})", option.get_name(), type_of(option));
}

bool is_flag(std::string_view word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9');
}

bool has_flag(const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  return command.get_option_no_throw(name) != nullptr;
}

// Of a number's flag that took something else for its value: another flag, which may be one of the
// command's or not, or what is no number or out of range (an open range, in the parser's words,
// ends at a number of 309 digits). The parser's texts are "Could not convert: --spp = --foo", of
// all values that were given, and "--threads: Value --foo not in range 1 to 8". Empty: it is not
// one of these.
std::string bad_value(const CLI::App& command, std::string_view said) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string convert = "Could not convert: " + option->get_name() + " = ",
                      range = option->get_name() + ": Value ";
    std::string value;
    if (said.starts_with(convert)) {
      value = said.substr(convert.size());
      value.erase(0, value.find_last_of(',') + 1);
    } else if (said.starts_with(range)) {
      value = said.substr(range.size(), said.find(" not in range") - range.size());
    } else {
      continue;
    }
    if (!is_flag(value))
      return fmt::format("{} {}: must be {}", option->get_name(), value, type_of(*option));
    const std::string missing = missing_value(*option);
    return has_flag(command, value) ? missing : missing + "; " + unexpected(command, value);
  }
  return "";
}

std::string problem(const CLI::App& command, const CLI::ParseError& error) {
  // What is wrong with the value of a flag may say where the others belong.
  const std::string_view said = error.what();
  if (const std::string text = bad_value(command, said); !text.empty()) return text;
  if (error.get_name() == "ValidationError" && said.starts_with("--")) return error.what();
  constexpr std::string_view kOverride = " was given a disallowed flag override";
  if (said.ends_with(kOverride)) {  // after the flag's name without its dashes
    const std::string_view name = said.substr(0, said.size() - kOverride.size());
    return fmt::format("{}{}: takes no value", name.size() > 1 ? "--" : "-", name);
  }
  const CLI::Option* const without =
      error.get_name() == "ArgumentMismatch" ? without_value(command, said) : nullptr;
  const std::vector<std::string> rest = command.remaining();
  // Flags first, all of them: the word behind an unknown flag has been taken for an argument.
  std::vector<std::string> flags;
  for (const std::string& word : rest)
    if (word.starts_with('-') && word.size() > 1) flags.push_back(unexpected(command, word));
  if (!flags.empty() && without != nullptr) flags.push_back(missing_value(*without));
  if (!flags.empty()) return fmt::format("{}", fmt::join(flags, "; "));
  if (!rest.empty()) return unexpected(command, rest.front());
  const std::vector<std::string> names = subcommands_of(command);
  if (error.get_name() == "RequiredError" && command.get_require_subcommand_min() > 0)
    return fmt::format("a command is required: {}", fmt::join(names, ", "));
  if (without != nullptr) return missing_value(*without);
  // What stands behind "--" is not among the rest.
  if (said.starts_with("The following argument"))
    return fmt::format("{}: there is no place for this argument", said.substr(said.find(": ") + 2));
  return error.what();
}

}  // namespace

void tighten(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0) option->disable_flag_override();
    if (!option->get_positional() && option->get_items_expected_max() == 1 &&
        option->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw)
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  }
  for (CLI::App* command : app.get_subcommands({})) tighten(*command);
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const auto [command, path] = reached(app);
  const std::string text = problem(*command, error);
  if (path.empty()) return fmt::format("{}; see \"morsel --help\"", text);
  return fmt::format("{}: {}; see \"morsel {} --help\"", path, text, path);
}

}  // namespace morsel::tools
