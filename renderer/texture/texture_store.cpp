// SPDX-License-Identifier: Apache-2.0
#include "renderer/texture/texture_store.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "renderer/texture/linear_image.h"

namespace morsel::render {
namespace {

constexpr std::string_view kUdim = "<UDIM>";

OIIO::TextureOpt::Wrap wrap_of(Wrap wrap) {
  switch (wrap) {
    case Wrap::kClamp:
      return OIIO::TextureOpt::WrapClamp;
    case Wrap::kMirror:
      return OIIO::TextureOpt::WrapMirror;
    case Wrap::kBlack:
      return OIIO::TextureOpt::WrapBlack;
    case Wrap::kRepeat:
      break;
  }
  return OIIO::TextureOpt::WrapPeriodic;
}

// Whether two textures are the same to the store: what they make of coordinates is not its concern.
bool same_image(const ImageTexture& a, const ImageTexture& b) {
  return a.file == b.file && a.data == b.data && a.color_space == b.color_space &&
         a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v;
}

// The files that stand for a name with <UDIM>, by number.
std::map<int, std::string> udim_tiles(const std::string& pattern) {
  namespace fs = std::filesystem;
  const fs::path path(pattern);
  const std::string name = path.filename().string();
  const std::size_t at = name.find(kUdim);
  const std::string before = name.substr(0, at), after = name.substr(at + kUdim.size());
  std::map<int, std::string> tiles;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path.parent_path(), error)) {
    const std::string file = entry.path().filename().string();
    if (file.size() != before.size() + 4 + after.size() || file.rfind(before, 0) != 0 ||
        file.substr(before.size() + 4) != after)
      continue;
    const std::string digits = file.substr(before.size(), 4);
    if (digits.find_first_not_of("0123456789") != std::string::npos) continue;
    const int number = std::stoi(digits);
    if (number >= 1001) tiles[number] = entry.path().string();
  }
  return tiles;
}

TextureStore::Value value_of(const float texel[4], int channels) {
  if (channels <= 2) return {V3f(texel[0]), channels == 2 ? texel[1] : 1.0f};
  return {V3f(texel[0], texel[1], texel[2]), channels > 3 ? texel[3] : 1.0f};
}

}  // namespace

struct TextureStore::Impl {
  struct Opened {
    OIIO::TextureSystem::TextureHandle* handle = nullptr;
    CachedImage cached;
  };
  struct Image {
    OIIO::TextureOpt options;
    Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
    std::uint32_t shape = kNoShape;
    Opened whole;
    std::map<int, Opened> tiles;  // UDIM: by tile number; the image is not repeated
  };

  OIIO::TextureSystem* system = OIIO::TextureSystem::create(false);
  std::vector<Image> images;
  std::vector<ImageTexture> added;  // one of each kind, by number: see same_image
  std::vector<std::unique_ptr<ImageTexture>> sources;  // what the cache's configurations point to

  // Of no other store in this process.
  const std::uint64_t number = [] {
    static std::atomic<std::uint64_t> stores{0};
    return ++stores;
  }();
  oneapi::tbb::enumerable_thread_specific<TileSampler> samplers{
      [this] { return TileSampler(*system->imagecache()); }};

  ~Impl() {
    samplers.clear();
    OIIO::TextureSystem::destroy(system);
  }

  // OpenImageIO's t is down from the top.
  static TexelPlace place(const Image& i, const CachedImage& cached, const V2f& uv,
                          const V2f& across, const V2f& along, float random) {
    return texel_place(cached, i.wrap_u, i.wrap_v, V2f(uv.x, 1.0f - uv.y), V2f(across.x, -across.y),
                       V2f(along.x, -along.y), random);
  }
  Value texel(const CachedImage& cached, const TexelPlace& place, TileSampler& sampler) const {
    float texel[4];
    if (sampler.sample(cached, place, texel)) [[likely]]
      return value_of(texel, cached.channels);
    system->imagecache()->geterror();  // or it would be kept for ever
    return {};
  }

  // That of an image before it with the same size and wrapping, or a new one.
  std::uint32_t shape_of(const Image& image) const {
    std::uint32_t shapes = 0;
    for (const Image& other : images) {
      if (other.shape == kNoShape) continue;
      const CachedImage &a = image.whole.cached, &b = other.whole.cached;
      if (a.width == b.width && a.height == b.height && image.wrap_u == other.wrap_u &&
          image.wrap_v == other.wrap_v)
        return other.shape;
      shapes = std::max(shapes, other.shape + 1);
    }
    return shapes;
  }

  Opened open(const ImageTexture& image) {
    sources.push_back(std::make_unique<ImageTexture>(image));
    const OIIO::ustring name(fmt::format("texture {}", sources.size()));
    const OIIO::ImageSpec config = linear_image_configuration(*sources.back());
    system->imagecache()->add_file(name, create_linear_image, &config);
    OIIO::ImageSpec spec;
    if (!system->get_imagespec(name, 0, spec))
      throw std::runtime_error(fmt::format("{}: cannot read the image: {}",
                                           image.data ? image.description : image.file,
                                           system->geterror()));
    return {system->get_texture_handle(name),
            {.handle = system->imagecache()->get_image_handle(name),
             .number = static_cast<std::uint32_t>(sources.size()),
             .width = spec.width,
             .height = spec.height,
             .levels = static_cast<int>(
                 std::bit_width(static_cast<unsigned>(std::max(spec.width, spec.height)))),
             .channels = spec.nchannels}};
  }
};

TextureStore::TextureStore(std::uint64_t megabytes) : impl_(std::make_unique<Impl>()) {
  impl_->system->attribute("max_memory_MB", static_cast<float>(megabytes));
  impl_->system->attribute("automip", 1);
  impl_->system->attribute("autotile", 64);
  impl_->system->attribute("autoscanline", 0);
  impl_->system->attribute("accept_untiled", 1);
  impl_->system->attribute("gray_to_rgb", 0);
}
TextureStore::~TextureStore() = default;

std::size_t TextureStore::size() const { return impl_->images.size(); }

std::uint32_t TextureStore::add(const ImageTexture& image) {
  for (std::size_t i = 0; i < impl_->added.size(); ++i)
    if (same_image(impl_->added[i], image)) return static_cast<std::uint32_t>(i);
  Impl::Image added;
  added.wrap_u = image.wrap_u;
  added.wrap_v = image.wrap_v;
  // Cubic B-splines, the default where texels are larger than pixels, would blur them.
  added.options.interpmode = OIIO::TextureOpt::InterpBilinear;
  if (!image.data && image.file.find(kUdim) != std::string::npos) {
    added.wrap_u = added.wrap_v = Wrap::kClamp;
    for (const auto& [number, file] : udim_tiles(image.file)) {
      ImageTexture tile = image;
      tile.file = file;
      added.tiles[number] = impl_->open(tile);
    }
    if (added.tiles.empty())
      throw std::runtime_error(
          fmt::format("{}: no tiles; <UDIM> stands for four digits, 1001 or more", image.file));
  } else {
    added.whole = impl_->open(image);
    added.shape = impl_->shape_of(added);
  }
  added.options.swrap = wrap_of(added.wrap_u);
  added.options.twrap = wrap_of(added.wrap_v);
  impl_->images.push_back(std::move(added));
  impl_->added.push_back(image);
  return static_cast<std::uint32_t>(impl_->images.size() - 1);
}

TextureStore::Value TextureStore::lookup(std::uint32_t image, const V2f& uv, const V2f& across,
                                         const V2f& along, float random) const {
  const Impl::Image& i = impl_->images[image];
  const Impl::Opened* opened = &i.whole;
  V2f at = uv;
  if (!i.tiles.empty()) {
    const float column = std::floor(uv.x), row = std::floor(uv.y);
    if (!(column >= 0.0f && column < 10.0f && row >= 0.0f && row < 900.0f)) return {};
    const auto tile = i.tiles.find(1001 + static_cast<int>(column) + 10 * static_cast<int>(row));
    if (tile == i.tiles.end()) return {};
    opened = &tile->second;
    at = V2f(uv.x - column, uv.y - row);
  }
  if (random >= 0.0f)
    return impl_->texel(opened->cached, Impl::place(i, opened->cached, at, across, along, random),
                        sampler());
  const int channels = opened->cached.channels;
  float texel[4] = {0.0f, 0.0f, 0.0f, 1.0f};
  OIIO::TextureOpt options = i.options;
  if (!impl_->system->texture(opened->handle, impl_->system->get_perthread_info(), options, at.x,
                              1.0f - at.y, across.x, -across.y, along.x, -along.y,
                              std::min(channels, 4), texel)) {
    impl_->system->geterror();  // or it would be kept for ever
    return {};
  }
  return value_of(texel, channels);
}

std::uint32_t TextureStore::shape(std::uint32_t image) const { return impl_->images[image].shape; }

TexelPlace TextureStore::place(std::uint32_t image, const V2f& uv, const V2f& across,
                               const V2f& along, float random) const {
  const Impl::Image& i = impl_->images[image];
  return Impl::place(i, i.whole.cached, uv, across, along, random);
}

TileSampler& TextureStore::sampler() const {
  // TBB's own look-up is as much work as a texture's. By number: another store may come to lie
  // where one was.
  thread_local std::uint64_t known = 0;
  thread_local TileSampler* mine = nullptr;
  if (known != impl_->number) {
    mine = &impl_->samplers.local();
    known = impl_->number;
  }
  return *mine;
}

TextureStore::Value TextureStore::texel(std::uint32_t image, const TexelPlace& place,
                                        TileSampler& sampler) const {
  return impl_->texel(impl_->images[image].whole.cached, place, sampler);
}

std::string TextureStore::statistics() const { return impl_->system->getstats(1, true); }

std::vector<std::pair<std::string, std::int64_t>> TextureStore::numbers() const {
  std::vector<std::pair<std::string, std::int64_t>> all;
  auto* const cache = impl_->system->imagecache();
  for (const char* name : {"bytes_read", "image_size", "cache_memory_used"}) {
    OIIO::imagesize_t value = 0;
    if (cache->getattribute(std::string("stat:") + name, OIIO::TypeDesc::INT64, &value))
      all.emplace_back(name, static_cast<std::int64_t>(value));
  }
  for (const char* name : {"find_tile_calls", "tiles_created", "tiles_current", "tiles_peak",
                           "open_files_created", "open_files_peak"}) {
    std::int64_t wide = 0;
    int narrow = 0;
    if (cache->getattribute(std::string("stat:") + name, OIIO::TypeDesc::INT64, &wide))
      all.emplace_back(name, wide);
    else if (cache->getattribute(std::string("stat:") + name, OIIO::TypeDesc::INT, &narrow))
      all.emplace_back(name, narrow);
  }
  return all;
}

}  // namespace morsel::render
