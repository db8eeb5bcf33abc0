// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/linear_image.h"

#include <OpenImageIO/filesystem.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

namespace morsel::render {
namespace {

float from_srgb(float x) {
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}
// Of images of 8 bits, which have 256 values.
const std::array<float, 256>& srgb_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = from_srgb(static_cast<float>(i) / 255.0f);
    return t;
  }();
  return table;
}

constexpr int kTile = kLinearImageTile;

struct Level {
  int width = 0, height = 0;
  std::vector<float> pixels;
};

// Half the size, rounded down, each texel the mean of the area that it covers.
Level half_of(const Level& from, int channels) {
  Level to{std::max(1, from.width / 2), std::max(1, from.height / 2), {}};
  const auto at = [channels](int x, int y, int width) {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  };
  to.pixels.assign(at(0, to.height, to.width), 0.0f);
  const float across = static_cast<float>(from.width) / static_cast<float>(to.width);
  const float along = static_cast<float>(from.height) / static_cast<float>(to.height);
  // How much of [begin, end) lies in [i, i + 1).
  const auto overlap = [](int i, float begin, float end) {
    return std::min(static_cast<float>(i + 1), end) - std::max(static_cast<float>(i), begin);
  };
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) {
      float* sum = &to.pixels[at(x, y, to.width)];
      const float x0 = static_cast<float>(x) * across, x1 = x0 + across;
      const float y0 = static_cast<float>(y) * along, y1 = y0 + along;
      for (int j = static_cast<int>(y0); j < from.height && static_cast<float>(j) < y1; ++j)
        for (int i = static_cast<int>(x0); i < from.width && static_cast<float>(i) < x1; ++i) {
          const float weight = overlap(i, x0, x1) * overlap(j, y0, y1) / (across * along);
          const float* texel = &from.pixels[at(i, j, from.width)];
          for (int c = 0; c < channels; ++c) sum[c] += weight * texel[c];
        }
    }
  return to;
}

// The decoder by the first bytes: data in memory has no file extension.
const char* name_for(const std::vector<unsigned char>& data) {
  if (data.size() > 3 && data[0] == 0x89 && data[1] == 'P') return "memory.png";
  if (data.size() > 3 && data[0] == 0xff && data[1] == 0xd8) return "memory.jpg";
  if (data.size() > 12 && data[8] == 'W' && data[9] == 'E') return "memory.webp";
  return "memory.png";
}

class LinearImage final : public OIIO::ImageInput {
 public:
  const char* format_name() const override { return "linear"; }
  bool open(const std::string&, OIIO::ImageSpec&) override {
    errorfmt("opened without configuration");
    return false;
  }

  bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
    close();
    const auto* attribute = config.find_attribute("morsel:image");
    if (attribute == nullptr) {
      errorfmt("opened without configuration");
      return false;
    }
    const auto* image = *static_cast<const ImageTexture* const*>(attribute->data());
    if (image->data) {
      memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(
          const_cast<unsigned char*>(image->data->data()), image->data->size());
      inner_ = OIIO::ImageInput::open(name_for(*image->data), nullptr, memory_.get());
    } else {
      inner_ = OIIO::ImageInput::open(image->file);
    }
    if (!inner_) {
      errorfmt("{}", OIIO::geterror());
      return false;
    }
    const OIIO::ImageSpec& from = inner_->spec();
    const bool eight_bit = from.format == OIIO::TypeDesc::UINT8;
    srgb_ = image->color_space == ColorSpace::kSrgb ||
            (image->color_space == ColorSpace::kAuto && eight_bit);
    m_spec = OIIO::ImageSpec(from.width, from.height, from.nchannels,
                             eight_bit ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    m_spec.channelnames = from.channelnames;
    m_spec.alpha_channel = from.alpha_channel;
    m_spec.tile_width = m_spec.tile_height = kTile;
    m_spec.tile_depth = 1;
    eight_bit_ = eight_bit;
    width_ = from.width;
    height_ = from.height;
    level_ = 0;
    spec = m_spec;
    return true;
  }

  // Down to a single texel.
  bool seek_subimage(int subimage, int miplevel) override {
    const lock_guard lock(*this);
    const auto levels =
        static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width_, height_))));
    if (subimage != 0 || miplevel < 0 || miplevel >= levels) return false;
    level_ = miplevel;
    m_spec.width = m_spec.full_width = std::max(1, width_ >> miplevel);
    m_spec.height = m_spec.full_height = std::max(1, height_ >> miplevel);
    return true;
  }
  int current_miplevel() const override {
    const lock_guard lock(*this);
    return level_;
  }

  bool read_native_scanline(int, int, int, int, void*) override {
    errorfmt("read by scanlines");
    return false;
  }

  // The cache asks from many threads at once.
  bool read_native_tile(int subimage, int miplevel, int x, int y, int, void* data) override {
    const lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel) || !decode(static_cast<std::size_t>(miplevel)))
      return false;
    const Level& level = levels_[static_cast<std::size_t>(miplevel)];
    const auto channels = static_cast<std::size_t>(m_spec.nchannels);
    const std::size_t pixel = channels * m_spec.format.size();
    auto* out = static_cast<char*>(data);
    const int columns = std::min(kTile, level.width - x), rows = std::min(kTile, level.height - y);
    if (columns < kTile || rows < kTile) std::memset(out, 0, std::size_t{kTile} * kTile * pixel);
    for (int row = 0; row < rows; ++row) {
      const std::size_t first =
          static_cast<std::size_t>(y + row) * static_cast<std::size_t>(level.width) +
          static_cast<std::size_t>(x);
      if (!OIIO::convert_types(OIIO::TypeDesc::FLOAT, &level.pixels[first * channels],
                               m_spec.format, out + static_cast<std::size_t>(row) * kTile * pixel,
                               columns * m_spec.nchannels))
        return false;
    }
    return true;
  }

  bool close() override {
    inner_.reset();
    memory_.reset();
    levels_.clear();
    return true;
  }

 private:
  // The image at the first request, smaller levels when they are asked for.
  bool decode(std::size_t level) {
    if (levels_.empty() && !decode_image()) return false;
    while (levels_.size() <= level) levels_.push_back(half_of(levels_.back(), m_spec.nchannels));
    return true;
  }

  bool decode_image() {
    const auto channels = static_cast<std::size_t>(m_spec.nchannels);
    Level image{width_, height_, {}};
    image.pixels.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) *
                        channels);
    if (!inner_ || !inner_->read_image(0, 0, 0, m_spec.nchannels, OIIO::TypeDesc::FLOAT,
                                       image.pixels.data())) {
      errorfmt("{}", inner_ ? inner_->geterror() : "not open");
      return false;
    }
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      float& x = image.pixels[i];
      if (!std::isfinite(x)) x = 0.0f;
      if (!srgb_ || static_cast<int>(i % channels) == m_spec.alpha_channel) continue;
      x = eight_bit_
              ? srgb_bytes()[static_cast<std::size_t>(std::clamp(x * 255.0f + 0.5f, 0.0f, 255.0f))]
              : from_srgb(x);
    }
    levels_.push_back(std::move(image));
    return true;
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
  std::unique_ptr<OIIO::ImageInput> inner_;
  std::vector<Level> levels_;
  int width_ = 0, height_ = 0, level_ = 0;
  bool srgb_ = false, eight_bit_ = false;
};

}  // namespace

OIIO::ImageInput* create_linear_image() { return new LinearImage; }

OIIO::ImageSpec linear_image_configuration(const ImageTexture& image) {
  OIIO::ImageSpec config;
  const ImageTexture* pointer = &image;
  config.attribute("morsel:image", OIIO::TypeDesc(OIIO::TypeDesc::PTR), &pointer);
  return config;
}

}  // namespace morsel::render
