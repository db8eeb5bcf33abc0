// SPDX-License-Identifier: Apache-2.0
#include "topology/octree_codec.h"

#include <fmt/format.h>

#include <bit>

#include "topology/certified.h"
#include "topology/section_file.h"

namespace morsel::topology {
namespace {

// What two bits say of a node.
enum Code : unsigned { kInner = 0, kEmptyLeaf = 1, kFullLeaf = 2, kSurfaceLeaf = 3 };

class BitWriter {
 public:
  // The lower `count` bits, lowest first; count <= 32.
  void put(std::uint64_t bits, int count) {
    pending_ |= bits << filled_;
    filled_ += count;
    while (filled_ >= 8) {
      bytes_.push_back(static_cast<std::byte>(pending_ & 0xffu));
      pending_ >>= 8;
      filled_ -= 8;
    }
  }
  std::vector<std::byte> finish() {
    if (filled_ > 0) put(0, 8 - filled_);
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::uint64_t pending_ = 0;
  int filled_ = 0;
};

class BitReader {
 public:
  BitReader(std::span<const std::byte> bytes, const std::string& where)
      : bytes_(bytes), where_(where) {}

  std::uint32_t get(int count) {
    while (filled_ < count) {
      if (next_ == bytes_.size()) throw CacheError(where_ + ": octree: ends too early");
      pending_ |= static_cast<std::uint64_t>(bytes_[next_++]) << filled_;
      filled_ += 8;
    }
    const auto bits = static_cast<std::uint32_t>(pending_ & ((std::uint64_t{1} << count) - 1));
    pending_ >>= count;
    filled_ -= count;
    return bits;
  }
  // Nothing but the zeros that fill the last byte is left.
  bool at_end() const { return next_ == bytes_.size() && filled_ < 8 && pending_ == 0; }

 private:
  std::span<const std::byte> bytes_;
  const std::string& where_;
  std::size_t next_ = 0;
  std::uint64_t pending_ = 0;
  int filled_ = 0;
};

// Components: a bit 1 for "as the leaf before", else a bit 0, six bits for the length of the
// number, and the number (component + 1; 0 for none).
class ComponentCoder {
 public:
  void put(BitWriter& out, std::uint32_t component) {
    out.put(component == last_, 1);
    if (component == last_) return;
    last_ = component;
    const std::uint32_t number = component + 1;  // kNoComponent becomes 0
    const int length = std::bit_width(number);
    out.put(static_cast<unsigned>(length), 6);
    out.put(number, length);
  }
  std::uint32_t get(BitReader& in) {
    if (in.get(1) != 0) return last_;
    const int length = static_cast<int>(in.get(6));
    last_ = length > 32 ? kNoComponent - 1 : in.get(length) - 1;
    return last_;
  }

 private:
  std::uint32_t last_ = kNoComponent;
};

std::uint16_t faces_of(Content content) {
  OctreeNode node;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) node.set_face_content(axis, side, content);
  return node.faces;
}

class Packer {
 public:
  explicit Packer(std::span<const OctreeNode> nodes) : nodes_(nodes) {}
  std::vector<std::byte> run() {
    put(nodes_[0]);
    below(nodes_[0]);
    return out_.finish();
  }

 private:
  void put(const OctreeNode& node) {
    if (!node.is_leaf()) return out_.put(kInner, 2);
    switch (node.cell_content()) {
      case Content::kEmpty:
        return out_.put(kEmptyLeaf, 2);
      case Content::kFull:
        out_.put(kFullLeaf, 2);
        return components_.put(out_, node.component);
      default:
        out_.put(kSurfaceLeaf, 2);
        out_.put(node.cell_content() == Content::kUndecided, 1);
        out_.put(node.faces, 12);
        components_.put(out_, node.component);
    }
  }
  void below(const OctreeNode& node) {
    if (node.is_leaf()) return;
    for (std::uint32_t i = 0; i < 8; ++i) put(nodes_[node.first_child + i]);
    for (std::uint32_t i = 0; i < 8; ++i) below(nodes_[node.first_child + i]);
  }

  std::span<const OctreeNode> nodes_;
  BitWriter out_;
  ComponentCoder components_;
};

class Unpacker {
 public:
  Unpacker(std::span<const std::byte> bytes, std::uint64_t count, std::uint64_t components,
           const std::string& where, const Execution& execution)
      : in_(bytes, where),
        count_(count),
        components_(components),
        where_(where),
        execution_(execution) {
    if (count == 0 || count >= kNoComponent || count / 4 > bytes.size())
      bad(fmt::format("{} nodes in {} bytes", count, bytes.size()));
    nodes_.reserve(count);
  }
  std::vector<OctreeNode> run() {
    nodes_.push_back(get());
    below(0, 0);
    if (nodes_.size() != count_) bad(fmt::format("{} nodes instead of {}", nodes_.size(), count_));
    if (!in_.at_end()) bad("goes on after its last node");
    return std::move(nodes_);
  }

 private:
  [[noreturn]] void bad(const std::string& what) const {
    throw CacheError(fmt::format("{}: octree: {}", where_, what));
  }

  // An inner node comes back with first_child = 1, to be set.
  OctreeNode get() {
    OctreeNode node;
    const auto leaf = [&](Content content) {
      node.content = static_cast<std::uint8_t>(content);
      node.faces = faces_of(content);
    };
    switch (in_.get(2)) {
      case kInner:
        node.content = static_cast<std::uint8_t>(Content::kUndecided);
        node.first_child = 1;
        return node;
      case kEmptyLeaf:
        leaf(Content::kEmpty);
        return node;
      case kFullLeaf:
        leaf(Content::kFull);
        break;
      default:
        leaf(in_.get(1) != 0 ? Content::kUndecided : Content::kConnected);
        node.faces = static_cast<std::uint16_t>(in_.get(12));
    }
    node.component = coder_.get(in_);
    const bool none = node.component == kNoComponent;
    if (none ? node.cell_content() != Content::kUndecided : node.component >= components_)
      bad(fmt::format("node {}: component that is not in the table", nodes_.size()));
    return node;
  }

  void below(std::uint32_t index, int depth) {
    if (nodes_[index].is_leaf()) return;
    if (depth >= kMaxDepth) bad("deeper than the limit");
    if (nodes_.size() + 8 > count_) bad("more nodes than its header says");
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index].first_child = first;
    for (int i = 0; i < 8; ++i) nodes_.push_back(get());
    if (nodes_.size() >= next_report_) report();
    for (std::uint32_t i = 0; i < 8; ++i) below(first + i, depth + 1);
  }

  void report() {
    if (execution_.progress)
      execution_.progress(static_cast<double>(nodes_.size()) / static_cast<double>(count_),
                          "reading");
    execution_.check_cancel();
    next_report_ += std::max<std::uint64_t>(count_ / 64, 1);
  }

  BitReader in_;
  std::uint64_t count_, components_;
  const std::string& where_;
  const Execution& execution_;
  std::uint64_t next_report_ = 0;
  std::vector<OctreeNode> nodes_;
  ComponentCoder coder_;
};

}  // namespace

std::vector<std::byte> pack_octree(std::span<const OctreeNode> nodes) {
  return Packer(nodes).run();
}

std::vector<OctreeNode> unpack_octree(std::span<const std::byte> bytes, std::uint64_t nodes,
                                      std::uint64_t components, const std::string& where,
                                      const Execution& execution) {
  return Unpacker(bytes, nodes, components, where, execution).run();
}

}  // namespace morsel::topology
