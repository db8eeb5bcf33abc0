// SPDX-License-Identifier: Apache-2.0
// Live preview in tev, against a server that is as strict as it.
#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <gtest/gtest.h>

#include "command_scene.h"
#include "fake_tev.h"
#include "run_command.h"

namespace morsel::test {
namespace {

class TevTest : public ::testing::Test {
 protected:
  CommandResult render(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "scene.json", "-o", "a.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_morsel(arguments, {.folder = folder_.path()});
  }
  TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_.write("scene.json", kCommandScene);
};

TEST_F(TevTest, ShowsThePictureThatIsWritten) {
  FakeTev tev;
  const CommandResult result =
      render({"--resolution", "200x140", "--crop", "10,0,200,139", "--spp", "3", "--preview",
              "tev:127.0.0.1:" + std::to_string(tev.port)});
  tev.wait();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(tev.error, "");
  EXPECT_EQ(tev.image, "a.exr");
  EXPECT_EQ(tev.creations, 1);
  EXPECT_GE(tev.updates, 4);  // tiles of 128 pixels
  EXPECT_EQ(tev.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  ASSERT_EQ(tev.width, 200);
  ASSERT_EQ(tev.height, 140);

  Imf::RgbaInputFile exr((folder_ / "a.exr").c_str());
  Imf::Array2D<Imf::Rgba> expected(139, 190);
  exr.setFrameBuffer(&expected[0][0] - 10, 1, 190);
  exr.readPixels(0, 138);
  for (int y = 0; y < 140; ++y)
    for (int x = 0; x < 200; ++x) {
      const float* p = &tev.pixels[static_cast<std::size_t>(4 * (y * 200 + x))];
      if (x < 10 || y > 138) {
        ASSERT_EQ(p[0], -1.0f) << x << ", " << y;  // outside of the crop
        continue;
      }
      const Imf::Rgba& e = expected[y][x - 10];
      ASSERT_EQ(Imath::half(p[0]), e.r) << x << ", " << y;
      ASSERT_EQ(Imath::half(p[1]), e.g) << x << ", " << y;
      ASSERT_EQ(Imath::half(p[2]), e.b) << x << ", " << y;
      ASSERT_EQ(Imath::half(p[3]), e.a) << x << ", " << y;
    }
}

TEST_F(TevTest, WithoutAViewerRenderingGoesOn) {
  std::uint16_t port = 0;
  {
    FakeTev gone;
    port = gone.port;
  }
  const CommandResult result = render({"--preview", "tev:127.0.0.1:" + std::to_string(port)});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("goes on without a preview"), std::string::npos) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.exr"));
}

}  // namespace
}  // namespace morsel::test
