// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "renderer/scene/declarations.h"
#include "renderer/scene/readers.h"

namespace morsel::render {
namespace {

using nlohmann::json;
using params::JsonReader;
using params::Place;

template <class Enum>
Enum choice(const std::string& name, std::initializer_list<std::pair<const char*, Enum>> known) {
  for (const auto& [text, value] : known)
    if (name == text) return value;
  return known.begin()->second;
}

Imath::V2f pair(const JsonReader& reader, const char* name) {
  return Imath::V2f(reader.vector2(name));
}

ImageTexture read_image(const JsonReader& reader) {
  ImageTexture image;
  image.file = reader.string("file");
  image.color_space = choice<ColorSpace>(
      reader.string("color_space"),
      {{"auto", ColorSpace::kAuto}, {"srgb", ColorSpace::kSrgb}, {"linear", ColorSpace::kLinear}});
  const auto wrap = [&](const char* name) {
    return choice<Wrap>(reader.string(name), {{"repeat", Wrap::kRepeat},
                                              {"clamp", Wrap::kClamp},
                                              {"mirror", Wrap::kMirror},
                                              {"black", Wrap::kBlack}});
  };
  image.wrap_u = wrap("wrap_u");
  image.wrap_v = wrap("wrap_v");
  image.scale = pair(reader, "scale");
  image.offset = pair(reader, "offset");
  image.rotation = static_cast<float>(reader.number("rotation"));
  image.uv_set = static_cast<int>(reader.integer("uv_set"));
  image.triplanar = reader.string("mapping") == "triplanar";
  image.triplanar_size = static_cast<float>(reader.number("size"));
  return image;
}

RampTexture read_ramp(const JsonReader& reader) {
  RampTexture ramp;
  ramp.input = choice<RampInput>(reader.string("input"), {{"density", RampInput::kDensity},
                                                          {"noise", RampInput::kNoise},
                                                          {"curvature", RampInput::kCurvature},
                                                          {"component", RampInput::kComponent},
                                                          {"height", RampInput::kHeight}});
  ramp.low = static_cast<float>(reader.number("low"));
  ramp.high = static_cast<float>(reader.number("high"));
  if (ramp.low == ramp.high) reader.place("high").fail("must differ from low");
  const json& stops = reader.object("stops");
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const json& stop = stops[i];
    const Place place = reader.place("stops") / i;
    const bool shaped = stop.is_array() && stop.size() == 2 && stop[0].is_number() &&
                        stop[1].is_array() && stop[1].size() == 3 && stop[1][0].is_number() &&
                        stop[1][1].is_number() && stop[1][2].is_number();
    if (!shaped) place.fail("must be [position, [r, g, b]], but is " + stop.dump());
    RampTexture::Stop read{stop[0].get<float>(), Imath::V3f(0.0f)};
    for (int c = 0; c < 3; ++c) {
      read.color[c] = stop[1][static_cast<std::size_t>(c)].get<float>();
      if (!(read.color[c] >= 0.0f && read.color[c] <= 1.0f))
        place.fail("its colour must be in [0, 1], but is " + stop[1].dump());
    }
    if (!ramp.stops.empty() && read.position < ramp.stops.back().position)
      place.fail("positions must not decrease");
    ramp.stops.push_back(read);
  }
  return ramp;
}

}  // namespace

Texture read_texture(const json& object, const Place& place) {
  const std::string type = params::type_of(object, {"image", "ramp", "checker"}, place);
  Texture texture;
  if (type == "image") {
    const JsonReader reader(object, image_texture_declaration(), place);
    texture.name = reader.string("name");
    texture.kind = read_image(reader);
    texture.channel =
        choice<TextureChannel>(reader.string("channel"), {{"luminance", TextureChannel::kLuminance},
                                                          {"red", TextureChannel::kRed},
                                                          {"green", TextureChannel::kGreen},
                                                          {"blue", TextureChannel::kBlue},
                                                          {"alpha", TextureChannel::kAlpha}});
  } else if (type == "ramp") {
    const JsonReader reader(object, ramp_texture_declaration(), place);
    texture.name = reader.string("name");
    texture.kind = read_ramp(reader);
  } else {
    const JsonReader reader(object, checker_texture_declaration(), place);
    texture.name = reader.string("name");
    CheckerTexture checker;
    const auto color = [&](const char* name) { return Imath::V3f(reader.vector3(name)); };
    checker.color_a = color("color_a");
    checker.color_b = color("color_b");
    checker.size = static_cast<float>(reader.number("size"));
    checker.solid = reader.string("mapping") == "solid";
    texture.kind = checker;
  }
  return texture;
}

void read_material_textures(const JsonReader& reader, std::initializer_list<MaterialInput> inputs,
                            Scene& scene, Material& material) {
  std::vector<std::string> known;
  for (const Texture& t : scene.textures) known.push_back(t.name);
  for (const MaterialInput input : inputs) {
    const std::string key = texture_key(input);
    if (!reader.has(key)) continue;
    const std::string name = reader.string(key);
    std::uint32_t index = find_name(name, known, "texture", reader.place(key));
    // Images of numbers are not encoded as sRGB.
    const bool color = input == MaterialInput::kColor || input == MaterialInput::kSpecularColor ||
                       input == MaterialInput::kSheenColor || input == MaterialInput::kEmission;
    const auto* image = std::get_if<ImageTexture>(&scene.textures[index].kind);
    if (!color && image != nullptr && image->color_space == ColorSpace::kAuto) {
      Texture linear = scene.textures[index];
      std::get<ImageTexture>(linear.kind).color_space = ColorSpace::kLinear;
      index = static_cast<std::uint32_t>(scene.textures.size());
      scene.textures.push_back(std::move(linear));
    }
    material.texture(input) = index;
  }
}

const char* texture_key(MaterialInput input) {
  static const char* const keys[] = {"color_texture",          "roughness_texture",
                                     "metallic_texture",       "specular_texture",
                                     "specular_color_texture", "transmission_texture",
                                     "clearcoat_texture",      "clearcoat_roughness_texture",
                                     "sheen_color_texture",    "sheen_roughness_texture",
                                     "emission_texture",       "opacity_texture",
                                     "normal_texture",         "bump_texture"};
  static_assert(std::size(keys) == kMaterialInputs);
  return keys[static_cast<std::size_t>(input)];
}

}  // namespace morsel::render
