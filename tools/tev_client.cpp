// SPDX-License-Identifier: Apache-2.0
#include "tools/tev_client.h"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "tools/session.h"

namespace morsel::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "the protocol is little-endian");

constexpr int kTile = 128;
constexpr int kPatience = 5;  // seconds
constexpr const char* kChannels[] = {"R", "G", "B", "A"};
constexpr std::int32_t kChannelCount = 4;

enum class PacketType : char { kCreateImage = 4, kUpdateImageV3 = 6 };

// A packet as tev reads it; its first four bytes are its whole length.
class Packet {
 public:
  explicit Packet(PacketType type) : bytes_(4, '\0') { add(static_cast<char>(type)); }

  template <class T>
  Packet& add(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    const char* from = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
    return *this;
  }
  Packet& add(const std::string& text) {
    bytes_.insert(bytes_.end(), text.c_str(), text.c_str() + text.size() + 1);
    return *this;
  }
  const std::vector<char>& finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return bytes_;
  }

 private:
  std::vector<char> bytes_;
};

int connect_to(const TevAddress& address, std::string& why) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(address.port);
  if (const int error = ::getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found);
      error != 0) {
    why = ::gai_strerror(error);
    return -1;
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  for (const addrinfo* a = found; a != nullptr; a = a->ai_next) {
    const int fd = ::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC, a->ai_protocol);
    if (fd < 0) continue;
    const timeval patience{kPatience, 0};  // of connect() too
    ::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (::connect(fd, a->ai_addr, a->ai_addrlen) == 0) return fd;
    why = std::strerror(errno);
    ::close(fd);
  }
  return -1;
}

}  // namespace

TevAddress parse_tev_address(const std::string& flag, const std::string& text) {
  TevAddress address;
  if (text == "tev") return address;
  const auto refuse = [&] {
    throw UsageError(fmt::format(
        "{} {}: must be a file that ends in .png, tev, tev:HOST or tev:HOST:PORT", flag, text));
  };
  if (!text.starts_with("tev:")) refuse();
  address.host = text.substr(4);
  if (const std::size_t colon = address.host.rfind(':'); colon != std::string::npos) {
    const std::string port = address.host.substr(colon + 1);
    address.host.resize(colon);
    const char* const end = port.data() + port.size();
    const auto [rest, error] = std::from_chars(port.data(), end, address.port);
    if (error != std::errc() || rest != end || address.port == 0) refuse();
  }
  if (address.host.empty()) refuse();
  return address;
}

TevClient::TevClient(const TevAddress& address, std::string image, int width, int height)
    : address_(fmt::format("tev at {}:{}", address.host, address.port)), image_(std::move(image)) {
  std::string why;
  socket_ = connect_to(address, why);
  if (socket_ < 0) throw std::runtime_error(fmt::format("{}: {}", address_, why));
  Packet packet(PacketType::kCreateImage);
  packet.add(char{1}).add(image_);  // 1: show it
  packet.add(std::int32_t{width}).add(std::int32_t{height}).add(kChannelCount);
  for (const char* channel : kChannels) packet.add(std::string(channel));
  send(packet.finish());
}

TevClient::~TevClient() {
  if (socket_ >= 0) ::close(socket_);
}

void TevClient::send(const std::vector<char>& packet) {
  if (socket_ < 0) throw std::runtime_error(address_ + ": is gone");
  std::size_t done = 0;
  while (done < packet.size()) {
    const ssize_t n = ::send(socket_, packet.data() + done, packet.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const std::string why = std::strerror(errno);
      ::close(socket_);
      socket_ = -1;
      throw std::runtime_error(fmt::format("{}: {}", address_, why));
    }
    done += static_cast<std::size_t>(n);
  }
}

void TevClient::update(const render::Film& film) {
  const render::Crop& w = film.window();
  std::size_t tile = 0;
  for (int y0 = w.y0; y0 < w.y1; y0 += kTile)
    for (int x0 = w.x0; x0 < w.x1; x0 += kTile, ++tile) {
      const int x1 = std::min(x0 + kTile, w.x1), y1 = std::min(y0 + kTile, w.y1);
      std::uint64_t samples = 0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) samples += film.at(x, y).samples;
      if (tile >= sent_.size()) sent_.resize(tile + 1, 0);
      if (samples == sent_[tile]) continue;
      sent_[tile] = samples;

      Packet packet(PacketType::kUpdateImageV3);
      packet.add(char{0}).add(image_).add(kChannelCount);
      for (const char* channel : kChannels) packet.add(std::string(channel));
      for (const std::int32_t v : {x0, y0, x1 - x0, y1 - y0}) packet.add(v);
      for (std::int64_t c = 0; c < kChannelCount; ++c) packet.add(c);                   // offsets
      for (int c = 0; c < kChannelCount; ++c) packet.add(std::int64_t{kChannelCount});  // strides
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          const render::Pixel& p = film.at(x, y);
          packet.add(p.color.x).add(p.color.y).add(p.color.z).add(p.alpha);
        }
      send(packet.finish());
    }
}

}  // namespace morsel::tools
