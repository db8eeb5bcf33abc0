// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace morsel::test {

// A file system in memory that holds no more than so many bytes, mounted at a folder for this
// process and its children alone. Mounting takes root, or a kernel that lets users have name spaces
// of their own; mounted() says whether it was possible.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, std::size_t bytes) : folder_(folder) {
    if (!own_name_space()) return;
    const std::string size = "size=" + std::to_string(bytes);
    mounted_ = ::mount("none", folder_.c_str(), "tmpfs", 0, size.c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool mounted() const { return mounted_; }

  // Takes all room but about `bytes`, in a file that is hidden.
  void fill_but(std::size_t bytes) const {
    std::filesystem::remove(filler());
    const std::size_t room = std::filesystem::space(folder_).available;
    if (room <= bytes) return;
    std::ofstream(filler(), std::ios::binary) << std::string(room - bytes, 'x');
  }
  void clear() const { std::filesystem::remove(filler()); }
  std::filesystem::path filler() const { return folder_ / ".filler"; }

 private:
  static bool own_name_space() {
    const uid_t user = ::getuid();
    const gid_t group = ::getgid();
    if (::unshare(CLONE_NEWNS) != 0) {
      if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
      std::ofstream("/proc/self/setgroups") << "deny";
      std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
      std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
    }
    return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  }

  std::filesystem::path folder_;
  bool mounted_ = false;
};

}  // namespace morsel::test
