// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "renderer/film/cryptomatte.h"
#include "renderer/image/denoise.h"
#include "renderer/image/exr.h"
#include "renderer/image/png.h"
#include "renderer/image/tone_map.h"
#include "tests/renderer/test_scenes.h"
#include "topology/replacing_file.h"

namespace morsel::render {
namespace {

namespace fs = std::filesystem;
using namespace testing;

class Images : public ::testing::Test {
 protected:
  Images() {
    directory_ = fs::path(::testing::TempDir()) /
                 ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(directory_);
    fs::create_directories(directory_);
    add_material(scene_, MaterialType::kDiffuse, V3f(0.8f, 0.5f, 0.3f));
    add_mesh(scene_, sphere_mesh(2), 0);
    add_constant_environment(scene_, 1.0f);
    set_image(scene_, 40, 30, 4);
    scene_.settings.crop = Crop{10, 5, 30, 28};
    scene_.settings.seed = 4000000000u;
  }
  ~Images() override { fs::remove_all(directory_); }

  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(directory_), fs::directory_iterator());
  }

  fs::path directory_;
  Scene scene_;
};

// Mattes as the specification has them: the ID's bits, shares that sum to what is covered, and a
// manifest that names the ID. The layers of light groups and the first hit's.
TEST_F(Images, ExrHasMattesGroupsAndFirstHits) {
  scene_.settings.crop.reset();
  scene_.settings.cryptomatte = true;
  scene_.instances[0].name = "the ball";
  scene_.materials[0].name = "clay";
  scene_.light_groups = {"sky"};
  scene_.environment->group = 0;
  scene_.camera.position = V3f(0, 0, 5);
  const RenderResult result = render(scene_);
  const fs::path path = directory_ / "image.exr";
  write_exr(path, scene_, result);

  const auto in = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(in) << OIIO::geterror();
  const OIIO::ImageSpec& spec = in->spec();
  const std::string key = "cryptomatte/" + cryptomatte::key_of("crypto_object") + "/";
  EXPECT_EQ(spec.get_string_attribute(key + "name"), "crypto_object");
  EXPECT_EQ(spec.get_string_attribute(key + "hash"), "MurmurHash3_32");
  EXPECT_EQ(spec.get_string_attribute(key + "conversion"), "uint32_to_float32");
  const std::uint32_t id = cryptomatte::id_of("the ball");
  EXPECT_EQ(std::string(spec.get_string_attribute(key + "manifest")),
            cryptomatte::manifest_of({{"the ball", id}}));

  std::vector<float> data(static_cast<std::size_t>(40 * 30 * spec.nchannels));
  ASSERT_TRUE(in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, data.data()));
  const auto value = [&](const char* channel, int x, int y) {
    const int c = spec.channelindex(channel);
    EXPECT_GE(c, 0) << channel;
    return data[static_cast<std::size_t>((y * 40 + x) * spec.nchannels + c)];
  };
  EXPECT_EQ(value("crypto_object00.R", 20, 15), cryptomatte::as_float(id));
  EXPECT_EQ(value("crypto_object00.G", 20, 15), 1.0f);
  EXPECT_EQ(value("crypto_object00.G", 0, 0), 0.0f);
  EXPECT_EQ(value("crypto_material00.R", 20, 15),
            cryptomatte::as_float(cryptomatte::id_of("clay")));
  EXPECT_EQ(value("crypto_component00.G", 20, 15), 0.0f);  // not a hypertexture
  bool partly = false;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const float share = value("crypto_object00.G", x, y);
      partly = partly || (share > 0.0f && share < 1.0f);
      EXPECT_NEAR(value("light_sky.R", x, y), value("R", x, y), 1e-3f);
    }
  EXPECT_TRUE(partly);
  EXPECT_NEAR(value("P.Z", 20, 15), 1.0f, 0.1f);
  EXPECT_GT(value("Ng.Z", 20, 15), 0.9f);
  EXPECT_EQ(value("steps", 20, 15), 0.0f);
}

TEST_F(Images, ExrHasEveryLayerAndTheWindows) {
  const RenderResult result = render(scene_);
  const fs::path path = directory_ / "image.exr";
  write_exr(path, scene_, result);
  EXPECT_EQ(files(), 1);

  const auto in = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(in) << OIIO::geterror();
  const OIIO::ImageSpec& spec = in->spec();
  EXPECT_EQ(spec.x, 10);
  EXPECT_EQ(spec.y, 5);
  EXPECT_EQ(spec.width, 20);
  EXPECT_EQ(spec.height, 23);
  EXPECT_EQ(spec.full_x, 0);
  EXPECT_EQ(spec.full_width, 40);
  EXPECT_EQ(spec.full_height, 30);
  EXPECT_EQ(spec.get_string_attribute("morsel:seed"), "4000000000");
  EXPECT_EQ(spec.get_int_attribute("morsel:spp"), 4);
  EXPECT_EQ(std::string(spec.get_string_attribute("software")).rfind("Morsel ", 0), 0u);
  for (const char* name : {"morsel:embree", "morsel:openimageio", "morsel:openexr", "DateTime"})
    EXPECT_NE(spec.get_string_attribute(name), "") << name;
  EXPECT_NE(spec.find_attribute("morsel:seconds:build"), nullptr);
  EXPECT_EQ(spec.channelindex("denoised.R"), -1);
  EXPECT_NE(spec.find_attribute("worldToCamera"), nullptr);
  EXPECT_NE(spec.find_attribute("worldToNDC"), nullptr);
  const float aspect =
      static_cast<float>(scene_.settings.width) / static_cast<float>(scene_.settings.height);
  EXPECT_NEAR(spec.get_float_attribute("screenWindowWidth"),
              2.0f * std::tan(scene_.camera.vertical_fov * kPi / 360.0f) * aspect, 1e-5f);

  std::vector<float> data(static_cast<std::size_t>(20 * 23 * spec.nchannels));
  ASSERT_TRUE(in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, data.data()));
  const auto value = [&](const char* channel, int x, int y) {
    const int c = spec.channelindex(channel);
    EXPECT_GE(c, 0) << channel;
    return data[static_cast<std::size_t>(((y - 5) * 20 + x - 10) * spec.nchannels + c)];
  };
  for (const auto& [x, y] : {std::pair{10, 5}, {20, 15}, {29, 27}}) {
    const Pixel& p = result.film.at(x, y);
    EXPECT_NEAR(value("R", x, y), p.color.x, 1e-3f);
    EXPECT_NEAR(value("B", x, y), p.color.z, 1e-3f);
    EXPECT_NEAR(value("A", x, y), p.alpha, 1e-3f);
    EXPECT_NEAR(value("albedo.G", x, y), p.albedo.y, 1e-3f);
    EXPECT_NEAR(value("N.Z", x, y), p.normal.z, 1e-3f);
    EXPECT_EQ(value("Z", x, y), p.depth);
    EXPECT_EQ(value("variance.R", x, y), p.variance.x);
    EXPECT_EQ(value("component", x, y), p.component);
    EXPECT_EQ(value("sampleCount", x, y), 4.0f);
  }
  const auto type = [&](const char* channel) {
    return spec.channelformat(spec.channelindex(channel));
  };
  EXPECT_EQ(type("R"), OIIO::TypeDesc::HALF);
  EXPECT_EQ(type("albedo.R"), OIIO::TypeDesc::HALF);
  EXPECT_EQ(type("Z"), OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(type("component"), OIIO::TypeDesc::FLOAT);
}

TEST_F(Images, DenoisedRadianceIsALayerAndThePreview) {
  RenderResult result = render(scene_);
  for (int i = 0; i < 20 * 23; ++i) result.denoised.emplace_back(0.5f, static_cast<float>(i), 0.0f);
  const fs::path exr = directory_ / "image.exr", png = directory_ / "image.png";
  write_exr(exr, scene_, result);
  const auto in = OIIO::ImageInput::open(exr.string());
  ASSERT_TRUE(in);
  std::vector<float> green(20 * 23);
  const int c = in->spec().channelindex("denoised.G");
  ASSERT_GE(c, 0);
  ASSERT_TRUE(in->read_image(0, 0, c, c + 1, OIIO::TypeDesc::FLOAT, green.data()));
  EXPECT_EQ(green[0], 0.0f);
  EXPECT_EQ(green[21], 21.0f);
  EXPECT_EQ(green.back(), 20.0f * 23.0f - 1.0f);

  write_png(png, result.film, 0.0f, result.denoised);
  const auto preview = OIIO::ImageInput::open(png.string());
  ASSERT_TRUE(preview);
  std::vector<std::uint8_t> bytes(20 * 23 * 4);
  ASSERT_TRUE(preview->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, bytes.data()));
  EXPECT_EQ(bytes[2], 0);
  EXPECT_NEAR(bytes[0], 255.0f * tone_map(V3f(0.5f, 0.0f, 0.0f), 0.0f).x, 1.0f);
}

// With Open Image Denoise: nearer to the truth than what it is given. Without: says so.
TEST_F(Images, DenoisingIsNearerToTheTruth) {
  scene_.settings.crop.reset();
  add_rectangle(scene_, V3f(-1, 3, 0), V3f(1, 0, 0), V3f(0, 0, 1), 20.0f);
  scene_.settings.spp = 1024;
  const Film truth = render(scene_).film;
  scene_.settings.spp = 2;
  const Film noisy = render(scene_).film;
  if (denoiser_version().empty()) {
    EXPECT_THROW(denoise(noisy), std::runtime_error);
    return;
  }
  const std::vector<V3f> denoised = denoise(noisy);
  ASSERT_EQ(denoised.size(), 40u * 30u);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const V3f& t = truth.at(x, y).color;
      before += (noisy.at(x, y).color - t).length2();
      after += (denoised[static_cast<std::size_t>(y * 40 + x)] - t).length2();
    }
  EXPECT_LT(after, 0.5 * before);
}

TEST_F(Images, ExrClampsToTheRangeOfHalf) {
  scene_.environment->radiance = V3f(1e6f);
  const fs::path path = directory_ / "bright.exr";
  write_exr(path, scene_, render(scene_));
  const auto in = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(in);
  std::vector<float> red(20 * 23);
  const int c = in->spec().channelindex("R");
  ASSERT_TRUE(in->read_image(0, 0, c, c + 1, OIIO::TypeDesc::FLOAT, red.data()));
  EXPECT_EQ(*std::max_element(red.begin(), red.end()), 65504.0f);
}

TEST_F(Images, PngIsTheToneMappedWindow) {
  const RenderResult result = render(scene_);
  const fs::path path = directory_ / "image.png";
  write_png(path, result.film, 0.5f);
  EXPECT_EQ(files(), 1);
  const auto in = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(in) << OIIO::geterror();
  EXPECT_EQ(in->spec().width, 20);
  EXPECT_EQ(in->spec().height, 23);
  ASSERT_EQ(in->spec().nchannels, 4);
  std::vector<std::uint8_t> data(20 * 23 * 4);
  ASSERT_TRUE(in->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, data.data()));
  for (const auto& [x, y] : {std::pair{10, 5}, {20, 15}, {29, 27}}) {
    const V3f c = tone_map(result.film.at(x, y).color, 0.5f);
    const auto offset = static_cast<std::size_t>(((y - 5) * 20 + x - 10) * 4);
    EXPECT_NEAR(data[offset], c.x * 255.0f, 0.51f);
    EXPECT_NEAR(data[offset + 2], c.z * 255.0f, 0.51f);
    EXPECT_EQ(data[offset + 3], 255);
  }
}

// Errors name the file, and neither a broken nor a temporary file stays behind.
TEST_F(Images, FailuresNameTheFileAndLeaveNothing) {
  const RenderResult result = render(scene_);
  const auto expect_failure = [&](const fs::path& path, const auto& write) {
    try {
      write();
      FAIL() << path;
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
    }
  };
  const fs::path missing = directory_ / "no-such-folder" / "image.exr";
  expect_failure(missing, [&] { write_exr(missing, scene_, result); });
  expect_failure(missing, [&] { write_png(missing, result.film, 0.0f); });
  // A folder that has the file's name: writing succeeds, renaming cannot.
  const fs::path folder = directory_ / "folder.exr";
  fs::create_directories(folder / "inside");
  expect_failure(folder, [&] { write_exr(folder, scene_, result); });
  expect_failure(folder, [&] { write_png(folder, result.film, 0.0f); });
  EXPECT_EQ(files(), 1);  // the folder
}

// A disk that fills up while the picture is written (here: a limit of the size of files).
TEST_F(Images, AFullDiskLeavesTheOldPicture) {
  const RenderResult result = render(scene_);
  const fs::path png = directory_ / "image.png", exr = directory_ / "image.exr";
  write_png(png, result.film, 0.0f);
  write_exr(exr, scene_, result);
  const auto sizes = std::pair(fs::file_size(png), fs::file_size(exr));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{200, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_png(png, result.film, 0.0f), std::runtime_error);
  EXPECT_THROW(write_exr(exr, scene_, result), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(std::pair(fs::file_size(png), fs::file_size(exr)), sizes);
  EXPECT_EQ(files(), 2);
}

// Renaming over a device or a pipe would destroy it.
TEST_F(Images, OnlyRegularFilesAreReplaced) {
  const fs::path pipe = directory_ / "pipe.png";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(topology::require_replaceable(pipe), std::runtime_error);
  EXPECT_THROW(write_png(pipe, render(scene_).film, 0.0f), std::runtime_error);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_THROW(topology::require_replaceable("/dev/null"), std::runtime_error);

  // A link stays one; what it points to is replaced.
  const fs::path target = directory_ / "target.png", link = directory_ / "link.png";
  std::ofstream(target) << "old";
  fs::create_symlink("target.png", link);
  write_png(link, render(scene_).film, 0.0f);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_GT(fs::file_size(target), 3u);
  EXPECT_EQ(files(), 3);
}

TEST_F(Images, ReplacingFileKeepsTheOldOneUntilCommit) {
  const fs::path path = directory_ / "data.txt";
  const auto write = [](const fs::path& p, const char* text) { std::ofstream(p) << text; };
  const auto read = [&] {
    std::string s;
    std::ifstream(path) >> s;
    return s;
  };
  write(path, "old");
  {
    topology::ReplacingFile file(path);
    write(file.temporary_path(), "lost");
    EXPECT_EQ(file.temporary_path().parent_path(), path.parent_path());
  }
  EXPECT_EQ(read(), "old");
  EXPECT_EQ(files(), 1);
  {
    topology::ReplacingFile file(path);
    write(file.temporary_path(), "new");
    file.commit();
  }
  EXPECT_EQ(read(), "new");
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace morsel::render
