// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace morsel::tools {

// Makes the first SIGINT or SIGTERM set the returned flag; the second ends the process.
const std::atomic<bool>& install_interrupt_handler();

// From now on SIGUSR1 asks for a picture of what is rendered so far.
void install_picture_handler();
// Whether one was asked for since the last call.
bool take_picture_request();

}  // namespace morsel::tools
