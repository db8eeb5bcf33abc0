// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace morsel::topology {

// 32 hexadecimal digits that tell these bytes from all others that occur (XXH3, 128 bits): against
// mistakes, not against forgery.
std::string fingerprint(std::span<const std::byte> bytes);

}  // namespace morsel::topology
