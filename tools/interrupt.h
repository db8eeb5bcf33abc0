// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace morsel::tools {

// Keeps SIGINT and SIGTERM back until install_interrupt_handler(), also over an execv(): a program
// that is still being loaded would die of them without a word.
void hold_interrupts();

// Makes the first SIGINT or SIGTERM set the returned flag; the second ends the process. One that
// was held back counts.
const std::atomic<bool>& install_interrupt_handler();

// A file that would pass the limit of its size (ulimit -f) is an error of writing, as on a full
// disk, not the end of the process.
void ignore_file_size_signal();

// From now on SIGUSR1 asks for a picture of what is rendered so far.
void install_picture_handler();
// Whether one was asked for since the last call.
bool take_picture_request();

}  // namespace morsel::tools
