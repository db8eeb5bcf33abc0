// SPDX-License-Identifier: Apache-2.0
#include "topology/section_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>

namespace morsel::topology {
namespace {

static_assert(std::endian::native == std::endian::little, "cache files are little-endian");

constexpr std::uint64_t kAlignment = 64;
constexpr std::uint32_t kMaxSections = 1024;
constexpr std::uint32_t kRequired = 1;  // flag

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t section_count;
  std::uint64_t file_bytes;
  std::uint64_t directory_offset;  // the directory is the end of the file
  std::uint64_t reserved[3];       // 0
  std::uint64_t checksum;          // XXH3 of the 56 bytes above, followed by the directory
};
static_assert(sizeof(Header) == kAlignment);

struct DirectoryRecord {
  char name[32];  // padded with zeros, at least one
  std::uint64_t offset, bytes;
  std::uint32_t element_bytes, flags;
  std::uint64_t checksum;
};
static_assert(sizeof(DirectoryRecord) == kAlignment);

std::uint64_t aligned(std::uint64_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum_of(const Header& header, std::span<const DirectoryRecord> directory) {
  const std::span<const std::byte> tail = std::as_bytes(directory);
  std::vector<std::byte> bytes(offsetof(Header, checksum) + tail.size());
  std::memcpy(bytes.data(), &header, offsetof(Header, checksum));
  if (!tail.empty())
    std::memcpy(bytes.data() + offsetof(Header, checksum), tail.data(), tail.size());
  return checksum_of(bytes);
}

// Comments are allowed in scenes; a byte order mark may come first.
bool begins_as_json(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text.starts_with('{') || text.starts_with("//") || text.starts_with("/*");
}

// What a file is instead of what it should be, by its first bytes; empty: unknown.
std::string_view other_kind(std::string_view begin) {
  constexpr struct {
    std::string_view magic, kind;
  } kKinds[] = {{"MORSTOPO", "a topology cache"},
                {"MORSBRIK", "a brick file"},
                {"MORSRNDR", "a render's checkpoint"}};
  for (const auto& [magic, kind] : kKinds)
    if (begin.starts_with(magic)) return kind;
  return begins_as_json(begin) ? "a JSON file or a scene" : "";
}

bool is_name(std::string_view name) {
  return !name.empty() && name.size() < sizeof(DirectoryRecord::name) &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
                  c == '.';
         });
}

template <class Work>
auto as_cache_error(Work&& work) {
  try {
    return work();
  } catch (const std::runtime_error& e) {
    throw CacheError(e.what());
  }
}

ReplacingFile replacing(const std::filesystem::path& target) {
  return as_cache_error([&] { return ReplacingFile(target); });
}

}  // namespace

CacheError wrong_record_size(std::string_view file, std::string_view section, std::size_t found,
                             std::size_t expected) {
  return CacheError(fmt::format("{}: section \"{}\": records of {} bytes instead of {}", file,
                                section, found, expected));
}

SectionWriter::SectionWriter(const std::filesystem::path& target, const SectionFormat& format)
    : file_(replacing(target)), target_(target.string()), format_(format) {
  fd_ = ::open(file_.temporary_path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd_ < 0) fail("cannot create");
  const Header blank{};
  write(std::as_bytes(std::span(&blank, 1)));
}

SectionWriter::~SectionWriter() {
  if (fd_ >= 0) ::close(fd_);
}

void SectionWriter::fail(const char* what) const {
  throw CacheError(fmt::format("{}: {}: {}", target_, what, std::strerror(errno)));
}

void SectionWriter::write(std::span<const std::byte> bytes) {
  offset_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), std::min<std::size_t>(bytes.size(), 1u << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot write");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void SectionWriter::pad() {
  constexpr std::array<std::byte, kAlignment> kZeros{};
  write(std::span(kZeros).first(aligned(offset_) - offset_));
}

void SectionWriter::add(std::string_view name, std::span<const std::byte> bytes,
                        std::uint32_t element_bytes, bool required) {
  if (!is_name(name) || element_bytes == 0 || bytes.size() % element_bytes != 0)
    throw CacheError(fmt::format("{}: section \"{}\" is malformed", target_, name));
  for (const SectionEntry& e : entries_)
    if (e.name == name)
      throw CacheError(fmt::format("{}: section \"{}\" given twice", target_, name));
  if (entries_.size() == kMaxSections)
    throw CacheError(fmt::format("{}: more than {} sections", target_, kMaxSections));
  entries_.push_back(
      {std::string(name), offset_, bytes.size(), element_bytes, required, checksum_of(bytes)});
  write(bytes);
  pad();
}

std::uint64_t SectionWriter::publish() {
  Header header{};
  std::memcpy(header.magic, format_.magic, sizeof header.magic);
  header.version = format_.version;
  header.section_count = static_cast<std::uint32_t>(entries_.size());
  header.directory_offset = offset_;
  std::vector<DirectoryRecord> directory;
  for (const SectionEntry& e : entries_) {
    DirectoryRecord record{};
    std::copy(e.name.begin(), e.name.end(), record.name);
    record.offset = e.offset;
    record.bytes = e.bytes;
    record.element_bytes = e.element_bytes;
    record.flags = e.required ? kRequired : 0;
    record.checksum = e.checksum;
    directory.push_back(record);
  }
  write(std::as_bytes(std::span(directory)));
  header.file_bytes = offset_;
  header.checksum = checksum_of(header, directory);
  if (::pwrite(fd_, &header, sizeof header, 0) != static_cast<ssize_t>(sizeof header))
    fail("cannot write");
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) != 0) fail("cannot write");
  as_cache_error([&] { file_.commit(); });
  return header.file_bytes;
}

SectionFile::SectionFile(const std::filesystem::path& path, const SectionFormat& format)
    : name_(path.string()) {
  // A pipe would make this call wait for its other end.
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) throw CacheError(fmt::format("{}: cannot open: {}", name_, std::strerror(errno)));
  try {
    read_directory(format);
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

SectionFile::~SectionFile() { ::close(fd_); }

void SectionFile::read_at(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t n = ::pread(fd_, out.data(), std::min<std::size_t>(out.size(), 1u << 30),
                              static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw CacheError(fmt::format("{}: cannot read: {}", name_,
                                   n == 0 ? "it has become shorter" : std::strerror(errno)));
    out = out.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

void SectionFile::read_directory(const SectionFormat& format) {
  const std::string kind = format.description;
  struct stat status = {};
  if (::fstat(fd_, &status) != 0)
    throw CacheError(fmt::format("{}: cannot read: {}", name_, std::strerror(errno)));
  if (S_ISDIR(status.st_mode)) throw CacheError(name_ + ": is a directory, not a " + kind);
  if (!S_ISREG(status.st_mode)) throw CacheError(name_ + ": is not a regular file");
  size_ = static_cast<std::uint64_t>(status.st_size);
  Header header;
  const std::uint64_t present = std::min<std::uint64_t>(size_, sizeof header);
  read_at(0, std::as_writable_bytes(std::span(&header, 1)).first(present));
  const std::string_view begin(reinterpret_cast<const char*>(&header), present);
  const std::string_view magic(format.magic, sizeof header.magic);
  if (!magic.starts_with(begin.substr(0, magic.size()))) {
    const std::string_view other = other_kind(begin);
    throw CacheError(fmt::format("{}: not a {}: wrong first bytes{}{}", name_, kind,
                                 other.empty() ? "" : ", those of ", other));
  }
  if (present < sizeof header)
    throw CacheError(
        fmt::format("{}: not a {}: {} bytes are fewer than its header has", name_, kind, size_));
  if (header.version != format.version)
    throw CacheError(
        fmt::format("{}: version {} of the format of a {}; this program reads version {}", name_,
                    header.version, kind, format.version));
  if (header.file_bytes != size_)
    throw CacheError(fmt::format("{}: truncated or overlong: {} bytes instead of {}", name_, size_,
                                 header.file_bytes));
  if (header.section_count > kMaxSections || header.directory_offset < sizeof header ||
      header.directory_offset % kAlignment != 0 || header.directory_offset > size_ ||
      size_ - header.directory_offset != header.section_count * sizeof(DirectoryRecord))
    throw CacheError(fmt::format("{}: header: {} sections, listed at byte {} of {}", name_,
                                 header.section_count, header.directory_offset, size_));
  std::vector<DirectoryRecord> directory(header.section_count);
  read_at(header.directory_offset, std::as_writable_bytes(std::span(directory)));
  if (checksum_of(header, directory) != header.checksum)
    throw CacheError(name_ + ": damaged: the checksum of its header does not match");

  // Sections follow one another without holes; what pads them is zero.
  std::uint64_t expected = sizeof header;
  for (std::size_t i = 0; i < directory.size(); ++i) {
    const DirectoryRecord& r = directory[i];
    const auto bad = [&](const std::string& what) {
      throw CacheError(fmt::format("{}: section {} of the directory: {}", name_, i, what));
    };
    if (r.name[sizeof r.name - 1] != 0) bad("its name has no end");
    SectionEntry entry{r.name,    r.offset, r.bytes, r.element_bytes, (r.flags & kRequired) != 0,
                       r.checksum};
    if (!is_name(entry.name)) bad("bad name");
    for (std::size_t k = entry.name.size(); k < sizeof r.name; ++k)
      if (r.name[k] != 0) bad("bad name");
    if (find(entry.name) != nullptr) bad(fmt::format("a second \"{}\"", entry.name));
    if ((r.flags & ~kRequired) != 0) bad("unknown flags");
    if (r.element_bytes == 0 || r.bytes % r.element_bytes != 0)
      bad(fmt::format("\"{}\": {} bytes of records of {}", entry.name, r.bytes, r.element_bytes));
    if (r.offset != expected || r.bytes > header.directory_offset - r.offset)
      bad(fmt::format("\"{}\" lies at byte {} with {} bytes", entry.name, r.offset, r.bytes));
    expected = aligned(r.offset + r.bytes);
    std::array<std::byte, kAlignment> padding{};
    const std::span<std::byte> rest = std::span(padding).first(expected - r.offset - r.bytes);
    read_at(r.offset + r.bytes, rest);
    if (std::any_of(rest.begin(), rest.end(), [](std::byte b) { return b != std::byte{0}; }))
      bad(fmt::format("\"{}\" is followed by bytes that are not zero", entry.name));
    entries_.push_back(std::move(entry));
  }
  if (expected != header.directory_offset)
    throw CacheError(name_ + ": header: bytes that belong to no section");
}

const SectionEntry* SectionFile::find(std::string_view name) const {
  for (const SectionEntry& e : entries_)
    if (e.name == name) return &e;
  return nullptr;
}

const SectionEntry& SectionFile::get(std::string_view name) const {
  const SectionEntry* entry = find(name);
  if (entry == nullptr) throw CacheError(fmt::format("{}: has no section \"{}\"", name_, name));
  return *entry;
}

void SectionFile::require_known(std::span<const std::string_view> known) const {
  for (const SectionEntry& e : entries_)
    if (e.required && std::find(known.begin(), known.end(), e.name) == known.end())
      throw CacheError(
          fmt::format("{}: section \"{}\" is needed to understand the file, and this program does "
                      "not know it",
                      name_, e.name));
}

void SectionFile::read_into(const SectionEntry& entry, std::span<std::byte> out) const {
  read_at(entry.offset, out);
  if (checksum_of(out) != entry.checksum)
    throw CacheError(fmt::format("{}: section \"{}\" is damaged: its checksum does not match",
                                 name_, entry.name));
}

std::vector<std::byte> SectionFile::read(std::string_view name) const {
  const SectionEntry& entry = get(name);
  std::vector<std::byte> bytes(entry.bytes);
  read_into(entry, bytes);
  return bytes;
}

}  // namespace morsel::topology
