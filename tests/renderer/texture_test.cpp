// SPDX-License-Identifier: Apache-2.0
#include <Imath/ImathVec.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <latch>
#include <limits>
#include <thread>
#include <vector>

#include "renderer/integrator/render.h"
#include "renderer/texture/texture_set.h"
#include "renderer/texture/texture_store.h"
#include "tests/renderer/mean_of_film.h"
#include "tests/renderer/statistics.h"
#include "tests/renderer/test_scenes.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using namespace testing;

// An 8-bit RGB image; `value(x, y)` with y down, in [0, 255].
template <class Value>
std::string write_image(const test::TemporaryFolder& folder, const std::string& name, int width,
                        int height, Value&& value) {
  const std::string file = (folder.path() / name).string();
  std::vector<unsigned char> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Imath::V3i c = value(x, y);
      for (int i = 0; i < 3; ++i) pixels.push_back(static_cast<unsigned char>(c[i]));
    }
  auto out = OIIO::ImageOutput::create(file);
  out->open(file, OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::UINT8));
  out->write_image(OIIO::TypeDesc::UINT8, pixels.data());
  out->close();
  return file;
}

ImageTexture image_of(const std::string& file, ColorSpace space = ColorSpace::kAuto) {
  ImageTexture image;
  image.file = file;
  image.color_space = space;
  return image;
}

V3f at(const TextureStore& store, std::uint32_t image, float u, float v, float width = 0.0f) {
  return store.lookup(image, V2f(u, v), V2f(width, 0), V2f(0, width)).color;
}

class TextureTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  TextureStore store_{64};
};

TEST_F(TextureTest, IsUprightAndLinear) {
  // Red grows to the right, green upwards.
  const std::string file = write_image(folder_, "ramp.png", 64, 64, [](int x, int y) {
    return Imath::V3i(4 * x, 4 * (63 - y), 188);
  });
  const auto linear = store_.add(image_of(file, ColorSpace::kLinear));
  const auto srgb = store_.add(image_of(file));
  EXPECT_NEAR(at(store_, linear, 0.75f, 0.25f).x, 0.75f, 0.02f);
  EXPECT_NEAR(at(store_, linear, 0.75f, 0.25f).y, 0.25f, 0.02f);
  EXPECT_NEAR(at(store_, linear, 0.5f, 0.5f).z, 188.0f / 255.0f, 2e-3f);
  EXPECT_NEAR(at(store_, srgb, 0.5f, 0.5f).z, 0.5028f, 2e-3f);  // the sRGB curve at 188
}

// A wide footprint sees the mean of the light, not of its sRGB encoding.
TEST_F(TextureTest, FootprintsAverageLight) {
  const std::string file = write_image(folder_, "checks.png", 128, 128, [](int x, int y) {
    return Imath::V3i((x + y) % 2 == 0 ? 255 : 0);
  });
  const auto image = store_.add(image_of(file));
  EXPECT_NEAR(at(store_, image, 0.41f, 0.37f, 0.25f).x, 0.5f, 0.02f);
  const auto texel = [](int i) { return (static_cast<float>(i) + 0.5f) / 128.0f; };
  EXPECT_GT(std::abs(at(store_, image, texel(40), texel(40)).x -
                     at(store_, image, texel(41), texel(40)).x),
            0.5f);
}

// Points of a footprint have its filtered value for their mean; where texels are larger than it
// they are that value, whatever the wrapping makes of places outside.
TEST_F(TextureTest, PointsOfAFootprintAverageToItsFilteredValue) {
  const std::string file = write_image(folder_, "smooth.png", 200, 150, [](int x, int y) {
    const auto wave = [](double t) { return static_cast<int>(127.5 + 120.0 * std::sin(t)); };
    return Imath::V3i(wave(x * 0.08), wave(y * 0.11 + 1.0), wave((x + y) * 0.05));
  });
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror, Wrap::kBlack}) {
    ImageTexture texture = image_of(file, ColorSpace::kLinear);
    texture.wrap_u = texture.wrap_v = wrap;
    const std::uint32_t image = store_.add(texture);
    for (const V2f& uv :
         {V2f(0.3f, 0.6f), V2f(-0.37f, 1.43f), V2f(2.61f, -1.2f), V2f(0.001f, 0.5f)})
      for (const float width : {0.0f, 0.001f, 0.02f, 0.15f}) {
        const V2f across(width, 0.3f * width), along(-0.1f * width, 0.4f * width);
        const V3f filtered = store_.lookup(image, uv, across, along).color;
        V3f mean(0.0f);
        constexpr int kPoints = 4096;
        for (int i = 0; i < kPoints; ++i)
          mean += store_.lookup(image, uv, across, along, (static_cast<float>(i) + 0.5f) / kPoints)
                      .color /
                  static_cast<float>(kPoints);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(mean[c], filtered[c], width < 0.01f ? 0.004f : 0.06f)
              << "wrap " << static_cast<int>(wrap) << ", " << uv << ", width " << width;
      }
  }
}

TEST_F(TextureTest, AnyCoordinatesAndFootprintsGiveALightOfTheImage) {
  const std::string file = write_image(
      folder_, "grey.png", 100, 7, [](int x, int) { return Imath::V3i(x % 2 == 0 ? 100 : 200); });
  const std::uint32_t image = store_.add(image_of(file, ColorSpace::kLinear));
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const float numbers[] = {0.0f, -0.3f, 1e-30f, 7.0f, 1e9f, -3e38f, kInf, kNan};
  for (const float u : numbers)
    for (const float v : numbers)
      for (const float width : numbers)
        for (const float random : {0.0f, 0.4f, 0.99999994f}) {
          const V3f c =
              store_.lookup(image, V2f(u, v), V2f(width, 0), V2f(0, 0.1f * width), random).color;
          ASSERT_TRUE(c.x > 0.39f && c.x < 0.79f) << u << ", " << v << ", " << width << ": " << c;
        }
}

// The first look-ups decode the image and make its levels, whichever threads they come from.
TEST_F(TextureTest, IsReadByManyThreadsAtOnce) {
  const std::string file = write_image(folder_, "noise.png", 512, 512, [](int x, int y) {
    return Imath::V3i((x * 7 + y * 13) % 256, (x * y) % 256, (x * x + y) % 256);
  });
  constexpr int kThreads = 8, kLookups = 64;
  const auto lookup = [](const TextureStore& store, std::uint32_t image, int i) {
    const float u = static_cast<float>(i * 29 % 64) / 64.0f, v = static_cast<float>(i) / 64.0f;
    return at(store, image, u, v, std::exp2(-static_cast<float>(i % 9)));
  };
  const std::uint32_t alone = store_.add(image_of(file));
  for (int round = 0; round < 20; ++round) {
    TextureStore store(64);
    const std::uint32_t image = store.add(image_of(file));
    std::vector<V3f> found(std::size_t{kThreads} * kLookups);
    std::latch start(kThreads);
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([&, t] {
        start.arrive_and_wait();
        for (int i = 0; i < kLookups; ++i)
          found[static_cast<std::size_t>(t * kLookups + i)] =
              lookup(store, image, (i + t * 5) % kLookups);
      });
    threads.clear();
    for (int t = 0; t < kThreads; ++t)
      for (int i = 0; i < kLookups; ++i)
        ASSERT_EQ(found[static_cast<std::size_t>(t * kLookups + i)],
                  lookup(store_, alone, (i + t * 5) % kLookups))
            << "round " << round << ", thread " << t << ", " << i;
  }
}

TEST_F(TextureTest, UdimTilesAreFoundByTheirNumbers) {
  for (const auto& [number, grey] : std::map<int, int>{{1001, 50}, {1002, 100}, {1011, 200}})
    write_image(folder_, "skin." + std::to_string(number) + ".png", 8, 8,
                [grey = grey](int, int) { return Imath::V3i(grey); });
  const auto image =
      store_.add(image_of((folder_.path() / "skin.<UDIM>.png").string(), ColorSpace::kLinear));
  EXPECT_NEAR(at(store_, image, 0.5f, 0.5f).x, 50 / 255.0f, 2e-3f);
  EXPECT_NEAR(at(store_, image, 1.5f, 0.5f).x, 100 / 255.0f, 2e-3f);
  EXPECT_NEAR(at(store_, image, 0.5f, 1.5f).x, 200 / 255.0f, 2e-3f);
  EXPECT_EQ(at(store_, image, 5.5f, 0.5f).x, 0.0f);
  EXPECT_THROW(store_.add(image_of((folder_.path() / "other.<UDIM>.png").string())),
               std::runtime_error);
}

TEST_F(TextureTest, ReadsAnImageInMemory) {
  const std::string file =
      write_image(folder_, "memory.png", 8, 8, [](int, int) { return Imath::V3i(255, 0, 0); });
  std::ifstream stream(file, std::ios::binary);
  ImageTexture image;
  image.data = std::make_shared<const std::vector<unsigned char>>(
      std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  image.description = "image 3";
  EXPECT_NEAR(at(store_, store_.add(image), 0.5f, 0.5f).x, 1.0f, 1e-3f);
  image.data = std::make_shared<const std::vector<unsigned char>>(20, 'x');
  try {
    store_.add(image);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("image 3"), std::string::npos);
  }
}

TEST_F(TextureTest, NamesAFileThatCannotBeRead) {
  for (const char* name : {"missing.png", "broken.png"}) {
    if (std::string(name) == "broken.png") folder_.write(name, "not an image");
    try {
      store_.add(image_of((folder_.path() / name).string()));
      FAIL();
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
    }
  }
}

// A square in the plane y = 0 with texture coordinates, seen from above.
Scene square_scene() {
  Scene scene;
  add_material(scene, MaterialType::kPrincipled, V3f(1.0f));
  scene.materials[0].specular = 0.0f;
  TriangleMesh mesh = plane_mesh(1.0f);
  for (const V3f& p : mesh.positions) mesh.uvs.emplace_back(0.5f + 0.5f * p.x, 0.5f - 0.5f * p.z);
  add_mesh(scene, mesh, 0);
  scene.camera.position = V3f(0, 5, 0);
  scene.camera.up = V3f(0, 0, -1);
  scene.camera.projection = Projection::kOrthographic;
  scene.camera.height = 2.0f;
  add_constant_environment(scene, 1.0f);
  set_image(scene, 32, 32, 32, 0);
  return scene;
}

// A hundred repetitions seen by pixels that cover many: no aliasing, the mean of the light.
TEST_F(TextureTest, RayConesChooseTheMipLevel) {
  Scene scene = square_scene();
  ImageTexture image = image_of(write_image(
      folder_, "stripes.png", 64, 64, [](int x, int) { return Imath::V3i(x < 32 ? 255 : 0); }));
  image.scale = V2f(100.0f, 100.0f);
  scene.textures.push_back({"stripes", image, TextureChannel::kLuminance});
  scene.materials[0].texture(MaterialInput::kColor) = 0;
  scene.settings.spp = 1;
  const Film film = render(scene).film;
  for (int y = 4; y < 28; ++y)
    for (int x = 4; x < 28; ++x) EXPECT_NEAR(film.at(x, y).albedo.x, 0.5f, 0.06f);
}

TEST_F(TextureTest, ThreadsChangeNoTexturedPixel) {
  Scene scene = square_scene();
  ImageTexture image = image_of(write_image(folder_, "spots.png", 300, 200, [](int x, int y) {
    return Imath::V3i(x * y % 256, x % 256, y * 7 % 256);
  }));
  image.scale = V2f(3.0f, 2.0f);
  scene.textures.push_back({"spots", image, TextureChannel::kLuminance});
  scene.materials[0].texture(MaterialInput::kColor) = 0;
  scene.settings.spp = 4;
  RenderOptions one, two;
  one.threads = 1;
  two.threads = 2;
  const Film expected = render(scene, one).film;
  for (int round = 0; round < 5; ++round) {
    const Film film = render(scene, two).film;
    for (int y = 0; y < scene.settings.height; ++y)
      for (int x = 0; x < scene.settings.width; ++x) {
        ASSERT_EQ(film.at(x, y).color, expected.at(x, y).color) << x << ", " << y;
        ASSERT_EQ(film.at(x, y).albedo, expected.at(x, y).albedo) << x << ", " << y;
      }
  }
}

TEST_F(TextureTest, NormalMapsLean) {
  Scene scene = square_scene();
  // Leans to +u, which is +x, by 45 degrees; and to +v, which is -z.
  for (const bool to_u : {true, false}) {
    const std::string file = write_image(folder_, to_u ? "u.png" : "v.png", 8, 8, [&](int, int) {
      return to_u ? Imath::V3i(218, 128, 218) : Imath::V3i(128, 218, 218);
    });
    scene.textures = {{"n", image_of(file, ColorSpace::kLinear), TextureChannel::kLuminance}};
    scene.materials[0].texture(MaterialInput::kNormal) = 0;
    const Film film = render(scene).film;
    const V3f n = film.at(16, 16).normal;
    const V3f expected = normalize(to_u ? V3f(1, 1, 0) : V3f(0, 1, -1));
    EXPECT_NEAR((n - expected).length(), 0.0f, 0.02f) << n;
  }
}

TEST_F(TextureTest, BumpsFollowTheSlope) {
  Scene scene = square_scene();
  const std::string file =
      write_image(folder_, "slope.png", 256, 8, [](int x, int) { return Imath::V3i(x); });
  scene.textures = {{"b", image_of(file, ColorSpace::kLinear), TextureChannel::kRed}};
  scene.materials[0].texture(MaterialInput::kBump) = 0;
  scene.materials[0].bump_height = 1.0f;  // rises by 1 over the width of 2
  const V3f n = render(scene).film.at(16, 16).normal;
  EXPECT_NEAR((n - normalize(V3f(-0.5f, 1, 0))).length(), 0.0f, 0.03f) << n;
}

TEST_F(TextureTest, CutOutsByAnImage) {
  Scene scene = square_scene();
  const std::string file = write_image(folder_, "half.png", 64, 8,
                                       [](int x, int) { return Imath::V3i(x < 32 ? 0 : 255); });
  ImageTexture image = image_of(file, ColorSpace::kLinear);
  image.wrap_u = image.wrap_v = Wrap::kClamp;
  scene.textures = {{"o", image, TextureChannel::kRed}};
  scene.materials[0].texture(MaterialInput::kOpacity) = 0;
  scene.materials[0].opacity_cutoff = 0.5f;
  scene.environment->visible_to_camera = false;
  const Film film = render(scene).film;
  EXPECT_EQ(film.at(8, 16).alpha, 0.0f);
  EXPECT_EQ(film.at(24, 16).alpha, 1.0f);
}

TEST_F(TextureTest, TriplanarNeedsNoCoordinates) {
  Scene scene;
  add_material(scene, MaterialType::kPrincipled, V3f(1.0f));
  add_mesh(scene, sphere_mesh(4, true), 0);
  ImageTexture image =
      image_of(write_image(folder_, "grey.png", 16, 16,
                           [](int x, int) { return Imath::V3i(x < 8 ? 255 : 0, 128, 128); }),
               ColorSpace::kLinear);
  image.triplanar = true;
  image.triplanar_size = 0.5f;
  scene.textures = {{"t", image, TextureChannel::kLuminance}};
  scene.materials[0].texture(MaterialInput::kColor) = 0;
  scene.materials[0].specular = 0.0f;
  add_constant_environment(scene, 1.0f);
  scene.camera.vertical_fov = 15.0f;
  set_image(scene, 24, 24, 16, 0);
  const Film film = render(scene).film;
  double least = 1.0, most = 0.0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      EXPECT_NEAR(film.at(x, y).albedo.y, 128 / 255.0f, 0.01f);
      least = std::min<double>(least, film.at(x, y).albedo.x);
      most = std::max<double>(most, film.at(x, y).albedo.x);
    }
  EXPECT_LT(least, 0.3);
  EXPECT_GT(most, 0.7);
}

// A plane with coordinates and a hit on it, to ask textures at.
struct AskedPlane {
  Scene scene;
  SurfaceInteraction hit;

  AskedPlane() {
    add_material(scene, MaterialType::kDiffuse, V3f(0.5f));
    TriangleMesh plane = plane_mesh(1.0f);
    plane.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    add_mesh(scene, plane, 0);
    hit.instance = hit.geometry = hit.primitive = 0;
    hit.geometric_normal = hit.shading_normal = hit.object_normal = V3f(0, 1, 0);
  }
};

// What a point remembers of one image (the place, the value) is only given to what it is true of.
TEST_F(TextureTest, ImagesAskedAtOnePointAreThoseOfEachAskedAlone) {
  const auto noise = [&](const char* name, int width, int height, int seed) {
    return image_of(write_image(folder_, name, width, height, [&](int x, int y) {
      const int v = (x * 7919 + y * 104729 + seed * 1299709) % 65521;
      return Imath::V3i(v % 256, v / 3 % 256, v / 7 % 256);
    }));
  };
  const ImageTexture a = noise("a.png", 64, 64, 1), b = noise("b.png", 64, 64, 2),
                     c = noise("c.png", 128, 32, 3);
  ImageTexture scaled = a, turned = b, clamped = b, second = a, solid = b;
  scaled.scale = V2f(3.0f, 2.0f);
  turned.rotation = 30.0f;
  clamped.wrap_u = Wrap::kClamp;
  second.uv_set = 1;
  solid.triplanar = true;
  AskedPlane plane;
  for (const ImageTexture& image : {a, b, c, scaled, turned, clamped, second, solid, a, scaled})
    plane.scene.textures.push_back({"t", image, TextureChannel::kLuminance});
  const TextureSet textures(plane.scene);
  Random random(5);
  const V3f wo = normalize(V3f(0.3f, 1.0f, 0.2f));
  for (int i = 0; i < 300; ++i) {
    SurfaceInteraction& hit = plane.hit;
    hit.uv = random.pair() * 4.0f - V2f(2.0f);
    hit.uv1 = random.pair() * 4.0f - V2f(2.0f);
    hit.object_p = V3f(hit.uv.x, 0.0f, hit.uv.y);
    hit.footprint = 0.2f * random();
    hit.texture_random = i % 4 == 0 ? -1.0f : random();
    const TexturePoint shared(plane.scene, hit, wo);
    for (int k = 0; k < 20; ++k) {
      const auto t =
          static_cast<std::uint32_t>(random() * static_cast<float>(plane.scene.textures.size()));
      const TexturePoint alone(plane.scene, hit, wo);
      ASSERT_EQ(textures.color(t, shared), textures.color(t, alone)) << i << ", texture " << t;
      if (k % 5 == 0) {
        ASSERT_EQ(textures.slope(t, shared, V3f(1, 0, 0), V3f(0, 0, 1)),
                  textures.slope(t, alone, V3f(1, 0, 0), V3f(0, 0, 1)));
      }
    }
  }
}

// Scaled, then turned, then moved, with v counted from the bottom or the top: step by step here.
TEST_F(TextureTest, CoordinatesAreMappedAsTheTextureSays) {
  const ImageTexture plain =
      image_of(write_image(folder_, "ramp.png", 64, 64,
                           [](int x, int y) { return Imath::V3i(4 * x, 4 * (63 - y), 0); }),
               ColorSpace::kLinear);
  Random random(6);
  for (int i = 0; i < 40; ++i) {
    ImageTexture image = plain;
    image.scale = random.pair() * 2.0f - V2f(1.0f);
    image.offset = random.pair();
    image.rotation = i % 3 == 0 ? 0.0f : 360.0f * random();
    image.v_down = i % 2 == 1;
    AskedPlane plane;
    plane.scene.textures = {{"mapped", image, TextureChannel::kLuminance},
                            {"plain", plain, TextureChannel::kLuminance}};
    const TextureSet textures(plane.scene);
    for (int k = 0; k < 20; ++k) {
      const V2f uv = random.pair();
      double x = uv.x, y = image.v_down ? 1.0 - uv.y : uv.y;
      x *= image.scale.x;
      y *= image.scale.y;
      const double angle = image.rotation * 3.14159265358979 / 180.0 * (image.v_down ? -1.0 : 1.0);
      const double u = std::cos(angle) * x - std::sin(angle) * y + image.offset.x;
      double v = std::sin(angle) * x + std::cos(angle) * y + image.offset.y;
      if (image.v_down) v = 1.0 - v;
      const auto jumps = [](double c) { return std::abs(c - std::round(c)) < 0.02; };
      if (jumps(u) || jumps(v)) continue;  // the ramp does, where the image is repeated
      plane.hit.uv = uv;
      plane.hit.texture_random = 0.5f;
      const V3f mapped = textures.color(0, TexturePoint(plane.scene, plane.hit, V3f(0, 1, 0)));
      plane.hit.uv = V2f(static_cast<float>(u), static_cast<float>(v));
      const V3f expected = textures.color(1, TexturePoint(plane.scene, plane.hit, V3f(0, 1, 0)));
      EXPECT_NEAR((mapped - expected).length(), 0.0f, 1e-4f) << i << ": " << u << ", " << v;
    }
  }
}

// What a texture makes a mesh emit reaches other surfaces the same by light samples and by chance.
TEST_F(TextureTest, TexturedEmissionHasOneMean) {
  Scene scene = square_scene();
  const std::string file = write_image(folder_, "lamp.png", 16, 16, [](int x, int y) {
    return Imath::V3i(x < 4 && y < 8 ? 255 : 20);
  });
  const auto lamp = add_material(scene, MaterialType::kPrincipled, V3f(0.0f));
  scene.materials[lamp].emission = V3f(5.0f);
  scene.materials[lamp].specular = 0.0f;
  scene.textures = {{"e", image_of(file, ColorSpace::kLinear), TextureChannel::kLuminance}};
  scene.materials[lamp].texture(MaterialInput::kEmission) = 0;
  TriangleMesh mesh = plane_mesh(0.7f, 1.0f);
  for (const V3f& p : mesh.positions)
    mesh.uvs.emplace_back(0.5f + 0.5f * p.x / 0.7f, 0.5f - 0.5f * p.z / 0.7f);
  add_mesh(scene, mesh, lamp);
  scene.instances.back().visible_to_camera = false;
  scene.environment.reset();
  scene.settings.spp = 256;
  Mean means[3];
  for (const auto strategy :
       {DirectLighting::kMis, DirectLighting::kLightsOnly, DirectLighting::kBsdfOnly}) {
    RenderOptions options;
    options.direct_lighting = strategy;
    scene.settings.seed = static_cast<std::uint32_t>(strategy);
    means[static_cast<int>(strategy)] = mean_of(render(scene, options).film);
  }
  for (int i = 1; i < 3; ++i)
    EXPECT_LT(std::abs(means[0].value - means[i].value),
              4.0 * std::hypot(means[0].error, means[i].error))
        << i;
  EXPECT_GT(means[0].value, 0.01);
}

}  // namespace
}  // namespace morsel::render
