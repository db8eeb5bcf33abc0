// SPDX-License-Identifier: Apache-2.0
// Usage, exit codes and streams that all subcommands share.
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "run_command.h"

namespace morsel::test {
namespace {

TEST(Command, HelpAndVersionAreResults) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"},
                                             {"cache", "--help"},
                                             {"cache", "build", "--help"},
                                             {"cache", "info", "--help"},
                                             {"field", "eval", "--help"},
                                             {"field", "sample", "--help"},
                                             {"render", "--help"},
                                             {"scene", "check", "--help"}}) {
    const CommandResult result = run_morsel(arguments);
    EXPECT_EQ(result.code, 0) << arguments[0];
    EXPECT_NE(result.out.find("--help"), std::string::npos) << arguments[0];
    EXPECT_EQ(result.err, "");
  }
  const CommandResult version = run_morsel({"--version"});
  EXPECT_EQ(version.code, 0);
  for (const char* library : {"morsel ", "Embree ", "OpenImageIO ", "oneTBB ", "processor "})
    EXPECT_NE(version.out.find(library), std::string::npos) << version.out;
}

TEST(Command, HelpListsEverySubcommand) {
  const CommandResult result = run_morsel({"--help"});
  for (const char* name : {"render", "scene", "cache", "field"})
    EXPECT_NE(result.out.find(std::string("\n  ") + name), std::string::npos) << result.out;
}

TEST(Command, AnUnknownCommandIsNamedWithTheChoices) {
  const CommandResult result = run_morsel({"rendr", "x.json"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("rendr: unknown command, did you mean \"render\"?; commands: "),
            std::string::npos)
      << result.err;
}

TEST(Command, WrongUsageNamesTheCommandTheWordAndWhatItMayHaveBeen) {
  const TemporaryFolder folder;
  folder.write("a.json", kBallScene);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "a command is required: bench, "},
      {{"cache"}, "cache: a command is required: build, "},
      {{"cache", "bild", "a.json"}, "cache: bild: unknown command, did you mean \"build\"?; "},
      {{"render", "a.json", "--sppp=3"}, "render: --sppp=3: unknown flag, did you mean \"--spp\"?"},
      {{"render", "--otput", "b.exr", "a.json"},
       "render: --otput: unknown flag, did you mean \"--out"},
      {{"render", "a.json", "--samples", "3"}, "--samples: unknown flag, did you mean \"--spp\"?"},
      {{"render", "a.json", "--sampels", "3"}, "--sampels: unknown flag, did you mean \"--spp\"?"},
      {{"render", "a.json", "-z"}, "render: -z: unknown flag; see \"morsel render --help\""},
      {{"render", "a.json", "--foo", "1", "--otput=b.exr", "-z"},
       "render: --foo: unknown flag; --otput=b.exr: unknown flag, did you mean \"--out"},
      {{"cache", "info", "--jsn"}, "cache info: --jsn: unknown flag, did you mean \"--json\"?"},
      {{"cache", "verify", "a.topo", "a.json", "b.json"},
       "cache verify: b.json: there is no place"},
      {{"render"}, "render: SCENE is required; see \"morsel render --help\""},
      {{"render", "a.json", "--spp", "x"}, "render: --spp x: must be a whole number; see"},
      {{"render", "a.json", "--threads", "5000"},
       "render: --threads 5000: must be a whole number from 0 to 4096; see"},
      {{"mesh", "a.json", "--error", "-3"}, "mesh: --error -3: must be a number above 0; see"},
      {{"render", "a.json", "--spp", "--sampels"},
       "render: --spp: a value is missing (a whole number); --sampels: unknown flag, did "
       "you mean \"--spp\"?"},
      {{"render", "a.json", "--spp", "--output", "x.exr"},
       "render: --spp: a value is missing (a whole number); see"},
      {{"render", "a.json", "--spp", "3", "--spp", "-o"},
       "render: --spp: a value is missing (a whole number); see"},
      {{"render", "a.json", "--spp", "3", "--spp", "-x"},
       "render: --spp: a value is missing (a whole number); -x: unknown flag; see"},
      {{"render", "a.json", "--threads", "--spp", "2"},
       "render: --threads: a value is missing (a whole number"},
      {{"mesh", "a.json", "--error", "nan"}, "mesh: --error nan: must be a number above 0; see"},
      {{"mesh", "a.json", "--error", "inf"}, "mesh: --error inf: must be a number above 0; see"},
      {{"mesh", "a.json", "--error", "x"}, "mesh: --error x: must be a number above 0; see"},
      {{"render", "a.json", "--max-brick-file", ""}, "must be a number from 0 to 1e+06; see"},
      {{"bench", "a.json", "--error", "nan"}, "--error nan: must be a number from 1e-07 to 0.1"},
      {{"field", "sample", "a.json", "--resolution", "1"},
       "--resolution 1: must be a whole number from 2 to 8192; see"},
      {{"render", "a.json", "--max-brick-file", "-1"},
       "--max-brick-file -1: must be a number from 0 to 1e+06; see"},
      {{"render", "a.json", "-q=3"}, "-=3: a flag of one letter takes no value"},
      {{"render", "a.json", "--denoise=3"}, "render: --denoise: takes no value; see"},
      {{"render", "a.json", "--no-png=x"}, "render: --no-png: takes no value; see"},
      {{"cache", "info", "a.topo", "--json=foo"}, "cache info: --json: takes no value; see"},
      {{"render", "a.json", "--foo", "--resolution"},
       "render: --foo: unknown flag; --resolution: a value is missing (text"},
      {{"render", "a.json", "--", "--weird"},
       "render: --weird: there is no place for this argument"},
      {{"mesh", "a.json", "-o", "a.stl"}, "mesh: --output: a.stl: must end in .ply, .glb or .obj"},
      {{"render", "a.json", "--spp"}, "render: --spp: a value is missing (a whole number"},
      {{"render", "a.json", "-o"}, "render: --output: a value is missing (text"},
      {{"bench", "topolgy"}, "bench: topolgy: no such file or command, did you mean \"topology\"?"},
      {{"render", "a.json", "--time-limit", "0s"}, "--time-limit 0s: must be a time above 0"},
      {{"--frob"}, "--frob: unknown flag"}};
  for (const auto& [arguments, message] : cases) {
    const CommandResult result = run_morsel(arguments, {.folder = folder.path()});
    EXPECT_EQ(result.code, 2) << message;
    EXPECT_EQ(result.err.find("morsel: error: "), 0u) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << message << '\n' << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
  }
}

// Scripts append theirs to a command that has them already.
TEST(Command, OfAFlagGivenTwiceTheLastCounts) {
  const TemporaryFolder folder;
  folder.write("a.json", kCommandScene);
  const CommandOptions here{.folder = folder.path()};
  EXPECT_EQ(run_morsel({"render", "a.json", "--check", "--spp", "0", "--spp=3"}, here).code, 0);
  EXPECT_EQ(run_morsel({"render", "a.json", "--check", "--spp=3", "--spp", "0"}, here).code, 2);
  const std::vector<std::string> mesh{"mesh", "a.json", "--error", "0.1", "--geometry", "gone"};
  for (const std::string last : {"a.ply", "a.txt"}) {
    std::vector<std::string> arguments = mesh;
    for (const char* word : {"-o", "b.txt", "-o"}) arguments.emplace_back(word);
    arguments.push_back(last);
    const CommandResult result = run_morsel(arguments, here);
    EXPECT_EQ(result.err.find("must end in") == std::string::npos, last == "a.ply") << result.err;
  }
  // Each --set is one of its own, and so is each of a list.
  const CommandResult both = run_morsel(
      {"render", "a.json", "--check", "--set", "render.spp=0", "--set", "render.max_depth=-1"},
      here);
  EXPECT_NE(both.out.find("/render/spp"), std::string::npos) << both.out;
  EXPECT_NE(both.out.find("/render/max_depth"), std::string::npos) << both.out;
}

// While the libraries of the renderer are loaded, there is nobody yet who could tell of a signal.
TEST(Command, AnInterruptBeforeTheProgramHasBegunIsToldToo) {
  const TemporaryFolder folder;
  folder.write("a.json", kCommandScene);
  CommandOptions options{.folder = folder.path()};
  for (const int signal : {SIGTERM, SIGINT}) {
    options.then = [signal](int pid, const std::filesystem::path&) {
      const std::filesystem::path program = "/proc/" + std::to_string(pid) + "/exe";
      for (std::error_code error;
           !std::filesystem::read_symlink(program, error).string().ends_with("morsel-render");)
        if (error) return;
      ::kill(pid, signal);
    };
    const CommandResult result =
        run_morsel({"render", "a.json", "--spp", "100000", "--progress", "none"}, options);
    EXPECT_EQ(result.code, 130);
    EXPECT_NE(result.err.find("morsel: error: interrupted"), std::string::npos) << result.err;
  }
}

TEST(Command, WrongUsageExitsWith2AndSaysSoOnStderr) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"cook"},
                                             {"cache"},
                                             {"cache", "info"},
                                             {"cache", "info", "x.topo", "--frob"},
                                             {"cache", "info", "x.topo", "--keep", "most"},
                                             {"render"},
                                             {"render", "x.json", "--progress", "loud"},
                                             {"render", "x.json", "--threads", "many"},
                                             {"render", "x.json", "--set", "spp"},
                                             {"field", "sample", "x.json", "--resolution", "1"}}) {
    const CommandResult result = run_morsel(arguments);
    std::string line;
    for (const std::string& word : arguments) line += word + " ";
    EXPECT_EQ(result.code, 2) << line << result.err;
    EXPECT_EQ(result.out, "") << line;
    EXPECT_NE(result.err, "") << line;
  }
}

TEST(Command, InvalidScenesExitWith2) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", kCommandScene).string();
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"render", (folder / "gone.json").string()},
           {"render", scene, "--spp", "0"},
           {"render", scene, "--resolution", "0x10"},
           {"render", scene, "--resolution", "10"},
           {"render", scene, "--crop", "0,0,33,24"},
           {"render", scene, "--crop", "5,5,5,6"},
           {"render", scene, "--crop", "0,0,1"},
           {"render", scene, "--keep", "most"},
           {"render", scene, "--stats", "xml"},
           {"render", scene, "-o", "a.jpg"},
           {"render", scene, "--set", "camera.fov=3"},
           {"scene", "check", scene, "--set", "camera.fov=3"},
           {"cache", "build", scene, "--geometry", "rok"},
           {"cache", "build", scene, "--set", "geometries.rock.max_depth=99"},
           {"field", "eval", scene, "--geometry", "floor", "--points", "-"},
           {"field", "sample", scene, "--resolution", "4", "-o", "a.txt"}}) {
    const CommandResult result = run_morsel(arguments, {.folder = folder.path()});
    std::string line;
    for (const std::string& word : arguments) line += word + " ";
    EXPECT_EQ(result.code, 2) << line << result.err;
    EXPECT_EQ(folder.count_files(), 1u) << line << "left something";
  }
}

TEST(Command, FlagsAreNamedInErrorsOfTheScene) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", kCommandScene).string();
  const CommandResult result = run_morsel({"render", scene, "--spp", "0"});
  EXPECT_NE(result.err.find(scene + ": /render/spp: 0 is out of range"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("(set by --spp 0)"), std::string::npos) << result.err;
}

TEST(Command, AFullDiskIsAFailure) {
  ASSERT_TRUE(std::filesystem::exists("/dev/full")) << "Linux has this device everywhere";
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", kBallScene).string();
  CommandOptions options;
  options.input = "0 0 0\n";
  options.output = "/dev/full";
  EXPECT_EQ(run_morsel({"field", "eval", scene, "--points", "-"}, options).code, 1);
}

// Nor does a log that cannot be written change what a command does.
TEST(Command, AFullDiskForMessagesChangesNothing) {
  const TemporaryFolder folder;
  CommandOptions full;
  full.file_limit = 1;
  EXPECT_EQ(run_morsel({"cache", "info", (folder / "none.topo").string()}, full).code, 1);
  EXPECT_EQ(run_morsel({"cache", "info"}, full).code, 2);
  // Progress, from any thread.
  const std::string scene = folder.write("scene.json", kCommandScene).string();
  full.output = "/dev/null";
  const std::vector<std::string> compare{"cache", "compare", scene, "--engine", "certified"};
  for (const char* style : {"bar", "plain", "json"}) {
    std::vector<std::string> arguments = compare;
    arguments.insert(arguments.end(), {"--progress", style});
    EXPECT_EQ(run_morsel(arguments, full).code, 0) << style;
  }
}

}  // namespace
}  // namespace morsel::test
