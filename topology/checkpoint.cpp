// SPDX-License-Identifier: Apache-2.0
#include "topology/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <span>

#include "topology/section_file.h"

namespace morsel::topology {
namespace {

// The last character is to be changed with everything that changes a tree: how models are bounded,
// what the cascade asks, when a cell is divided.
constexpr char kMagic[8] = {'M', 'O', 'R', 'S', 'T', 'R', 'E', '2'};
constexpr std::uint32_t kMaxTrees = 1u << 20;

struct Header {
  char magic[8];
  std::uint64_t key;  // XXH3
};

struct Record {
  std::uint32_t tree;
  std::uint32_t nodes;
  std::uint64_t checksum;  // XXH3 of the nodes, which follow, seeded with the tree's number
};

std::uint64_t checksum_of(std::uint32_t tree, std::span<const OctreeNode> nodes) {
  return XXH3_64bits_withSeed(nodes.data(), nodes.size_bytes(), tree);
}

bool read_at(int fd, std::uint64_t offset, void* out, std::size_t bytes) {
  auto* to = static_cast<char*>(out);
  while (bytes > 0) {
    const ssize_t n = ::pread(fd, to, bytes, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    to += n;
    offset += static_cast<std::uint64_t>(n);
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

bool write_at(int fd, std::uint64_t offset, const void* from, std::size_t bytes) {
  const auto* data = static_cast<const char*>(from);
  while (bytes > 0) {
    const ssize_t n = ::pwrite(fd, data, bytes, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    offset += static_cast<std::uint64_t>(n);
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

// The nodes form one tree from node 0: what the builder relies on.
bool is_tree(std::span<const OctreeNode> nodes) {
  if (nodes.empty()) return false;
  std::vector<bool> seen(nodes.size(), false);
  std::vector<std::uint32_t> stack{0};
  std::size_t visited = 0;
  while (!stack.empty()) {
    const std::uint32_t n = stack.back();
    stack.pop_back();
    if (seen[n] || nodes[n].content > 3) return false;
    seen[n] = true;
    ++visited;
    if (nodes[n].is_leaf()) continue;
    if (std::uint64_t{nodes[n].first_child} + 8 > nodes.size()) return false;
    for (std::uint32_t i = 0; i < 8; ++i) stack.push_back(nodes[n].first_child + i);
  }
  return visited == nodes.size();
}

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& path, const std::string& key) : path_(path) {
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd_ < 0)
    throw CacheError(fmt::format("{}: cannot open: {}", path.string(), std::strerror(errno)));
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(fd_);
    fd_ = -1;
    return;
  }
  read(key);
}

Checkpoint::~Checkpoint() {
  if (fd_ >= 0) ::close(fd_);
}

void Checkpoint::remove() {
  if (fd_ >= 0) ::unlink(path_.c_str());
}

void Checkpoint::read(const std::string& key) {
  Header expected;
  std::memcpy(expected.magic, kMagic, sizeof kMagic);
  expected.key = XXH3_64bits(key.data(), key.size());
  struct stat status = {};
  const std::uint64_t size =
      ::fstat(fd_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  Header header;
  end_ = sizeof header;
  const bool ours = size >= sizeof header && read_at(fd_, 0, &header, sizeof header) &&
                    std::memcmp(&header, &expected, sizeof header) == 0;
  if (!ours) {
    if (::ftruncate(fd_, 0) == 0 && write_at(fd_, 0, &expected, sizeof expected)) return;
    const int why = errno;
    ::unlink(path_.c_str());  // there is nothing in it
    fail_to_write(why);
  }
  std::vector<OctreeNode> nodes;
  for (Record record; size - end_ >= sizeof record;) {
    if (!read_at(fd_, end_, &record, sizeof record)) break;
    const std::uint64_t begin = end_ + sizeof record;
    if (record.tree >= kMaxTrees || record.nodes == 0 ||
        record.nodes > (size - begin) / sizeof(OctreeNode))
      break;
    nodes.resize(record.nodes);
    if (!read_at(fd_, begin, nodes.data(), nodes.size() * sizeof(OctreeNode)) ||
        checksum_of(record.tree, nodes) != record.checksum || !is_tree(nodes))
      break;
    if (record.tree >= places_.size()) places_.resize(record.tree + 1);
    found_ += places_[record.tree].nodes == 0;
    places_[record.tree] = {begin, record.nodes};
    end_ = begin + record.nodes * sizeof(OctreeNode);
  }
  if (::ftruncate(fd_, static_cast<off_t>(end_)) != 0) fail_to_write(errno);
}

void Checkpoint::fail_to_write(int why) {
  ::close(fd_);
  throw CacheError(fmt::format("{}: cannot write: {}", path_.string(), std::strerror(why)));
}

bool Checkpoint::is_empty() const { return fd_ < 0 || end_ == sizeof(Header); }

std::vector<OctreeNode> Checkpoint::take(std::uint32_t tree) {
  Place place;
  {
    const std::lock_guard lock(mutex_);
    if (tree >= places_.size()) return {};
    place = places_[tree];
    places_[tree] = {};
  }
  std::vector<OctreeNode> nodes(place.nodes);
  if (!read_at(fd_, place.offset, nodes.data(), nodes.size() * sizeof(OctreeNode))) return {};
  return nodes;
}

void Checkpoint::save(std::uint32_t tree, const std::vector<OctreeNode>& nodes) {
  const Record record{tree, static_cast<std::uint32_t>(nodes.size()), checksum_of(tree, nodes)};
  const std::lock_guard lock(mutex_);
  if (fd_ < 0) return;
  // The record last: a build that dies in between leaves one that its checksum refuses.
  if (write_at(fd_, end_ + sizeof record, nodes.data(), nodes.size() * sizeof(OctreeNode)) &&
      write_at(fd_, end_, &record, sizeof record))
    end_ += sizeof record + nodes.size() * sizeof(OctreeNode);
}

}  // namespace morsel::topology
