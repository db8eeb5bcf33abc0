// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/embree/brick_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "hypertexture_geom/field/tape_check.h"
#include "topology/fingerprint.h"

namespace morsel::geom {
namespace {

using nlohmann::json;
using topology::CacheError;

// To be raised when the same field, octree and options make other bricks: with every change of
// brick_builder, brick_model, compiled fields or local models.
constexpr int kBrickVersion = 2;

constexpr std::string_view kMeta = "meta";      // JSON
constexpr std::string_view kBricks = "bricks";  // Brick
constexpr std::string_view kRanges = "ranges";  // SlopeRanges
std::string group_name(std::uint64_t group) { return fmt::format("blocks.{}", group); }

// Blocks are written in groups of at least so many bytes, and more where there would be more than
// so many groups: they are read in parallel, a group a task.
constexpr std::uint64_t kGroupBytes = 4u << 20, kMostGroups = 512;

// What a group has for each block, followed by its instructions, constants and integers.
struct BlockRecord {
  double box[6], centre[3], value_error, gradient_error[3];
  std::uint32_t instructions, constants, words;  // their numbers
  std::uint16_t registers, result;
  std::uint32_t refers_to_field;  // 0 or 1: then nothing follows, and the field is asked
  std::uint32_t reserved;         // 0
};
static_assert(sizeof(BlockRecord) == 128);

// JSON has its own text for every double; these are told apart by their bits.
std::string digits(double x) { return fmt::format("{:016x}", std::bit_cast<std::uint64_t>(x)); }

std::string fingerprint_of(const json& j) {
  const std::string text = j.dump();
  return topology::fingerprint(std::as_bytes(std::span(text)));
}

// Of what is rendered, and how.
json choice_of(const BrickFile::Source& source) {
  std::vector<std::uint8_t> kept(source.kept.begin(), source.kept.end());
  const BrickSet::Options& o = source.options;
  return {{"kept", topology::fingerprint(std::as_bytes(std::span(kept)))},
          {"block_levels", o.block_levels},
          {"slope_ranges", o.slope_ranges},
          {"error_ratio", digits(o.error_ratio)},
          {"merge_levels", o.merge_levels},
          {"split_levels", o.split_levels}};
}

json identity_of(const BrickFile::Source& source) {
  json box = json::array();
  for (int i = 0; i < 3; ++i) {
    box.push_back(digits(source.octree.box.min[i]));
    box.push_back(digits(source.octree.box.max[i]));
  }
  return {{"version", kBrickVersion},
          {"field", source.field_hash},
          {"choice", choice_of(source)},
          {"margin", digits(source.options.margin)},
          {"box", box},
          {"octree", topology::fingerprint(std::as_bytes(source.octree.nodes))}};
}

template <class T>
void append(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::span<const std::byte> more = std::as_bytes(std::span(values, count));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append_block(std::vector<std::byte>& bytes, const CompiledField<double>& block) {
  BlockRecord r{};
  const Tape<double>& tape = block.tape();
  for (int i = 0; i < 3; ++i) {
    r.box[i] = block.box().min[i];
    r.box[3 + i] = block.box().max[i];
    r.centre[i] = block.centre()[i];
    r.gradient_error[i] = block.gradient_error()[i];
  }
  r.value_error = block.value_error();
  r.refers_to_field = block.refers_to_field() ? 1 : 0;
  if (!block.refers_to_field()) {
    r.instructions = static_cast<std::uint32_t>(tape.instructions.size());
    r.constants = static_cast<std::uint32_t>(tape.constants.size());
    r.words = static_cast<std::uint32_t>(tape.words.size());
    r.registers = tape.registers;
    r.result = tape.result;
  }
  append(bytes, &r, 1);
  append(bytes, tape.instructions.data(), r.instructions);
  append(bytes, tape.constants.data(), r.constants);
  append(bytes, tape.words.data(), r.words);
}

// Takes records from the bytes of a group.
class GroupReader {
 public:
  GroupReader(std::span<const std::byte> bytes, std::string place)
      : rest_(bytes), place_(std::move(place)) {}

  bool at_end() const { return rest_.empty(); }
  template <class T>
  void take(T* values, std::size_t count) {
    if (count == 0) return;
    if (count > rest_.size() / sizeof(T)) fail("ends within a block");
    std::memcpy(values, rest_.data(), count * sizeof(T));
    rest_ = rest_.subspan(count * sizeof(T));
  }
  template <class T>
  void take(std::vector<T>& values, std::size_t count) {
    if (count > rest_.size() / sizeof(T)) fail("ends within a block");
    values.resize(count);
    take(values.data(), count);
  }
  [[noreturn]] void fail(const std::string& what) const { throw CacheError(place_ + ": " + what); }

 private:
  std::span<const std::byte> rest_;
  std::string place_;
};

// The box lies in `reach`, centres are finite; errors may be infinite.
bool is_sound(const BlockRecord& r, const topology::Box& reach) {
  const auto finite = [](double x) { return std::isfinite(x); };
  const auto bound = [](double x) { return x >= 0.0; };
  for (int i = 0; i < 3; ++i)
    if (!(reach.min[i] <= r.box[i] && r.box[i] <= r.box[3 + i] && r.box[3 + i] <= reach.max[i]))
      return false;
  return std::all_of(r.centre, r.centre + 3, finite) && bound(r.value_error) &&
         std::all_of(r.gradient_error, r.gradient_error + 3, bound) && r.refers_to_field <= 1 &&
         r.reserved == 0;
}

std::unique_ptr<CompiledField<double>> take_block(GroupReader& from,
                                                  const topology::ScalarField& field,
                                                  const topology::Box& reach) {
  BlockRecord r;
  from.take(&r, 1);
  if (!is_sound(r, reach)) from.fail("a block's record is not sound");
  CompiledField<double>::Parts parts;
  parts.box = {{r.box[0], r.box[1], r.box[2]}, {r.box[3], r.box[4], r.box[5]}};
  if (r.refers_to_field != 0) return std::make_unique<CompiledField<double>>(field, parts.box);
  parts.centre = {r.centre[0], r.centre[1], r.centre[2]};
  parts.value_error = r.value_error;
  parts.gradient_error = {r.gradient_error[0], r.gradient_error[1], r.gradient_error[2]};
  from.take(parts.tape.instructions, r.instructions);
  from.take(parts.tape.constants, r.constants);
  from.take(parts.tape.words, r.words);
  parts.tape.registers = r.registers;
  parts.tape.result = r.result;
  if (const std::string problem = problem_of(parts.tape); !problem.empty()) from.fail(problem);
  return std::make_unique<CompiledField<double>>(std::move(parts));
}

bool is_sound(const Brick& b, std::uint64_t blocks, std::size_t components) {
  const auto finite = [](float x) { return std::isfinite(x); };
  const float errors[] = {b.value_error, b.gradient_error, b.hessian_error, b.rounding};
  for (const float e : errors)
    if (!finite(e) || e < 0.0f) return false;
  for (int i = 0; i < 3; ++i)
    if ((b.cell[i] >> b.depth) != 0 || b.surface_lo[i] >= b.surface_hi[i] ||
        b.surface_hi[i] > Brick::kSlices)
      return false;
  return std::all_of(std::begin(b.c), std::end(b.c), finite) && b.block < blocks &&
         (b.undecided ? b.component == topology::kNoComponent : b.component < components) &&
         std::all_of(std::begin(b.reserved), std::end(b.reserved),
                     [](std::uint8_t r) { return r == 0; });
}

// A byte that is neither 0 nor 1 must not be read as a bool.
bool flags_are_sound(std::span<const Brick> bricks) {
  return std::all_of(bricks.begin(), bricks.end(), [](const Brick& b) {
    std::uint8_t flag;
    std::memcpy(&flag, &b.undecided, 1);
    return flag <= 1;
  });
}

}  // namespace

BrickFile::BrickFile(const std::filesystem::path& stem, const Source& source)
    : fingerprint_(fingerprint_of(identity_of(source))),
      path_(fmt::format("{}-{}.bricks", stem.string(),
                        fingerprint_of(choice_of(source)).substr(0, 8))),
      root_(source.octree.box),
      components_(source.kept.size()),
      options_(source.options) {}

std::optional<BrickSet> BrickFile::read(const topology::ScalarField& field,
                                        const topology::Execution& execution) const {
  std::error_code error;
  if (std::filesystem::status(path_, error).type() == std::filesystem::file_type::not_found)
    return std::nullopt;
  const topology::SectionFile file(path_, kBrickFormat);
  const auto fail = [&](const std::string& what) {
    throw CacheError(fmt::format("{}: {}", file.name(), what));
  };
  const std::vector<std::byte> text = file.read(kMeta);
  const auto* first = reinterpret_cast<const char*>(text.data());
  const json meta = json::parse(first, first + text.size(), nullptr, false);
  const auto number = [&](const char* key) -> std::uint64_t {
    const auto found = meta.find(key);
    if (found == meta.end() || !found->is_number_unsigned())
      fail(fmt::format("its metadata has no number \"{}\"", key));
    return found->get<std::uint64_t>();
  };
  if (!meta.is_object() || !meta.contains("fingerprint")) fail("its metadata is not sound");
  if (meta["fingerprint"] != fingerprint_) return std::nullopt;

  BrickSet set(root_, options_);
  const std::uint64_t blocks = number("blocks"), groups = number("groups");
  set.bricks_ = file.read_records<Brick>(kBricks);
  if (options_.slope_ranges) set.ranges_ = file.read_records<SlopeRanges>(kRanges);
  if (set.ranges_.size() != (options_.slope_ranges ? set.bricks_.size() : 0))
    fail("it has not one range of slopes for each brick");
  if (!flags_are_sound(set.bricks_)) fail("a brick is not sound");
  // A block has its record at least, so there are no more than the file is long.
  if (blocks > file.bytes() / sizeof(BlockRecord) || groups > file.entries().size())
    fail(fmt::format("{} blocks in {} groups are more than it holds", blocks, groups));
  for (std::size_t i = 0; i < set.bricks_.size(); ++i)
    if (!is_sound(set.bricks_[i], blocks, components_))
      fail(fmt::format("brick {} is not sound", i));

  const Imath::V3d margin(options_.margin);
  const topology::Box reach(root_.min - margin, root_.max + margin);
  std::vector<std::vector<BrickSet::Block>> parts(groups);
  tbb::parallel_for(std::uint64_t{0}, groups, [&](std::uint64_t g) {
    execution.check_cancel();
    const std::vector<std::byte> bytes = file.read(group_name(g));
    GroupReader from(bytes, fmt::format("{}: section \"{}\"", file.name(), group_name(g)));
    while (!from.at_end()) parts[g].push_back(take_block(from, field, reach));
  });
  for (std::vector<BrickSet::Block>& part : parts)
    std::move(part.begin(), part.end(), std::back_inserter(set.blocks_));
  if (set.blocks_.size() != blocks)
    fail(fmt::format("it has {} blocks instead of {}", set.blocks_.size(), blocks));
  topology::remove_leftovers(path_);
  return set;
}

void BrickFile::write(const BrickSet& bricks) const {
  std::error_code ignored;  // writing says it
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  topology::SectionWriter file(path_, kBrickFormat);
  file.add_records(kBricks, std::span<const Brick>(bricks.bricks_));
  if (options_.slope_ranges)
    file.add_records(kRanges, std::span<const SlopeRanges>(bricks.ranges_));
  const std::uint64_t group_bytes = std::max(kGroupBytes, bricks.bytes() / kMostGroups);
  std::uint64_t groups = 0;
  std::vector<std::byte> group;
  const auto flush = [&] {
    file.add(group_name(groups++), group);
    group.clear();
  };
  for (const BrickSet::Block& block : bricks.blocks_) {
    append_block(group, *block);
    if (group.size() >= group_bytes) flush();
  }
  if (!group.empty()) flush();
  const std::string meta = json{
      {"fingerprint", fingerprint_},
      {"bricks", bricks.bricks_.size()},
      {"blocks", bricks.blocks_.size()},
      {"groups", groups}}.dump();
  file.add(kMeta, std::as_bytes(std::span(meta)));
  file.publish();
}

}  // namespace morsel::geom
