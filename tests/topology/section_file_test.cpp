// SPDX-License-Identifier: Apache-2.0
// The container of named sections: what was put in comes out, foreign sections are passed over, and
// a file that lies about itself, with checksums that match, gives an error.
#include "topology/section_file.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include "tests/temporary_folder.h"
#include "tests/topology/blobs.h"
#include "topology/cache_file.h"

namespace morsel::topology {
namespace {

namespace fs = std::filesystem;

struct Pair {
  std::uint32_t a, b;
};

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(in)), {});
}

// Offsets in the file, as topology/README.md gives them.
constexpr std::size_t kFileBytes = 16, kDirectory = 24, kChecksum = 56, kHeaderBytes = 64;

template <class T>
T get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <class T>
void set(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void seal(std::string& bytes) {
  const auto directory = std::min<std::size_t>(get<std::uint64_t>(bytes, kDirectory), bytes.size());
  const std::string covered = bytes.substr(0, kChecksum) + bytes.substr(directory);
  set<std::uint64_t>(bytes, kChecksum, XXH3_64bits(covered.data(), covered.size()));
}

class SectionFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = folder_.path() / "a.topo";
    SectionWriter writer(path_);
    std::vector<std::uint32_t> numbers(100);
    std::iota(numbers.begin(), numbers.end(), 7u);
    const std::vector<Pair> pairs{{1, 2}, {3, 4}, {5, 6}};
    writer.add_records<std::uint32_t>("numbers", numbers, true);
    writer.add_records<Pair>("pairs", pairs);
    writer.add("empty", {});
    const std::uint64_t size = writer.publish();
    EXPECT_EQ(size, fs::file_size(path_));
    good_ = contents(path_);
    directory_ = get<std::uint64_t>(good_, kDirectory);
  }
  std::string error_of(const std::string& bytes) {
    const fs::path file = folder_.path() / "bad.topo";
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      SectionFile read(file);
      for (const SectionEntry& e : read.entries()) read.read(e.name);
    } catch (const CacheError& e) {
      EXPECT_NE(std::string(e.what()).find("bad.topo"), std::string::npos);
      return e.what();
    }
    return "";
  }
  // The error after a change of the directory's record of section `i`, with a checksum that
  // matches.
  std::string error_with(int i, const std::function<void(std::string&, std::size_t)>& change) {
    std::string bytes = good_;
    change(bytes, directory_ + 64 * static_cast<std::size_t>(i));
    seal(bytes);
    return error_of(bytes);
  }

  test::TemporaryFolder folder_;
  fs::path path_;
  std::string good_;
  std::size_t directory_ = 0;
};

TEST_F(SectionFiles, RoundTrip) {
  const SectionFile file(path_);
  ASSERT_EQ(file.entries().size(), 3u);
  const auto numbers = file.read_records<std::uint32_t>("numbers");
  ASSERT_EQ(numbers.size(), 100u);
  EXPECT_EQ(numbers[99], 106u);
  EXPECT_EQ(file.read_records<Pair>("pairs")[2].b, 6u);
  EXPECT_TRUE(file.read("empty").empty());
  for (const SectionEntry& e : file.entries()) EXPECT_EQ(e.offset % 64, 0u);
  EXPECT_EQ(file.find("pairs")->count(), 3u);
  EXPECT_EQ(file.find("other"), nullptr);
  EXPECT_THROW(file.read("other"), CacheError);
  EXPECT_THROW(file.read_records<Pair>("numbers"), CacheError);
}

TEST_F(SectionFiles, OnlyRequiredSectionsMustBeKnown) {
  const SectionFile file(path_);
  const std::string_view known[] = {"numbers"}, others[] = {"pairs"};
  EXPECT_NO_THROW(file.require_known(known));
  EXPECT_THROW(file.require_known(others), CacheError);
}

TEST_F(SectionFiles, RefusesNamesThatReadersWouldRefuse) {
  SectionWriter writer(folder_.path() / "b.topo");
  EXPECT_THROW(writer.add("", {}), CacheError);
  EXPECT_THROW(writer.add("With Space", {}), CacheError);
  EXPECT_THROW(writer.add(std::string(32, 'a'), {}), CacheError);
  writer.add(std::string(31, 'a'), {});
  EXPECT_THROW(writer.add(std::string(31, 'a'), {}), CacheError);
  const std::byte three[3] = {};
  EXPECT_THROW(writer.add("odd", three, 2), CacheError);
  EXPECT_FALSE(fs::exists(folder_.path() / "b.topo"));
}

TEST_F(SectionFiles, HostileDirectories) {
  constexpr std::size_t kOffset = 32, kBytes = 40, kElement = 48, kFlags = 52;
  EXPECT_EQ(error_with(0, [](std::string&, std::size_t) {}), "");
  using U64 = std::uint64_t;
  for (const U64 value : {U64{0}, U64{1}, U64{63}, U64{65}, U64{1} << 40, ~U64{0}, ~U64{63}}) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_NE(error_with(i, [&](auto& s, std::size_t at) { set<U64>(s, at + kOffset, value); }),
                "")
          << value;
      if (i == 2 && value == 0) continue;  // as it is
      EXPECT_NE(error_with(i, [&](auto& s, std::size_t at) { set<U64>(s, at + kBytes, value); }),
                "")
          << value;
    }
  }
  for (const std::uint32_t value : {0u, 3u, 7u, 0xffffffffu})
    EXPECT_NE(error_with(
                  0, [&](auto& s, std::size_t at) { set<std::uint32_t>(s, at + kElement, value); }),
              "")
        << value;
  EXPECT_NE(error_with(0, [&](auto& s, std::size_t at) { set<std::uint32_t>(s, at + kFlags, 2); }),
            "");
  // Names: empty, without an end, twice the same, with what follows their end.
  EXPECT_NE(error_with(0, [](auto& s, std::size_t at) { s.replace(at, 32, 32, '\0'); }), "");
  EXPECT_NE(error_with(0, [](auto& s, std::size_t at) { s.replace(at, 32, 32, 'x'); }), "");
  EXPECT_NE(error_with(0, [](auto& s, std::size_t at) { s.replace(at, 8, "pairs\0\0\0", 8); }), "");
  EXPECT_NE(error_with(0, [](auto& s, std::size_t at) { s[at + 20] = 'y'; }), "");
  // The header: sizes and places that are not so.
  for (const U64 value : {U64{0}, U64{64}, U64{65}, U64{good_.size()}, ~U64{0}, ~U64{63}}) {
    std::string bytes = good_;
    set<U64>(bytes, kDirectory, value);
    seal(bytes);
    EXPECT_NE(error_of(bytes), "") << value;
  }
  for (const std::uint32_t count : {0u, 2u, 4u, 1025u, 0xffffffffu}) {
    std::string bytes = good_;
    set<std::uint32_t>(bytes, 12, count);
    seal(bytes);
    EXPECT_NE(error_of(bytes), "") << count;
  }
  // Bytes between sections, and cut or longer files.
  std::string bytes = good_;
  bytes[kHeaderBytes + 404] = 1;
  EXPECT_NE(error_of(bytes).find("not zero"), std::string::npos);
  for (std::size_t length = 0; length < good_.size(); length += 29) {
    bytes = good_.substr(0, length);
    EXPECT_NE(error_of(bytes), "") << length;
    if (length < kHeaderBytes) continue;
    set<U64>(bytes, kFileBytes, length);
    seal(bytes);
    EXPECT_NE(error_of(bytes), "") << length;
  }
  EXPECT_NE(error_of(good_ + "x"), "");
}

// Whoever gives a scene is told so, however short it is and whatever stands before its brace.
TEST_F(SectionFiles, ScenesAreTakenForWhatTheyAre) {
  for (const char* text :
       {"{}", "{\"morsel\": 1}", "// a rock\n{}", "\xEF\xBB\xBF{}", "\n  /* a rock */ {}"})
    EXPECT_NE(error_of(text).find("wrong first bytes, those of a JSON file or a scene"),
              std::string::npos)
        << error_of(text);
  EXPECT_NE(error_of("solid").find("wrong first bytes"), std::string::npos);
  EXPECT_NE(error_of("MORSBRIK").find("those of a brick file"), std::string::npos);
  EXPECT_NE(error_of("MORSRNDR").find("those of a render's checkpoint"), std::string::npos);
  for (const char* text : {"solid", "[section]", "/usr/bin", " \n "})
    EXPECT_EQ(error_of(text).find("scene"), std::string::npos) << error_of(text);
  for (const std::size_t length : {0u, 3u, 8u, 63u})
    EXPECT_NE(error_of(good_.substr(0, length)).find("bytes are fewer than its header has"),
              std::string::npos)
        << error_of(good_.substr(0, length));
}

// A cache keeps sections that its reader does not know, and a reader passes over them.
TEST_F(SectionFiles, CachesCarryForeignSections) {
  CertifyOptions options;
  options.box = Box(Imath::V3d(-2.0), Imath::V3d(2.0));
  TopologyCache cache;
  cache.topology = certify(testing::Blobs({{0, 0, 0}}, 1.0, 0.3), options);
  const std::vector<Pair> pairs{{1, 2}, {8, 9}};
  cache.sections.put_records<Pair>("engine.pairs", pairs);
  cache.sections.put_records<Pair>("engine.pairs", pairs);  // replaces
  const fs::path path = folder_.path() / "cache.topo";
  write_cache(cache, path);
  const TopologyCache back = read_cache(path);
  EXPECT_EQ(back.topology.components.size(), 1u);
  ASSERT_EQ(back.sections.all().size(), 1u);
  EXPECT_EQ(back.sections.records<Pair>("engine.pairs").at(1).b, 9u);
  EXPECT_TRUE(back.sections.records<Pair>("engine.other").empty());
  EXPECT_THROW(back.sections.records<std::uint32_t>("engine.pairs"), CacheError);
}

}  // namespace
}  // namespace morsel::topology
