// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "command_scene.h"
#include "hypertexture_geom/field/field.h"
#include "run_command.h"

namespace morsel::test {
namespace {

using nlohmann::json;

class FieldCommandTest : public ::testing::Test {
 protected:
  CommandResult eval(const std::string& points, const std::string& scene) {
    CommandOptions options;
    options.input = points;
    return run_morsel({"field", "eval", scene, "--points", "-"}, options);
  }

  TemporaryFolder folder_;
  std::string rock_ = folder_.write("rock.json", kCommandScene).string();
  std::string ball_ = folder_.write("ball.json", kBallScene).string();
};

TEST_F(FieldCommandTest, EvalPrintsValueAndGradient) {
  const CommandResult result = eval("0 0 0\n\n 3e0\t-4 +0 \r\n0.1 0.2 0.3", ball_);
  ASSERT_EQ(result.code, 0) << result.err;
  std::istringstream lines(result.out);
  double f, x, y, z;
  ASSERT_TRUE(lines >> f >> x >> y >> z);
  EXPECT_EQ(f, 0.99);
  ASSERT_TRUE(lines >> f >> x >> y >> z);
  EXPECT_NEAR(f, 1 - std::sqrt(25 + 1e-4), 1e-15);
  EXPECT_NEAR(x, -0.6, 1e-5);
  EXPECT_NEAR(y, 0.8, 1e-5);
  EXPECT_EQ(z, 0);
  ASSERT_TRUE(lines >> f >> x >> y >> z);
  EXPECT_FALSE(lines >> f);
}

TEST_F(FieldCommandTest, EvalPrintsEveryDigit) {
  const auto field =
      geom::field_from_json(json::parse(kCommandScene)["geometries"][0]["field"], {"test", ""});
  const Imath::V3d p(0.31, -0.77, 0.123456789);
  const CommandResult result = eval("0.31 -0.77 0.123456789\n", rock_);
  std::istringstream lines(result.out);
  double f, x, y, z;
  ASSERT_TRUE(lines >> f >> x >> y >> z) << result.out << result.err;
  const topology::Jet jet = field->jet(p);
  EXPECT_EQ(f, jet.value);
  EXPECT_EQ(Imath::V3d(x, y, z), jet.gradient);
}

TEST_F(FieldCommandTest, EvalNamesBadLines) {
  for (const char* bad : {"1 2", "1 2 3 4", "a b c", "1 2 nan", "1 2 inf", "1,2,3", "1 2 1e999"}) {
    const CommandResult result = eval(std::string("0 0 0\n") + bad + "\n", ball_);
    EXPECT_EQ(result.code, 2) << bad;
    EXPECT_EQ(result.out, "") << bad;
    EXPECT_NE(result.err.find("line 2"), std::string::npos) << bad << ": " << result.err;
    EXPECT_NE(result.err.find(bad), std::string::npos) << bad << ": " << result.err;
  }
  for (const char* far : {"1e300 0 0", "0 -1000001 0", "0 0 1e7"}) {
    const CommandResult result = eval(std::string("-1e6 1e6 0\n") + far + "\n", ball_);
    EXPECT_EQ(result.code, 2) << far;
    EXPECT_EQ(result.out, "") << far;
    EXPECT_NE(result.err.find("line 2"), std::string::npos) << far << ": " << result.err;
    EXPECT_NE(result.err.find("between -1000000 and 1000000"), std::string::npos) << result.err;
  }
  EXPECT_EQ(eval("-1e6 1e6 0\n", ball_).code, 0);
  const std::string gone = (folder_ / "gone.txt").string();
  const CommandResult missing = run_morsel({"field", "eval", ball_, "--points", gone});
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find(gone), std::string::npos);
}

TEST_F(FieldCommandTest, EvalTakesGeometryByNameAndOverrides) {
  const std::string points = folder_.write("points.txt", "0 0 0\n").string();
  const CommandResult result =
      run_morsel({"field", "eval", ball_, "--geometry", "ball", "--points", points, "--set",
                  "geometries.ball.field.density.radius=2"});
  EXPECT_EQ(result.out.substr(0, result.out.find(' ')), "1.99");
}

// The samples of a file whose header is known, as doubles.
std::vector<double> doubles(const std::string& bytes, std::size_t offset, std::size_t count) {
  std::vector<double> values(count);
  if (bytes.size() < offset + count * sizeof(double)) throw std::runtime_error("file too short");
  std::memcpy(values.data(), bytes.data() + offset, count * sizeof(double));
  return values;
}

TEST_F(FieldCommandTest, SampleWritesNpyIndexedZYX) {
  const std::size_t n = 21;  // more than one block of samples along each axis, and not a multiple
  const std::string file = (folder_ / "a.npy").string();
  const CommandResult result = run_morsel(
      {"field", "sample", rock_, "--resolution", std::to_string(n), "-o", file, "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json info = json::parse(result.out);
  const std::string bytes = read_text(file);
  ASSERT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t header =
      10 + static_cast<unsigned char>(bytes[8]) + 256 * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ(header % 64, 0u);
  EXPECT_EQ(bytes[header - 1], '\n');
  EXPECT_EQ(bytes.substr(10, 64),
            "{'descr': '<f8', 'fortran_order': False, 'shape': (21, 21, 21), ");
  ASSERT_EQ(bytes.size(), header + n * n * n * 8);
  const std::vector<double> values = doubles(bytes, header, n * n * n);

  const auto field =
      geom::field_from_json(json::parse(kCommandScene)["geometries"][0]["field"], {"test", ""});
  Imath::V3d low, high;
  for (int i = 0; i < 3; ++i) {
    low[i] = info["box"]["min"][static_cast<std::size_t>(i)];
    high[i] = info["box"]["max"][static_cast<std::size_t>(i)];
  }
  EXPECT_EQ(low, Imath::V3d(-2.5));
  double lowest = values[0], highest = values[0];
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const Imath::V3d t(i / 20.0, j / 20.0, k / 20.0);
        const double value = values[(k * n + j) * n + i];
        EXPECT_NEAR(value, field->value(low + (high - low) * t), 1e-12);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
      }
  EXPECT_EQ(info["value"]["min"], lowest);
  EXPECT_EQ(info["value"]["max"], highest);
}

TEST_F(FieldCommandTest, SampleWritesVti) {
  const std::string file = (folder_ / "a.vti").string();
  ASSERT_EQ(run_morsel({"field", "sample", ball_, "--resolution", "4", "-o", file}).code, 0);
  const std::string bytes = read_text(file);
  EXPECT_NE(bytes.find("WholeExtent=\"0 3 0 3 0 3\""), std::string::npos);
  EXPECT_NE(bytes.find("Origin=\"-1.5 -1.5 -1.5\" Spacing=\"1 1 1\""), std::string::npos);
  const std::size_t start = bytes.find("\n_") + 2;
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + start, sizeof size);
  EXPECT_EQ(size, 4u * 4 * 4 * 8);
  const std::vector<double> values = doubles(bytes, start + 8, 64);
  // (0.5, -1.5, -0.5)
  EXPECT_NEAR(values[2 + 0 * 4 + 1 * 16], 1 - std::sqrt(2.75 + 1e-4), 1e-14);
  EXPECT_EQ(bytes.substr(start + 8 + size), "\n  </AppendedData>\n</VTKFile>\n");
}

TEST_F(FieldCommandTest, SampleLeavesNothingWhenItFails) {
  const std::string file = (folder_ / "gone/a.npy").string();
  const CommandResult result =
      run_morsel({"field", "sample", ball_, "--resolution", "4", "-o", file});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find(file), std::string::npos) << result.err;
  EXPECT_EQ(folder_.count_files(), 2u);
}

}  // namespace
}  // namespace morsel::test
