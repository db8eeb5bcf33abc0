// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace morsel::tools {

// Makes the first SIGINT or SIGTERM set the returned flag; the second ends the process.
const std::atomic<bool>& install_interrupt_handler();

}  // namespace morsel::tools
