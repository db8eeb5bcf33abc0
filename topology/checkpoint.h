// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "topology/octree.h"

namespace morsel::topology {

// The trees of an octree that a build has finished, in a file beside the cache that it is for, so
// that a build that is interrupted goes on where it was. Trees are appended as they are finished;
// each carries a checksum, and what follows the first damaged one is cut off. A file of another
// build is begun anew. One that another process works with is left alone: this build goes on
// without.
class Checkpoint {
 public:
  // `key` says what is built: everything that trees depend on. Throws CacheError when the file can
  // neither be read nor made.
  Checkpoint(const std::filesystem::path& path, const std::string& key);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  // The nodes of a tree that is there; empty: it is not. Each can be taken once.
  std::vector<OctreeNode> take(std::uint32_t tree);
  // From any thread. A tree that cannot be written is not an error: the build goes on without.
  void save(std::uint32_t tree, const std::vector<OctreeNode>& nodes);
  // How many trees were there when the file was opened.
  std::size_t found() const { return found_; }
  bool is_empty() const;
  // Takes the file away, unless it is another process's.
  void remove();

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t nodes = 0;  // 0: not there
  };
  void read(const std::string& key);
  [[noreturn]] void fail_to_write(int why);  // of the constructor

  std::filesystem::path path_;
  std::mutex mutex_;
  int fd_ = -1;
  std::uint64_t end_ = 0;
  std::vector<Place> places_;
  std::size_t found_ = 0;
};

}  // namespace morsel::topology
