// SPDX-License-Identifier: Apache-2.0
#include "run_command.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

namespace morsel::test {
namespace {

// In the child: file descriptor `fd` becomes `file`.
void redirect(int fd, const std::filesystem::path& file, int flags) {
  const int opened = ::open(file.c_str(), flags, 0600);
  if (opened < 0 || ::dup2(opened, fd) < 0) ::_exit(126);
  ::close(opened);
}

}  // namespace

std::string exr_pixels(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  // Magic number and version; then attributes: name, type, size, value; a zero ends them.
  std::size_t at = 8;
  while (at < text.size() && text[at] != 0) {
    for (int i = 0; i < 2; ++i) at = text.find('\0', at) + 1;
    std::uint32_t size = 0;
    std::memcpy(&size, text.data() + at, sizeof size);
    at += sizeof size + size;
  }
  // Then the table of where the chunks of pixels are, counted from the file's beginning.
  std::uint64_t first = 0;
  if (at + 1 + sizeof first > text.size())
    throw std::runtime_error(file.string() + ": not an EXR file");
  std::memcpy(&first, text.data() + at + 1, sizeof first);
  return text.substr(first);
}

CommandResult run_morsel(const std::vector<std::string>& arguments, const CommandOptions& options) {
  const TemporaryFolder files;
  files.write("in", options.input);
  files.write("out", "");
  files.write("err", "");
  std::filesystem::path program = MORSEL_EXECUTABLE;
  const TemporaryFolder programs;
  if (options.unprivileged) {
    // The build tree may be closed to other users: they get copies.
    using std::filesystem::perms;
    const perms open = perms::owner_all | perms::group_read | perms::group_exec |
                       perms::others_read | perms::others_exec;
    std::filesystem::permissions(programs.path(), open);
    for (const char* name : {"morsel", "morsel-render"}) {
      std::filesystem::copy_file(program.parent_path() / name, programs / name);
      std::filesystem::permissions(programs / name, open);
    }
    program = programs / "morsel";
  }
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    redirect(STDIN_FILENO, files / "in", O_RDONLY);
    redirect(STDOUT_FILENO, options.output.empty() ? files / "out" : options.output, O_WRONLY);
    redirect(STDERR_FILENO, files / "err", O_WRONLY);
    if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
    if (options.file_limit > 0) {
      const rlimit limit{options.file_limit, options.file_limit};
      ::signal(SIGXFSZ, SIG_DFL);  // whoever runs the tests may ignore it
      if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(126);
    }
    if (options.unprivileged && ::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0))
      ::_exit(126);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  if (options.then) options.then(child, files / "err");
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  CommandResult result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_text(files / "out");
  result.err = read_text(files / "err");
  return result;
}

}  // namespace morsel::test
