// SPDX-License-Identifier: Apache-2.0
#include "renderer/film/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace morsel::render::cryptomatte {

std::uint32_t murmur3(std::string_view text) {
  constexpr std::uint32_t kFirst = 0xcc9e2d51u, kSecond = 0x1b873593u;
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  std::uint32_t h = 0;
  const std::size_t blocks = text.size() / 4;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::uint32_t k =
        byte(4 * b) | byte(4 * b + 1) << 8 | byte(4 * b + 2) << 16 | byte(4 * b + 3) << 24;
    k = std::rotl(k * kFirst, 15) * kSecond;
    h = std::rotl(h ^ k, 13) * 5u + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  for (std::size_t i = text.size(); i > 4 * blocks; --i) tail = tail << 8 | byte(i - 1);
  if (text.size() % 4 != 0) h ^= std::rotl(tail * kFirst, 15) * kSecond;
  h ^= static_cast<std::uint32_t>(text.size());
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

std::uint32_t id_of(std::string_view name) {
  std::uint32_t hash = murmur3(name);
  const std::uint32_t exponent = (hash >> 23) & 255u;
  if (exponent == 0 || exponent == 255) hash ^= 1u << 23;
  return hash;
}

float as_float(std::uint32_t id) { return std::bit_cast<float>(id); }

std::string key_of(std::string_view layer) {
  return fmt::format("{:08x}", murmur3(layer)).substr(0, 7);
}

std::string manifest_of(const std::map<std::string, std::uint32_t>& ids) {
  std::string json = "{";
  for (const auto& [name, id] : ids) {
    if (json.size() > 1) json += ',';
    json += '"';
    for (const char c : name) {
      if (c == '"' || c == '\\') json += '\\';
      if (static_cast<unsigned char>(c) < 0x20)
        json += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      else
        json += c;
    }
    json += fmt::format("\":\"{:08x}\"", id);
  }
  return json + "}";
}

void Accumulator::add(std::uint32_t id, std::uint32_t samples) {
  if (id == 0) return;
  for (auto& [known, count] : counts_)
    if (known == id) {
      count += samples;
      return;
    }
  counts_.emplace_back(id, samples);
}

void Accumulator::add(const Accumulator& other) {
  for (const auto& [id, count] : other.counts_) add(id, count);
}

Ranks Accumulator::ranks(std::uint32_t samples) const {
  auto sorted = counts_;
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  Ranks ranks;
  for (std::size_t i = 0; i < std::min(sorted.size(), ranks.size()); ++i)
    ranks[i] = {sorted[i].first,
                static_cast<float>(sorted[i].second) / static_cast<float>(samples)};
  return ranks;
}

}  // namespace morsel::render::cryptomatte
