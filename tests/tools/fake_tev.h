// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace morsel::test {

// As much of tev as its protocol shows: takes one connection on a port of its own, reads packets
// strictly by the rules and keeps the picture.
class FakeTev {
 public:
  FakeTev() {
    listening_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    if (listening_ < 0 || ::bind(listening_, generic, size) != 0 || ::listen(listening_, 1) != 0 ||
        ::getsockname(listening_, generic, &size) != 0)
      throw std::runtime_error("cannot listen");
    port = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeTev() { wait(); }

  // For the client to go away. Without a connection the listening socket's shutdown ends accept().
  void wait() {
    if (listening_ >= 0) ::shutdown(listening_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    if (listening_ >= 0) ::close(listening_);
    listening_ = -1;
  }

  std::uint16_t port = 0;
  std::string error;  // what broke the rules
  std::string image;
  int width = 0, height = 0, creations = 0, updates = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;  // of all channels, interleaved; NaN-free, -1 where nothing came

 private:
  struct Packet {
    std::vector<char> bytes;
    std::size_t at = 0;
    template <class T>
    T take() {
      T value;
      if (at + sizeof value > bytes.size()) throw std::runtime_error("a packet is too short");
      std::memcpy(&value, bytes.data() + at, sizeof value);
      at += sizeof value;
      return value;
    }
    std::string text() {
      const std::size_t begin = at;
      while (take<char>() != 0) {
      }
      return {bytes.data() + begin, at - begin - 1};
    }
  };

  static bool read(int fd, char* to, std::size_t size) {
    while (size > 0) {
      const ssize_t n = ::recv(fd, to, size, 0);
      if (n <= 0) return false;
      to += n;
      size -= static_cast<std::size_t>(n);
    }
    return true;
  }

  void serve() {
    const int fd = ::accept(listening_, nullptr, nullptr);
    if (fd < 0) return;
    std::uint32_t length = 0;
    try {
      while (read(fd, reinterpret_cast<char*>(&length), 4)) {
        if (length < 5 || length > (1u << 28)) throw std::runtime_error("a packet of odd length");
        Packet packet{std::vector<char>(length - 4)};
        if (!read(fd, packet.bytes.data(), packet.bytes.size()))
          throw std::runtime_error("a packet without its end");
        handle(packet);
        if (packet.at != packet.bytes.size()) throw std::runtime_error("a packet is too long");
      }
    } catch (const std::exception& e) {
      error = e.what();
    }
    ::close(fd);
  }

  void handle(Packet& packet) {
    const char type = packet.take<char>();
    packet.take<char>();  // grab focus
    const std::string name = packet.text();
    if (type == 4) {
      ++creations;
      image = name;
      width = packet.take<std::int32_t>();
      height = packet.take<std::int32_t>();
      channels.resize(static_cast<std::size_t>(packet.take<std::int32_t>()));
      for (std::string& channel : channels) channel = packet.text();
      pixels.assign(
          static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels.size(),
          -1.0f);
    } else if (type == 6) {
      ++updates;
      if (name != image) throw std::runtime_error("an update of another image");
      update(packet);
    } else {
      throw std::runtime_error("a packet of unknown type");
    }
  }

  void update(Packet& packet) {
    const auto count = static_cast<std::size_t>(packet.take<std::int32_t>());
    std::vector<std::size_t> targets, offsets, strides;
    for (std::size_t c = 0; c < count; ++c) {
      const std::string channel = packet.text();
      std::size_t k = 0;
      while (k < channels.size() && channels[k] != channel) ++k;
      if (k == channels.size()) throw std::runtime_error("an unknown channel");
      targets.push_back(k);
    }
    const int x0 = packet.take<std::int32_t>(), y0 = packet.take<std::int32_t>();
    const int w = packet.take<std::int32_t>(), h = packet.take<std::int32_t>();
    if (x0 < 0 || y0 < 0 || w < 1 || h < 1 || x0 + w > width || y0 + h > height)
      throw std::runtime_error("a tile outside of the image");
    for (std::size_t c = 0; c < count; ++c)
      offsets.push_back(static_cast<std::size_t>(packet.take<std::int64_t>()));
    for (std::size_t c = 0; c < count; ++c)
      strides.push_back(static_cast<std::size_t>(packet.take<std::int64_t>()));
    std::vector<float> data((packet.bytes.size() - packet.at) / sizeof(float));
    for (float& value : data) value = packet.take<float>();
    for (std::size_t c = 0; c < count; ++c)
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const auto from = offsets[c] + strides[c] * static_cast<std::size_t>(y * w + x);
          const auto to = static_cast<std::size_t>((y0 + y) * width + x0 + x);
          pixels[to * channels.size() + targets[c]] = data.at(from);
        }
  }

  int listening_ = -1;
  std::thread thread_;
};

}  // namespace morsel::test
