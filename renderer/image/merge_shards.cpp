// SPDX-License-Identifier: Apache-2.0
#include "renderer/image/merge_shards.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>

#include "renderer/image/denoise.h"
#include "renderer/image/shard_layers.h"

namespace morsel::render {
namespace {

int whole(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::IntAttribute>(name);
  return attribute != nullptr ? attribute->value() : 0;
}

[[noreturn]] void refuse(const ShardFile& shard, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", shard.file.string(), why));
}

// Of one render, not given before.
void check(const ShardFile& shard, const ShardFile& first,
           const std::map<std::uint32_t, std::filesystem::path>& seen) {
  const std::string& other = first.file.string();
  if (shard.scene_hash != first.scene_hash)
    refuse(shard, fmt::format("is of another scene than {}, or the scene was changed between them "
                              "(hashes {} and {})",
                              other, shard.scene_hash, first.scene_hash));
  if (shard.spp != first.spp)
    refuse(shard, fmt::format("was rendered for {} samples a pixel, {} for {}", shard.spp, other,
                              first.spp));
  if (shard.sums->shard().count != first.sums->shard().count)
    refuse(shard, fmt::format("is one of {} shards, {} one of {}", shard.sums->shard().count, other,
                              first.sums->shard().count));
  if (shard.sums->layout() != first.sums->layout())
    refuse(shard, fmt::format("has another size, crop or set of layers than {}", other));
  const auto same = seen.find(shard.sums->shard().index);
  if (same != seen.end())
    refuse(shard, fmt::format("is shard {} of {}, as {} is", shard.sums->shard().index,
                              shard.sums->shard().count, same->second.string()));
}

// Attributes that are sums, and the mattes' manifests, which list what each shard has met.
void add_attributes(Imf::Header& to, const Imf::Header& from) {
  for (auto it = from.begin(); it != from.end(); ++it) {
    const std::string name = it.name();
    if (name == "morsel:renderSeconds" || name == "morsel:rays" ||
        name.starts_with("morsel:seconds:")) {
      auto* sum = to.findTypedAttribute<Imf::DoubleAttribute>(name);
      const auto* more = from.findTypedAttribute<Imf::DoubleAttribute>(name);
      if (sum != nullptr && more != nullptr) sum->value() += more->value();
    }
    if (!name.starts_with("cryptomatte/") || !name.ends_with("/manifest")) continue;
    auto* manifest = to.findTypedAttribute<Imf::StringAttribute>(name);
    const auto* more = from.findTypedAttribute<Imf::StringAttribute>(name);
    if (manifest == nullptr || more == nullptr) continue;
    nlohmann::json names = nlohmann::json::parse(manifest->value());
    names.update(nlohmann::json::parse(more->value()));
    manifest->value() = names.dump();
  }
}

// By copying the others: Header::erase of OpenEXR 3.1 loses the memory of what it takes out.
Imf::Header without_what_is_of_shards(const Imf::Header& header) {
  static const std::set<std::string_view> kOfShards{"morsel:shardFormat", "morsel:shard",
                                                    "morsel:sceneHash", "morsel:denoise",
                                                    "morsel:lightGroups"};
  Imf::Header rest;
  for (auto i = header.begin(); i != header.end(); ++i)
    if (!kOfShards.contains(i.name())) rest.insert(i.name(), i.attribute());
  return rest;
}

}  // namespace

MergedShards merge_shards(const std::vector<std::filesystem::path>& files,
                          const std::filesystem::path& exr) {
  if (files.empty()) throw std::runtime_error("no shards to merge");
  std::map<std::uint32_t, std::filesystem::path> seen;
  std::vector<std::filesystem::path> unfinished;
  ShardFile whole_picture = read_shard(files.front());
  for (std::size_t i = 0; i < files.size(); ++i) {
    ShardFile next;
    if (i > 0) {
      next = read_shard(files[i]);
      check(next, whole_picture, seen);
      whole_picture.sums->add(*next.sums);
      add_attributes(whole_picture.header, next.header);
    }
    const ShardFile& shard = i > 0 ? next : whole_picture;
    seen[shard.sums->shard().index] = shard.file;
    if (whole(shard.header, "morsel:complete") == 0) unfinished.push_back(shard.file);
  }

  FilmSums& sums = *whole_picture.sums;
  const std::uint32_t count = sums.shard().count;
  MergedShards merged{sums.develop(),       {}, 0.0f, whole_picture.spp, count, {},
                      std::move(unfinished)};
  for (std::uint32_t i = 0; i < count; ++i)
    if (!seen.contains(i)) merged.missing.push_back(i);

  Imf::Header header = without_what_is_of_shards(whole_picture.header);
  if (const auto* exposure = header.findTypedAttribute<Imf::FloatAttribute>("morsel:exposure"))
    merged.exposure = exposure->value();
  header.channels() = Imf::ChannelList();
  if (whole(whole_picture.header, "morsel:denoise") != 0 && !denoiser_version().empty()) {
    merged.denoised = denoise(merged.film);
    header.insert("morsel:denoiser",
                  Imf::StringAttribute("Open Image Denoise " + denoiser_version()));
  }
  header.insert("morsel:complete",
                Imf::IntAttribute(merged.missing.empty() && merged.unfinished.empty()));
  header.insert("morsel:fireflyPixels",
                Imf::DoubleAttribute(static_cast<double>(sums.fireflies().pixels)));
  write_planes(exr, header,
               picture_channels(whole_picture.light_groups, merged.film, merged.denoised),
               merged.film);
  return merged;
}

}  // namespace morsel::render
