// SPDX-License-Identifier: Apache-2.0
#include "tools/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace morsel::tools {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch no other");

void on_signal(int) { interrupted.store(true); }

}  // namespace

const std::atomic<bool>& install_interrupt_handler() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  // One shot: the second signal finds the default handler and ends the process.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  return interrupted;
}

}  // namespace morsel::tools
