// SPDX-License-Identifier: Apache-2.0
// All commands with all their flags, as `--help` lists them: each flag is in some test, refuses
// what it cannot mean, and every command keeps its results on stdout and all else on stderr. A new
// flag or command is in these tests as soon as it is in `--help`.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

struct Flag {
  std::vector<std::string> names;  // "-o", "--output"
  std::string value;               // the type, as the parser names it; empty: it takes none
};

struct Command {
  std::vector<std::string> words;
  std::vector<Flag> flags;

  std::string path() const {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
  }
  bool has(const std::string& name) const {
    for (const Flag& flag : flags)
      if (std::find(flag.names.begin(), flag.names.end(), name) != flag.names.end()) return true;
    return false;
  }
};

// The command's flags, and those of its subcommands, from what they say of themselves.
void add_commands(const std::vector<std::string>& words, std::vector<Command>& commands) {
  std::vector<std::string> arguments = words;
  arguments.push_back("--help");
  const CommandResult help = run_morsel(arguments);
  ASSERT_EQ(help.code, 0) << help.err;
  ASSERT_EQ(help.err, "");
  Command command{words, {}};
  std::vector<std::string> subcommands;
  bool in_subcommands = false;
  std::istringstream lines(help.out);
  const std::regex flag(R"(^  (-[^ ]*)(?: ((?:TEXT|INT|UINT|FLOAT)[^ ]*))?.*)"),
      word(R"(^  ([a-z]+) .*)");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line == "Subcommands:") in_subcommands = true;
    if (in_subcommands && std::regex_match(line, match, word)) {
      subcommands.push_back(match[1]);
    } else if (std::regex_match(line, match, flag)) {
      Flag found{{}, match[2]};
      std::istringstream names(match[1]);
      for (std::string name; std::getline(names, name, ',');) found.names.push_back(name);
      if (found.names.back() != "--help" && !words.empty()) command.flags.push_back(found);
    }
  }
  if (!command.flags.empty()) commands.push_back(command);
  for (const std::string& sub : subcommands) {
    std::vector<std::string> more = words;
    more.push_back(sub);
    add_commands(more, commands);
  }
}

const std::vector<Command>& all_commands() {
  static const std::vector<Command> commands = [] {
    std::vector<Command> list;
    add_commands({}, list);
    return list;
  }();
  return commands;
}

bool is_part_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-'; }

bool has_word(const std::string& text, const std::string& word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if ((at == 0 || !is_part_of_word(text[at - 1])) &&
        (at + word.size() == text.size() || !is_part_of_word(text[at + word.size()])))
      return true;
  return false;
}

// Whether this test runs the command: as words in quotes or as a line of a script.
bool runs(const std::string& text, const Command& command) {
  std::string quoted;
  for (const std::string& word : command.words)
    quoted += (quoted.empty() ? "\"" : ", \"") + word + "\"";
  return text.find(quoted) != std::string::npos || has_word(text, command.path());
}

TEST(Flags, EachIsUsedByATest) {
  std::map<std::string, std::string> tests;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::string(MORSEL_SOURCE_DIR) + "/tests")) {
    const std::string name = entry.path().filename().string();
    const std::string extension = entry.path().extension().string();
    if (name != "flags_test.cpp" &&
        (extension == ".cpp" || extension == ".sh" || extension == ".py"))
      tests[entry.path().string()] = read_text(entry.path());
  }
  ASSERT_GT(all_commands().size(), 13u);
  // What every command has is tested below, for every command.
  const std::set<std::string> common{"--threads", "--progress", "--log-level",
                                     "--quiet",   "--verbose",  "--set"};
  for (const Command& command : all_commands()) {
    for (const Flag& flag : command.flags) {
      if (common.count(flag.names.back())) continue;
      const bool used = std::any_of(tests.begin(), tests.end(), [&](const auto& test) {
        return runs(test.second, command) &&
               std::any_of(flag.names.begin(), flag.names.end(),
                           [&](const std::string& name) { return has_word(test.second, name); });
      });
      EXPECT_TRUE(used) << "no test uses morsel " << command.path() << ' ' << flag.names.back();
    }
  }
}

class FlagsOnFilesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    folder_->write("scene.json", kCommandScene);
    folder_->write("points.txt", "0 0 0\n");
    // Files that other commands read.
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"cache", "build", "scene.json", "--engine", "both", "-o", "rock.topo"},
             {"cache", "build", "scene.json"},
             {"render", "scene.json", "--shard", "0/2", "-o", "part_0.exr"},
             {"render", "scene.json", "--shard", "1/2", "-o", "part_1.exr"}}) {
      const CommandResult result = run(arguments);
      ASSERT_EQ(result.code, 0) << result.err;
    }
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static CommandResult run(const std::vector<std::string>& arguments) {
    CommandOptions options;
    options.folder = folder_->path();
    return run_morsel(arguments, options);
  }

  // What each command needs to succeed quickly; flags with their values after '='.
  static const std::map<std::string, std::vector<std::string>>& needed() {
    static const std::map<std::string, std::vector<std::string>> table{
        {"bench",
         {"scene.json", "--error=0.05", "--resolution=16", "--repetitions=1", "--render-width=16",
          "--render-spp=1"}},
        {"bench topology", {"scene.json", "--resolution=16"}},
        {"merge", {"part_0.exr", "part_1.exr", "--output=whole.exr"}},
        {"render", {"scene.json"}},
        {"scene check", {"scene.json"}},
        {"scene new", {"new.json", "--force"}},
        {"scene schema", {}},
        {"cache build", {"scene.json"}},
        {"cache compare", {"scene.json", "--engine=certified,voxel", "--resolution=16"}},
        {"cache export", {"rock.topo", "--csv", "--output=points.csv"}},
        {"cache info", {"rock.topo"}},
        {"cache verify", {"rock.topo", "scene.json"}},
        {"field eval", {"scene.json", "--points=points.txt"}},
        {"field sample", {"scene.json", "--resolution=4", "--output=rock.npy"}},
        {"mesh", {"scene.json", "--error=0.1", "--output=rock.ply"}},
    };
    return table;
  }

  // The command with what it needs, but for `flag` and what cannot stand beside it.
  static std::vector<std::string> arguments_of(const Command& command,
                                               const std::string& without = "") {
    std::vector<std::string> arguments = command.words;
    const auto found = needed().find(command.path());
    if (found == needed().end()) {
      ADD_FAILURE() << "say here what morsel " << command.path() << " needs";
      return arguments;
    }
    for (const std::string& argument : found->second)
      if (without.empty() || argument.substr(0, argument.find('=')) != without)
        arguments.push_back(argument);
    return arguments;
  }

  static CommandResult run_with(const Command& command, const std::vector<std::string>& more,
                                const std::string& without = "") {
    std::vector<std::string> arguments = arguments_of(command, without);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* FlagsOnFilesTest::folder_ = nullptr;

TEST_F(FlagsOnFilesTest, EachRefusesNonsenseByName) {
  // Any text is the name of a file that can be written.
  const std::set<std::string> any_text{"bench --html",          "cache build --output",
                                       "cache export --output", "render --cache",
                                       "render --checkpoint",   "scene schema --output"};
  for (const Command& command : all_commands()) {
    for (const Flag& flag : command.flags) {
      const std::string& name = flag.names.back();
      if (flag.value.empty() || any_text.count(command.path() + " " + name)) continue;
      const CommandResult result = run_with(command, {name + "=@"}, name);
      EXPECT_EQ(result.code, 2) << command.path() << ' ' << name << ": " << result.err;
      EXPECT_EQ(result.out, "") << command.path() << ' ' << name;
      const bool named =
          std::any_of(flag.names.begin(), flag.names.end(),
                      [&](const std::string& each) { return has_word(result.err, each); });
      EXPECT_TRUE(named || result.err.find('@') != std::string::npos)
          << command.path() << ' ' << name << " is not named in: " << result.err;
    }
  }
}

TEST_F(FlagsOnFilesTest, ResultsAreOnStdoutAndAllElseOnStderr) {
  for (const Command& command : all_commands()) {
    SCOPED_TRACE(command.path());
    std::vector<std::string> quiet;
    if (command.has("--quiet")) quiet.push_back("--quiet");
    if (command.has("--threads")) quiet.push_back("--threads=1");
    const CommandResult plain = run_with(command, quiet);
    EXPECT_EQ(plain.code, 0) << plain.err;
    EXPECT_EQ(plain.err, "");
    EXPECT_EQ(plain.out.empty(), command.path() == "cache export");
    if (command.has("--json")) {
      // One document and nothing else, whatever is said beside it.
      std::vector<std::string> loud{"--json"};
      if (command.has("--log-level"))
        loud.insert(loud.end(), {"--log-level=debug", "--progress=json"});
      const CommandResult result = run_with(command, loud);
      EXPECT_EQ(result.code, 0) << result.err;
      EXPECT_TRUE(nlohmann::json::accept(result.out)) << result.out;
    }
  }
}

TEST_F(FlagsOnFilesTest, WrongUsageIsToldOnStderrAlone) {
  for (const Command& command : all_commands()) {
    SCOPED_TRACE(command.path());
    const CommandResult unknown = run_with(command, {"--no-such-flag"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_EQ(unknown.out, "");
    EXPECT_NE(unknown.err.find("--no-such-flag"), std::string::npos) << unknown.err;
    if (command.path() == "scene schema") continue;  // needs nothing
    const CommandResult nothing = run(command.words);
    EXPECT_EQ(nothing.code, 2);
    EXPECT_EQ(nothing.out, "");
    EXPECT_NE(nothing.err.find("required"), std::string::npos) << nothing.err;
    if (!command.has("--set")) continue;
    const CommandResult set = run_with(command, {"--set=morsel=0"});
    EXPECT_EQ(set.code, 2);
    // What is wrong with a scene is what `scene check` is asked for.
    const bool check = command.path() == "scene check";
    EXPECT_NE((check ? set.out : set.err).find("set by --set morsel=0"), std::string::npos)
        << set.err;
    EXPECT_EQ(check ? set.err : set.out, "");
  }
}

}  // namespace
}  // namespace morsel::test
