// SPDX-License-Identifier: Apache-2.0
#include "tools/parse_values.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "tools/session.h"

namespace morsel::tools {
namespace {

[[noreturn]] void refuse(const std::string& flag, const std::string& text, const char* form) {
  throw UsageError(fmt::format("{} {}: must be {}", flag, text, form));
}

}  // namespace

std::vector<int> parse_integers(const std::string& flag, const std::string& text, char separator,
                                std::size_t count, const char* form) {
  std::vector<int> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (values.size() < count) {
    int value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc()) break;
    values.push_back(value);
    at = rest;
    if (values.size() < count && (at == end || *at++ != separator)) break;
  }
  if (values.size() != count || at != end) refuse(flag, text, form);
  return values;
}

double parse_duration(const std::string& flag, const std::string& text) {
  constexpr const char* kForm = "a time above 0, as in 90s, 15m or 1.5h";
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [unit, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || !std::isfinite(value) || !(value > 0.0)) refuse(flag, text, kForm);
  const std::string name(unit, end);
  if (name.empty() || name == "s") return value;
  if (name == "m") return 60.0 * value;
  if (name == "h") return 3600.0 * value;
  refuse(flag, text, kForm);
}

double parse_percentage(const std::string& flag, const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [unit, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || std::string(unit, end) != "%" || !(value > 0.0 && value <= 100.0))
    refuse(flag, text, "a share of the time, as in 2%");
  return value / 100.0;
}

render::Shard parse_shard(const std::string& flag, const std::string& text) {
  const std::vector<int> values =
      parse_integers(flag, text, '/', 2, "INDEX/COUNT with 0 <= INDEX < COUNT, as in 0/4");
  if (values[0] < 0 || values[0] >= values[1])
    refuse(flag, text, "INDEX/COUNT with 0 <= INDEX < COUNT: shards are counted from 0");
  return {static_cast<std::uint32_t>(values[0]), static_cast<std::uint32_t>(values[1])};
}

}  // namespace morsel::tools
