// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

// What materials can vary by, as plain data.
namespace morsel::render {

enum class ColorSpace { kAuto, kSrgb, kLinear };  // kAuto: images of 8 bits are sRGB
enum class Wrap { kRepeat, kClamp, kMirror, kBlack };

// An image by the mesh's texture coordinates, or, for what has none, projected along the three axes
// of object space.
struct ImageTexture {
  std::string file;  // absolute; "<UDIM>" in it stands for the numbers of tiles
  std::shared_ptr<const std::vector<unsigned char>> data;  // the encoded image instead of a file
  std::string description;                                 // of `data`, for messages
  ColorSpace color_space = ColorSpace::kAuto;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  // Texture coordinates are scaled, then turned about (0, 0) (degrees, counter-clockwise), then
  // moved.
  Imath::V2f scale{1.0f, 1.0f}, offset{0.0f, 0.0f};
  float rotation = 0.0f;
  int uv_set = 0;       // of the mesh's texture coordinates, 0 or 1
  bool v_down = false;  // that happens with v counted from the top, as glTF has it
  bool triplanar = false;
  float triplanar_size = 1.0f;  // object-space length that one repetition covers
};

enum class RampInput { kDensity, kNoise, kCurvature, kComponent, kHeight };

// A colour by a number that a point has: of hypertexture the density D (under warps: where they
// took the point), the noise (what the modulations add to D), the mean curvature of the surface (1
// / length, positive where it bulges), the component's number among all; of anything its height
// (object-space y). What lacks the number gets that of `low`.
struct RampTexture {
  RampInput input = RampInput::kNoise;
  float low = 0.0f, high = 1.0f;  // become positions 0 and 1
  struct Stop {
    float position;
    Imath::V3f color;
  };
  std::vector<Stop> stops;  // by position; linear in between, constant beyond
};

// Squares in texture coordinates, or in object space x, y, z where there are none.
struct CheckerTexture {
  Imath::V3f color_a{0.8f}, color_b{0.2f};
  float size = 1.0f;
  bool solid = true;
};

enum class TextureChannel { kRed, kGreen, kBlue, kAlpha, kLuminance };

struct Texture {
  std::string name;
  // The registry: a new kind of texture is a struct here and a file pair in texture/.
  std::variant<ImageTexture, RampTexture, CheckerTexture> kind;
  TextureChannel channel = TextureChannel::kLuminance;  // where a number is wanted
};

inline constexpr std::uint32_t kNoTexture = 0xffffffffu;

// What of a material a texture can vary; each multiplies the material's own value, but for the
// normal and the bump.
enum class MaterialInput {
  kColor,
  kRoughness,
  kMetallic,
  kSpecular,
  kSpecularColor,
  kTransmission,
  kClearcoat,
  kClearcoatRoughness,
  kSheenColor,
  kSheenRoughness,
  kEmission,
  kOpacity,
  kNormal,
  kBump,
  kCount
};
inline constexpr std::size_t kMaterialInputs = static_cast<std::size_t>(MaterialInput::kCount);

}  // namespace morsel::render
