// SPDX-License-Identifier: Apache-2.0
#include "tools/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace morsel::tools {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch no other");

std::atomic<bool> picture_requested{false};

void on_signal(int signal) {
  if (!interrupted.exchange(true)) return;
  // The second, whichever of the two it is: as if there were no handler.
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

sigset_t interrupts() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

void on_picture_signal(int) { picture_requested.store(true); }

}  // namespace

void hold_interrupts() {
  const sigset_t set = interrupts();
  sigprocmask(SIG_BLOCK, &set, nullptr);
}

const std::atomic<bool>& install_interrupt_handler() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  const sigset_t set = interrupts();
  sigprocmask(SIG_UNBLOCK, &set, nullptr);
  return interrupted;
}

void ignore_file_size_signal() { std::signal(SIGXFSZ, SIG_IGN); }

void install_picture_handler() {
  struct sigaction action = {};
  action.sa_handler = on_picture_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGUSR1, &action, nullptr);
}

bool take_picture_request() { return picture_requested.exchange(false); }

}  // namespace morsel::tools
