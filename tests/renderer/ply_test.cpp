// SPDX-License-Identifier: Apache-2.0
// PLY files that are wrong: assimp's own reader ends the process for some of these.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "renderer/mesh/mesh_file.h"
#include "tests/temporary_folder.h"

namespace morsel::render {
namespace {

using morsel::test::TemporaryFolder;

std::string error_of(const std::filesystem::path& file) {
  try {
    load_mesh(file);
  } catch (const MeshError& e) {
    return e.what();
  }
  return "";
}

std::string header(const std::string& format, const std::string& vertex, const std::string& face) {
  return "ply\nformat " + format + " 1.0\n" + vertex + face + "end_header\n";
}
constexpr char kVertex[] =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
constexpr char kFace[] = "element face 1\nproperty list uchar int vertex_indices\n";
constexpr char kPoints[] = "0 0 0\n1 0 0\n0 1 0\n";

TEST(Ply, HeadersAreChecked) {
  const TemporaryFolder folder;
  const std::string vertex = kVertex, face = kFace;
  for (const auto& [text, what] :
       {std::pair{header("ascii", "elelent vertex 3\nproperty float x\n", face),
                  std::string("line 3: \"elelent\" is none of")},
        {header("ascii", "property float x\n", face), "line 3: a property of no element"},
        {header("ascii", "element vertex 3\nproperty float x\nproperty float y\n", face),
         "vertices have no z"},
        {header("ascii", "element vertex x\n", face), "line 3: an element has a name and a count"},
        {header("ascii", "element vertex 99999999999\n", face), "at most 2^31 - 1"},
        {header("ascii", vertex + vertex, face), "line 7: a second element vertex"},
        {header("ascii", vertex + "property half w\n", face), "line 7: \"half\" is not a type"},
        {header("ascii", vertex + "property float x\n", face), "line 7: a second property x"},
        {header("ascii", vertex, "element face 1\nproperty list float int vertex_indices\n"),
         "line 8: the length of a list is an integer"},
        {header("ascii", vertex, "element face 1\n"), "element face has no properties"},
        {header("ascii", "", face), "no element vertex"},
        {header("text", vertex, face), "line 2: format \"text\"; formats: ascii,"},
        {std::string("ply\n") + kVertex + "end_header\n", "the header has no format"},
        {std::string("ply\nformat ascii 1.0\n"), "line 3: \"0\" is none of"},
        {std::string("plx\n"), "line 1: a PLY file begins with"}}) {
    const std::string error = error_of(folder.write("bad.ply", text + kPoints + "3 0 1 2\n"));
    EXPECT_NE(error.find(what), std::string::npos) << text << error;
    EXPECT_NE(error.find("bad.ply"), std::string::npos) << error;
  }
}

TEST(Ply, ValuesAreChecked) {
  const TemporaryFolder folder;
  const std::string head = header("ascii", kVertex, kFace);
  for (const auto& [body, what] :
       {std::pair{std::string("0 0 0\n1 0 0\n"), "vertex 2 of 3: x is not there"},
        {std::string("0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n"), "vertex 1 of 3: z is not there, or not"},
        {std::string(kPoints), "face 0 of 1: vertex_indices has no length"},
        {std::string(kPoints) + "3 0 1\n", "face 0 of 1: vertex_indices is not there"},
        {std::string(kPoints) + "3 0 1 3\n", "face 0 of 1: names vertex 3, but there are 3"},
        {std::string(kPoints) + "3 0 1 -1\n", "face 0 of 1: names vertex -1"},
        {std::string(kPoints) + "-3 0 1 2\n", "has no length"},
        {std::string(kPoints) + "3 0 1 1.5\n", "is not there, or not a number of type int"}}) {
    const std::string error = error_of(folder.write("bad.ply", head + body));
    EXPECT_NE(error.find(what), std::string::npos) << body << error;
  }
  EXPECT_NE(error_of(folder.write("bad.ply", "ply\nformat ascii 1.0\n")).find("within its header"),
            std::string::npos);
  EXPECT_EQ(error_of(folder.write("good.ply", head + kPoints + "\n3 +0 1 2.0 \r\n")), "");
}

TEST(Ply, BinaryFilesAreCheckedToTheirEnds) {
  const TemporaryFolder folder;
  std::string body;
  const auto put = [&](const auto& value, bool big) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big) std::reverse(bytes, bytes + sizeof value);
    body.append(bytes, sizeof value);
  };
  for (const bool big : {false, true}) {
    body.clear();
    for (const float x : {0, 0, 0, 1, 0, 0, 0, 1, 0}) put(x, big);
    put(std::uint8_t{3}, big);
    for (const std::int32_t i : {0, 1, 2}) put(i, big);
    const std::string head =
        header(big ? "binary_big_endian" : "binary_little_endian", kVertex, kFace);
    EXPECT_EQ(error_of(folder.write("good.ply", head + body)), "");
    for (std::size_t length = 0; length < body.size(); ++length)
      EXPECT_NE(error_of(folder.write("bad.ply", head + body.substr(0, length))).find(" of "),
                std::string::npos)
          << length;
    std::string other = body;
    other[other.size() - (big ? 1 : 4)] = 7;
    EXPECT_NE(error_of(folder.write("bad.ply", head + other)).find("names vertex 7, but there"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace morsel::render
