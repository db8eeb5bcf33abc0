// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace morsel::tools {

// Version of morsel, of the libraries it was built with, and what the processor offers.
std::string version_text();

}  // namespace morsel::tools
