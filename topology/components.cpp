// SPDX-License-Identifier: Apache-2.0
#include "topology/components.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "topology/octree.h"

namespace morsel::topology {
namespace {

[[noreturn]] void bad_rule(const std::string& text, const std::string& why) {
  throw std::invalid_argument(
      fmt::format("keep rule \"{}\": {}; choices: main, largest:K, volume:V, touching:X,Y,Z, all, "
                  "detached, ids:I,J,...",
                  text, why));
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

template <class T>
T number(const std::string& rule, const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    bad_rule(rule, fmt::format("bad number \"{}\"", text));
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(value)) bad_rule(rule, fmt::format("\"{}\" is not finite", text));
  return value;
}

}  // namespace

KeepRule KeepRule::parse(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const bool has_argument = colon != std::string::npos;
  const std::string argument = has_argument ? text.substr(colon + 1) : "";
  KeepRule rule;
  const auto plain = [&](Kind one) {
    if (has_argument) bad_rule(text, fmt::format("{} takes no argument", name));
    rule.kind = one;
  };
  if (name == "main") {
    plain(Kind::kMain);
  } else if (name == "all") {
    plain(Kind::kAll);
  } else if (name == "detached") {
    plain(Kind::kDetached);
  } else if (name == "largest") {
    rule.kind = Kind::kLargest;
    rule.count = number<std::uint64_t>(text, argument);
  } else if (name == "volume") {
    rule.kind = Kind::kVolume;
    rule.volume = number<double>(text, argument);
    if (rule.volume < 0.0) bad_rule(text, "a volume cannot be negative");
  } else if (name == "touching") {
    rule.kind = Kind::kTouching;
    const std::vector<std::string> parts = split(argument);
    if (parts.size() != 3) bad_rule(text, "needs three coordinates");
    for (int i = 0; i < 3; ++i) rule.point[i] = number<double>(text, parts[i]);
  } else if (name == "ids") {
    rule.kind = Kind::kIds;
    for (const std::string& part : split(argument))
      rule.ids.push_back(number<std::uint32_t>(text, part));
  } else {
    bad_rule(text, "unknown rule");
  }
  return rule;
}

std::string KeepRule::to_string() const {
  switch (kind) {
    case Kind::kMain:
      return "main";
    case Kind::kLargest:
      return fmt::format("largest:{}", count);
    case Kind::kVolume:
      return fmt::format("volume:{}", volume);
    case Kind::kTouching:
      return fmt::format("touching:{},{},{}", point.x, point.y, point.z);
    case Kind::kAll:
      return "all";
    case Kind::kDetached:
      return "detached";
    case Kind::kIds: {
      std::string text = "ids:";
      for (std::size_t i = 0; i < ids.size(); ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ",", ids[i]);
      return text;
    }
  }
  return "";
}

std::uint32_t main_component(const std::vector<Component>& components) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < components.size(); ++i)
    if (components[i].maxima > components[best].maxima) best = i;
  return best;
}

std::vector<bool> kept_components(const KeepRule& rule, const std::vector<Component>& components,
                                  const OctreeView& octree) {
  std::vector<bool> kept(components.size(), false);
  if (components.empty()) return kept;
  const std::uint32_t main = main_component(components);
  switch (rule.kind) {
    case KeepRule::Kind::kMain:
      kept[main] = true;
      break;
    case KeepRule::Kind::kLargest:  // ids are by decreasing volume
      std::fill(kept.begin(),
                kept.begin() +
                    static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(rule.count, kept.size())),
                true);
      break;
    case KeepRule::Kind::kVolume:
      for (std::size_t i = 0; i < kept.size(); ++i)
        kept[i] = components[i].volume_hi >= rule.volume;
      break;
    case KeepRule::Kind::kTouching: {
      if (!octree.box.intersects(rule.point)) break;
      const std::uint32_t id = octree.nodes[octree.locate(rule.point).node].component;
      if (id != kNoComponent) kept[id] = true;
      break;
    }
    case KeepRule::Kind::kAll:
      kept.assign(kept.size(), true);
      break;
    case KeepRule::Kind::kDetached:
      kept.assign(kept.size(), true);
      kept[main] = false;
      break;
    case KeepRule::Kind::kIds:
      for (const std::uint32_t id : rule.ids) {
        if (id >= kept.size())
          throw std::invalid_argument(
              fmt::format("keep rule \"{}\": there is no component {}; there are {}",
                          rule.to_string(), id, kept.size()));
        kept[id] = true;
      }
      break;
  }
  return kept;
}

}  // namespace morsel::topology
