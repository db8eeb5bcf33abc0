// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace morsel::render {

// ID mattes after the specification 1.2 of Cryptomatte (J. Friedman & A. Jones, Psyop): for each
// pixel the names that it shows, as hashes, with their shares.
namespace cryptomatte {

// MurmurHash3_x86_32 (A. Appleby, public domain) with seed 0.
std::uint32_t murmur3(std::string_view text);
// The hash as a float's bits, changed where the float would be denormal, infinite or NaN.
std::uint32_t id_of(std::string_view name);
float as_float(std::uint32_t id);
// The first seven hexadecimal digits of the hash of a layer's name, which keys its metadata.
std::string key_of(std::string_view layer);
// JSON object from names to their hashes as eight hexadecimal digits.
std::string manifest_of(const std::map<std::string, std::uint32_t>& ids);

inline constexpr int kRanks = 6;

struct Rank {
  std::uint32_t id = 0;
  float coverage = 0.0f;
};
// The names with the largest shares first; unused ranks have coverage 0.
using Ranks = std::array<Rank, kRanks>;

// Collects what the samples of one pixel show.
class Accumulator {
 public:
  void clear() { counts_.clear(); }
  using Count = std::pair<std::uint32_t, std::uint32_t>;  // id, samples

  // Samples of a name; id 0: nothing with a name.
  void add(std::uint32_t id, std::uint32_t samples = 1);
  void add(const Accumulator& other);
  // Shares of `samples`.
  Ranks ranks(std::uint32_t samples) const;
  const std::vector<Count>& counts() const { return counts_; }

 private:
  std::vector<Count> counts_;
};

}  // namespace cryptomatte
}  // namespace morsel::render
