// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "topology/replacing_file.h"

namespace morsel::topology {

// What is wrong with a cache file: the message names the file and the place in it.
struct CacheError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The error of records that are `found` bytes long instead of `expected`.
CacheError wrong_record_size(std::string_view file, std::string_view section, std::size_t found,
                             std::size_t expected);

// What a file of sections is for: told apart by its first 8 bytes and a version.
struct SectionFormat {
  char magic[9];  // and the zero that ends it
  std::uint32_t version;
  const char* description;  // for messages: "not a ..."
};
inline constexpr SectionFormat kTopologyFormat{"MORSTOPO", 2, "topology cache"};

// The container that `.topo` files and the checkpoints of renders are: named sections of bytes,
// each at a multiple of 64, a directory that says where, and a checksum for each. A reader needs to
// know only the sections that it wants: others are skipped, unless they are marked as required.
// Layout: see README.md.
struct SectionEntry {
  std::string name;  // 1 to 31 characters of a-z 0-9 _ - .
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;          // a multiple of element_bytes
  std::uint32_t element_bytes = 1;  // size of one record
  bool required = false;            // a reader that does not know it must refuse the file
  std::uint64_t checksum = 0;       // XXH3 of its bytes

  std::uint64_t count() const { return bytes / element_bytes; }
};

// Writes sections one after the other to a temporary file beside the target; `publish` renames it.
// Without that call nothing remains. Every method throws CacheError.
class SectionWriter {
 public:
  explicit SectionWriter(const std::filesystem::path& target,
                         const SectionFormat& format = kTopologyFormat);
  ~SectionWriter();
  SectionWriter(const SectionWriter&) = delete;
  SectionWriter& operator=(const SectionWriter&) = delete;

  void add(std::string_view name, std::span<const std::byte> bytes, std::uint32_t element_bytes = 1,
           bool required = false);
  // An array of records without padding.
  template <class T>
  void add_records(std::string_view name, std::span<const T> records, bool required = false) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(name, std::as_bytes(records), sizeof(T), required);
  }
  // Returns the size of the file.
  std::uint64_t publish();

 private:
  void write(std::span<const std::byte> bytes);
  void pad();
  [[noreturn]] void fail(const char* what) const;

  ReplacingFile file_;
  std::string target_;
  SectionFormat format_;
  int fd_ = -1;
  std::uint64_t offset_ = 0;
  std::vector<SectionEntry> entries_;
};

// Opens a file and validates its header and directory: sizes, offsets, counts, names, overlaps,
// checksum of both. The sections' own checksums are checked as they are read.
class SectionFile {
 public:
  // Throws CacheError that names the file and what is wrong.
  explicit SectionFile(const std::filesystem::path& path,
                       const SectionFormat& format = kTopologyFormat);
  ~SectionFile();
  SectionFile(const SectionFile&) = delete;
  SectionFile& operator=(const SectionFile&) = delete;

  const std::string& name() const { return name_; }
  std::uint64_t bytes() const { return size_; }
  const std::vector<SectionEntry>& entries() const { return entries_; }
  const SectionEntry* find(std::string_view name) const;  // null: there is none

  // Throws CacheError when one is marked as required that is not among `known`.
  void require_known(std::span<const std::string_view> known) const;

  // The bytes of a section. Throws CacheError when it is missing, cannot be read or is damaged.
  std::vector<std::byte> read(std::string_view name) const;
  template <class T>
  std::vector<T> read_records(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const SectionEntry& entry = get(name);
    if (entry.element_bytes != sizeof(T))
      throw wrong_record_size(name_, entry.name, entry.element_bytes, sizeof(T));
    std::vector<T> records(entry.count());
    read_into(entry, std::as_writable_bytes(std::span(records)));
    return records;
  }

 private:
  const SectionEntry& get(std::string_view name) const;
  void read_at(std::uint64_t offset, std::span<std::byte> out) const;
  void read_into(const SectionEntry& entry, std::span<std::byte> out) const;
  void read_directory(const SectionFormat& format);

  std::string name_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::vector<SectionEntry> entries_;
};

// A section held in memory, for whoever knows what it means.
struct Section {
  std::string name;
  std::uint32_t element_bytes = 1;
  std::vector<std::byte> bytes;
};

// Sections beside those that every cache has, by name: other engines keep their results here.
class Sections {
 public:
  const std::vector<Section>& all() const { return all_; }
  const Section* find(std::string_view name) const {
    for (const Section& s : all_)
      if (s.name == name) return &s;
    return nullptr;
  }
  // Replaces the section of that name if there is one.
  void put(Section section) {
    for (Section& s : all_)
      if (s.name == section.name) {
        s = std::move(section);
        return;
      }
    all_.push_back(std::move(section));
  }
  template <class T>
  void put_records(std::string_view name, std::span<const T> records) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(records);
    put({std::string(name), sizeof(T), {bytes.begin(), bytes.end()}});
  }
  // Copies the records out; empty when there is no such section. Throws CacheError when they are of
  // another size. What the records say is for the caller to check.
  template <class T>
  std::vector<T> records(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const Section* s = find(name);
    if (s == nullptr) return {};
    if (s->element_bytes != sizeof(T))
      throw wrong_record_size("topology cache", name, s->element_bytes, sizeof(T));
    std::vector<T> out(s->bytes.size() / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), s->bytes.data(), s->bytes.size());
    return out;
  }

 private:
  std::vector<Section> all_;
};

}  // namespace morsel::topology
