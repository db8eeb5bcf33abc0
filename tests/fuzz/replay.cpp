// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target over the files that are given, and over damaged copies of them: the smoke test
// of every build, without libFuzzer. The damage follows a fixed seed. Where the target ends the
// process the input is left in fuzz_failure.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/target.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes current;  // for the handler

extern "C" void keep_input(int signal) {
  const int fd = ::open("fuzz_failure", O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (fd >= 0 && ::write(fd, current.data(), current.size()) < 0) ::close(fd);
  constexpr char kText[] = "The input is in the file fuzz_failure.\n";
  if (::write(2, kText, sizeof kText - 1) < 0) ::_exit(1);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const Bytes& input) {
  current = input;
  LLVMFuzzerTestOneInput(current.data(), current.size());
}

// One to eight changes: bits, bytes, numbers, parts cut out, doubled or taken from another input.
Bytes damaged(Bytes bytes, const std::vector<Bytes>& inputs, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t changes = 1 + below(8); changes > 0; --changes) {
    const std::size_t at = below(bytes.size()), length = 1 + below(1u << below(8));
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(length, bytes.size() - at));
    switch (bytes.empty() ? 5 : below(7)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 2: {  // a digit, or the ends of what an integer holds
        constexpr char kBytes[] = "0123456789-.e\0\xff\x7f\x80";
        bytes[at] = static_cast<std::uint8_t>(kBytes[below(sizeof kBytes - 1)]);
        break;
      }
      case 3:
        bytes.erase(begin, end);
        break;
      case 4: {
        const Bytes part(begin, end);
        bytes.insert(begin, part.begin(), part.end());
        break;
      }
      case 5: {
        const Bytes& other = inputs[below(inputs.size())];
        const std::size_t from = below(other.size());
        const std::size_t count = std::min(length, other.size() - from);
        const auto first = other.begin() + static_cast<std::ptrdiff_t>(from);
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), first,
                     first + static_cast<std::ptrdiff_t>(count));
        break;
      }
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0.0;
  std::uint64_t most = ~std::uint64_t{0};
  int first = 1;
  for (; first + 1 < argc && argv[first][0] == '-'; first += 2) {
    if (std::string(argv[first]) == "-s") seconds = std::atof(argv[first + 1]);
    if (std::string(argv[first]) == "-n") most = std::strtoull(argv[first + 1], nullptr, 10);
  }
  if (first >= argc) {
    std::fprintf(stderr, "Usage: %s [-s SECONDS] [-n INPUTS] FILE...\n", argv[0]);
    return 2;
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL})
    std::signal(signal, keep_input);
  std::vector<Bytes> inputs;
  for (int i = first; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "%s: cannot open\n", argv[i]);
      return 1;
    }
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::uint64_t runs = 0;
  for (const Bytes& input : inputs) run(input), ++runs;
  std::mt19937 random(20261126);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    const auto now = std::chrono::steady_clock::now();
    if (runs >= most || std::chrono::duration<double>(now - start).count() >= seconds) break;
    for (const Bytes& input : inputs) run(damaged(input, inputs, random)), ++runs;
  }
  std::printf("%llu inputs\n", static_cast<unsigned long long>(runs));
  return 0;
}
