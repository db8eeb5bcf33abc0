// SPDX-License-Identifier: Apache-2.0
#include "renderer/mesh/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

namespace morsel::render {
namespace {

using Imath::V3f;

const tinygltf::Value* member(const tinygltf::Value& object, const char* key) {
  return object.IsObject() && object.Has(key) ? &object.Get(key) : nullptr;
}

float number(const tinygltf::Value& object, const char* key, double fallback) {
  const tinygltf::Value* v = member(object, key);
  return static_cast<float>(v != nullptr && v->IsNumber() ? v->GetNumberAsDouble() : fallback);
}

V3f color(const tinygltf::Value& object, const char* key, const V3f& fallback) {
  const tinygltf::Value* v = member(object, key);
  if (v == nullptr || !v->IsArray() || v->ArrayLen() < 3) return fallback;
  V3f c;
  for (int i = 0; i < 3; ++i) c[i] = static_cast<float>(v->Get(i).GetNumberAsDouble());
  return c;
}

V3f color(const std::vector<double>& values, const V3f& fallback) {
  if (values.size() < 3) return fallback;
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

constexpr std::string_view kUnderstood[] = {
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume"};

// A colour or number outside [0, 1] is the file's mistake; the BSDFs rely on the range.
float share(double x) { return std::clamp(static_cast<float>(x), 0.0f, 1.0f); }
V3f shares(const V3f& c) { return {share(c.x), share(c.y), share(c.z)}; }

class Converter {
 public:
  Converter(const tinygltf::Model& model, const std::function<void(const std::string&)>& warn,
            Scene& scene)
      : model_(model), warn_(warn), scene_(scene) {}

  Material convert(const tinygltf::Material& from, std::size_t index) {
    material_ = Material();
    Material& m = material_;
    m.type = MaterialType::kPrincipled;
    m.name = from.name.empty() ? fmt::format("material {}", index) : from.name;
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    m.color = shares(color(pbr.baseColorFactor, V3f(1.0f)));
    m.metallic = share(pbr.metallicFactor);
    m.roughness = share(pbr.roughnessFactor);
    m.emission = color(from.emissiveFactor, V3f(0.0f));
    const auto of = [](const auto& t) { return Slot{t.index, t.texCoord, &t.extensions}; };
    set(MaterialInput::kColor, of(pbr.baseColorTexture), ColorSpace::kSrgb,
        TextureChannel::kLuminance);
    set(MaterialInput::kRoughness, of(pbr.metallicRoughnessTexture), ColorSpace::kLinear,
        TextureChannel::kGreen);
    set(MaterialInput::kMetallic, of(pbr.metallicRoughnessTexture), ColorSpace::kLinear,
        TextureChannel::kBlue);
    set(MaterialInput::kEmission, of(from.emissiveTexture), ColorSpace::kSrgb,
        TextureChannel::kLuminance);
    set(MaterialInput::kNormal, of(from.normalTexture), ColorSpace::kLinear,
        TextureChannel::kLuminance);
    m.normal_scale = static_cast<float>(from.normalTexture.scale);
    if (from.alphaMode != "OPAQUE" && !from.alphaMode.empty()) {
      m.opacity = pbr.baseColorFactor.size() > 3 ? share(pbr.baseColorFactor[3]) : 1.0f;
      set(MaterialInput::kOpacity, of(pbr.baseColorTexture), ColorSpace::kSrgb,
          TextureChannel::kAlpha);
      if (from.alphaMode == "MASK") m.opacity_cutoff = share(from.alphaCutoff);
    }
    extensions(from);
    return m;
  }

 private:
  struct Slot {
    int index;
    int set;
    const tinygltf::ExtensionMap* extensions;
  };

  void extensions(const tinygltf::Material& from) {
    Material& m = material_;
    for (const auto& [name, value] : from.extensions)
      if (std::find(std::begin(kUnderstood), std::end(kUnderstood), name) == std::end(kUnderstood))
        warn_(fmt::format("material \"{}\": the extension {} is not supported and left out", m.name,
                          name));
    const auto with = [&](const char* name, const auto& read) {
      const auto it = from.extensions.find(name);
      if (it != from.extensions.end()) read(it->second);
    };
    with("KHR_materials_emissive_strength",
         [&](const auto& e) { m.emission *= number(e, "emissiveStrength", 1.0); });
    with("KHR_materials_ior", [&](const auto& e) {
      const float ior = number(e, "ior", 1.5);
      m.ior = ior >= 1.0f ? std::min(ior, 10.0f) : 10.0f;  // 0 stands for a reflectance of 1
    });
    with("KHR_materials_specular", [&](const auto& e) {
      m.specular = share(number(e, "specularFactor", 1.0));
      m.specular_color = color(e, "specularColorFactor", V3f(1.0f));
      set(MaterialInput::kSpecular, e, "specularTexture", ColorSpace::kLinear,
          TextureChannel::kAlpha);
      set(MaterialInput::kSpecularColor, e, "specularColorTexture", ColorSpace::kSrgb,
          TextureChannel::kLuminance);
    });
    with("KHR_materials_clearcoat", [&](const auto& e) {
      m.clearcoat = share(number(e, "clearcoatFactor", 0.0));
      m.clearcoat_roughness = share(number(e, "clearcoatRoughnessFactor", 0.0));
      set(MaterialInput::kClearcoat, e, "clearcoatTexture", ColorSpace::kLinear,
          TextureChannel::kRed);
      set(MaterialInput::kClearcoatRoughness, e, "clearcoatRoughnessTexture", ColorSpace::kLinear,
          TextureChannel::kGreen);
    });
    with("KHR_materials_sheen", [&](const auto& e) {
      m.sheen_color = shares(color(e, "sheenColorFactor", V3f(0.0f)));
      m.sheen_roughness = share(number(e, "sheenRoughnessFactor", 0.0));
      set(MaterialInput::kSheenColor, e, "sheenColorTexture", ColorSpace::kSrgb,
          TextureChannel::kLuminance);
      set(MaterialInput::kSheenRoughness, e, "sheenRoughnessTexture", ColorSpace::kLinear,
          TextureChannel::kAlpha);
    });
    with("KHR_materials_transmission", [&](const auto& e) {
      m.transmission = share(number(e, "transmissionFactor", 0.0));
      m.thin = true;  // unless there is a volume
      set(MaterialInput::kTransmission, e, "transmissionTexture", ColorSpace::kLinear,
          TextureChannel::kRed);
    });
    with("KHR_materials_volume", [&](const auto& e) {
      m.thin = !(number(e, "thicknessFactor", 0.0) > 0.0f);
      const float distance = number(e, "attenuationDistance", 0.0);
      m.attenuation_distance = std::isfinite(distance) ? std::max(0.0f, distance) : 0.0f;
      m.attenuation_color = shares(color(e, "attenuationColor", V3f(1.0f)));
      m.color_tints_volume = true;
    });
    with("KHR_materials_pbrSpecularGlossiness", [&](const auto& e) {
      m.color = shares(color(e, "diffuseFactor", V3f(1.0f)));
      m.metallic = 0.0f;
      m.specular_color = color(e, "specularFactor", V3f(1.0f)) / 0.04f;  // over that of index 1.5
      m.roughness = 1.0f - share(number(e, "glossinessFactor", 1.0));
      set(MaterialInput::kColor, e, "diffuseTexture", ColorSpace::kSrgb,
          TextureChannel::kLuminance);
      if (e.Has("specularGlossinessTexture"))
        warn_(
            fmt::format("material \"{}\": the specularGlossinessTexture is not supported and left "
                        "out",
                        m.name));
    });
    with("KHR_materials_unlit", [&](const auto&) {
      m.emission = m.color;
      m.texture(MaterialInput::kEmission) = m.texture(MaterialInput::kColor);
      m.color = V3f(0.0f);
      m.specular = 0.0f;
      m.metallic = 0.0f;
    });
  }

  void set(MaterialInput input, const tinygltf::Value& object, const char* key, ColorSpace space,
           TextureChannel channel) {
    const tinygltf::Value* info = member(object, key);
    if (info == nullptr) return;
    tinygltf::ExtensionMap extensions;
    if (const tinygltf::Value* e = member(*info, "extensions"))
      for (const std::string& name : e->Keys()) extensions[name] = e->Get(name);
    set(input,
        Slot{static_cast<int>(number(*info, "index", -1)),
             static_cast<int>(number(*info, "texCoord", 0)), &extensions},
        space, channel);
  }

  void set(MaterialInput input, const Slot& slot, ColorSpace space, TextureChannel channel) {
    if (slot.index < 0) return;
    if (static_cast<std::size_t>(slot.index) >= model_.textures.size())
      throw GltfError(
          fmt::format("material \"{}\" names texture {}, which does not exist; there are {}",
                      material_.name, slot.index, model_.textures.size()));
    const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(slot.index)];
    int source = texture.source;
    if (const auto webp = texture.extensions.find("EXT_texture_webp");
        webp != texture.extensions.end())
      source = static_cast<int>(number(webp->second, "source", source));
    if (source < 0) {
      warn_(
          fmt::format("texture {} of material \"{}\" has no image of a kind that can be read{}; "
                      "it is left out",
                      slot.index, material_.name, extensions_of(texture)));
      return;
    }
    if (static_cast<std::size_t>(source) >= model_.images.size())
      throw GltfError(fmt::format("texture {} names image {}, which does not exist; there are {}",
                                  slot.index, source, model_.images.size()));
    int set = slot.set;
    ImageTexture image = image_of(model_.images[static_cast<std::size_t>(source)], source);
    image.color_space = space;
    image.v_down = true;
    if (texture.sampler >= 0 &&
        static_cast<std::size_t>(texture.sampler) < model_.samplers.size()) {
      const tinygltf::Sampler& sampler = model_.samplers[static_cast<std::size_t>(texture.sampler)];
      image.wrap_u = wrap_of(sampler.wrapS);
      image.wrap_v = wrap_of(sampler.wrapT);
    }
    const auto transform = slot.extensions->find("KHR_texture_transform");
    if (transform != slot.extensions->end()) {
      const auto pair = [&](const char* key, float fallback) {
        const tinygltf::Value* v = member(transform->second, key);
        if (v == nullptr || !v->IsArray() || v->ArrayLen() < 2) return Imath::V2f(fallback);
        return Imath::V2f(static_cast<float>(v->Get(0).GetNumberAsDouble()),
                          static_cast<float>(v->Get(1).GetNumberAsDouble()));
      };
      image.offset = pair("offset", 0.0f);
      image.scale = pair("scale", 1.0f);
      image.rotation = number(transform->second, "rotation", 0.0) * (180.0f / 3.14159265f);
      set = static_cast<int>(number(transform->second, "texCoord", set));
    }
    if (set != 0 && set != 1)
      warn_(
          fmt::format("material \"{}\" uses texture coordinates {}; the first ones are taken, as "
                      "only 0 and 1 are read",
                      material_.name, set));
    image.uv_set = set == 1 ? 1 : 0;
    material_.texture(input) = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.push_back({fmt::format("{} {}", material_.name, slot.index), image, channel});
  }

  ImageTexture image_of(const tinygltf::Image& image, int index) {
    ImageTexture texture;
    if (!image.image.empty()) {
      auto& bytes = images_[index];
      if (!bytes) bytes = std::make_shared<const std::vector<unsigned char>>(image.image);
      texture.data = bytes;
      texture.description =
          fmt::format("image {} ({})", index, image.uri.empty() ? image.name : image.uri);
      return texture;
    }
    throw GltfError(fmt::format("image {} ({}) cannot be read", index,
                                image.uri.empty() ? "in a buffer" : image.uri));
  }

  static std::string extensions_of(const tinygltf::Texture& texture) {
    std::string names;
    for (const auto& [name, value] : texture.extensions)
      names += (names.empty() ? " (" : ", ") + name;
    return names.empty() ? names : names + ")";
  }

  static Wrap wrap_of(int gl) {
    return gl == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::kClamp
           : gl == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirror
                                                         : Wrap::kRepeat;
  }

  const tinygltf::Model& model_;
  const std::function<void(const std::string&)>& warn_;
  Scene& scene_;
  Material material_;
  std::map<int, std::shared_ptr<const std::vector<unsigned char>>> images_;  // of all textures
};

}  // namespace

void add_gltf_materials(const tinygltf::Model& model,
                        const std::function<void(const std::string&)>& warn, Scene& scene) {
  Converter converter(model, warn, scene);
  for (std::size_t i = 0; i < model.materials.size(); ++i)
    scene.materials.push_back(converter.convert(model.materials[i], i));
  Material plain;
  plain.name = "default material";
  plain.type = MaterialType::kPrincipled;
  plain.color = V3f(0.8f);
  plain.roughness = 0.6f;
  scene.materials.push_back(plain);
}

}  // namespace morsel::render
