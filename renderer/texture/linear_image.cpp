// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/linear_image.h"

#include <OpenImageIO/filesystem.h>

#include <cmath>
#include <memory>
#include <vector>

namespace morsel::render {
namespace {

float from_srgb(float x) {
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
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
    spec = m_spec;
    return true;
  }

  bool read_native_scanline(int subimage, int miplevel, int y, int, void* data) override {
    if (subimage != 0 || miplevel != 0 || !decode()) return false;
    const auto row =
        static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(m_spec.nchannels);
    return OIIO::convert_types(OIIO::TypeDesc::FLOAT, &pixels_[row * static_cast<std::size_t>(y)],
                               m_spec.format, data, static_cast<int>(row));
  }

  bool close() override {
    inner_.reset();
    memory_.reset();
    pixels_.clear();
    pixels_.shrink_to_fit();
    return true;
  }

 private:
  // All of it at the first request: the cache wants tiles, of which every one crosses many rows.
  bool decode() {
    if (!pixels_.empty()) return true;
    const auto channels = static_cast<std::size_t>(m_spec.nchannels);
    pixels_.resize(static_cast<std::size_t>(m_spec.width) *
                   static_cast<std::size_t>(m_spec.height) * channels);
    if (!inner_ ||
        !inner_->read_image(0, 0, 0, m_spec.nchannels, OIIO::TypeDesc::FLOAT, pixels_.data())) {
      errorfmt("{}", inner_ ? inner_->geterror() : "not open");
      pixels_.clear();
      return false;
    }
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      float& x = pixels_[i];
      if (!std::isfinite(x)) x = 0.0f;
      if (srgb_ && static_cast<int>(i % channels) != m_spec.alpha_channel) x = from_srgb(x);
    }
    return true;
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
  std::unique_ptr<OIIO::ImageInput> inner_;
  std::vector<float> pixels_;
  bool srgb_ = false;
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
