// SPDX-License-Identifier: Apache-2.0
// What programs that were killed leave behind, and who takes it away.
#include "topology/replacing_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "tests/temporary_folder.h"

namespace morsel::topology {
namespace {

namespace fs = std::filesystem;

// A number that belongs to no process: of a child that has ended and was waited for.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
  return child;
}

class Leftovers : public ::testing::Test {
 protected:
  fs::path leave(const std::string& name, std::chrono::seconds age) {
    const fs::path file = folder_.write(name, "half a cache");
    fs::last_write_time(file, fs::file_time_type::clock::now() - age);
    return file;
  }
  test::TemporaryFolder folder_;
  const fs::path target_ = folder_ / "a.b.topo";
};

constexpr std::chrono::seconds kOld = kLeftoverAge + std::chrono::minutes(1);

TEST_F(Leftovers, OfDeadProcessesGoWithTheNextWrite) {
  const std::string dead = std::to_string(dead_process());
  const fs::path left = leave(".a.b." + dead + ".0.topo", kOld);
  const fs::path other = leave(".a.b." + dead + ".17.topo", kOld);
  { const ReplacingFile file(target_); }
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(other));
}

TEST_F(Leftovers, AllElseStays) {
  const std::string dead = std::to_string(dead_process()), mine = std::to_string(::getpid());
  const std::string parent = std::to_string(::getppid());
  // Written to a moment ago: the process may be one of another machine.
  leave(".a.b." + dead + ".0.topo", std::chrono::seconds(1));
  // Of the living, as which this one counts too.
  leave(".a.b." + mine + ".77.topo", kOld);
  leave(".a.b." + parent + ".0.topo", kOld);
  // Of other names, or names that only look alike.
  for (const std::string& name :
       {".a." + dead + ".0.topo", ".a.b.c." + dead + ".0.topo", "a.b." + dead + ".0.topo",
        ".a.b." + dead + ".topo", ".a.b." + dead + ".0.exr", ".a.b.x" + dead + ".0.topo",
        ".a.b." + dead + ".0x.topo", std::string(".a.b.0.0.topo"), std::string(".a.b.-1.0.topo"),
        std::string(".a.b.99999999999999999999.0.topo"), std::string(".a.b..topo")})
    leave(name, kOld);
  fs::create_directory(folder_ / (".a.b." + dead + ".5.topo"));
  fs::last_write_time(folder_ / (".a.b." + dead + ".5.topo"),
                      fs::file_time_type::clock::now() - kOld);
  const std::size_t before = folder_.count_files();
  ASSERT_EQ(before, 14u);
  { const ReplacingFile file(target_); }
  EXPECT_EQ(folder_.count_files(), before);
  EXPECT_TRUE(fs::is_directory(folder_ / (".a.b." + dead + ".5.topo")));
}

// A link's target is what is replaced, so leftovers are beside it.
TEST_F(Leftovers, AreSoughtWhereALinkPoints) {
  const fs::path link = folder_ / "sub" / "link.topo";
  fs::create_directory(folder_ / "sub");
  folder_.write("a.b.topo", "old");
  fs::create_symlink(target_, link);
  const fs::path left = leave(".a.b." + std::to_string(dead_process()) + ".0.topo", kOld);
  { const ReplacingFile file(link); }
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
}  // namespace morsel::topology
