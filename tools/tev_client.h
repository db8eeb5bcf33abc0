// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/film/film.h"

namespace morsel::tools {

// Where a tev (https://github.com/Tom94/tev) listens.
struct TevAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = 14158;
};

// "tev", "tev:HOST" or "tev:HOST:PORT". Throws UsageError that names the flag.
TevAddress parse_tev_address(const std::string& flag, const std::string& text);

// Shows a picture in the viewer tev while it is rendered, by tev's protocol over TCP: packets that
// begin with their length, little-endian (CreateImage, UpdateImage version 3). All methods throw
// std::runtime_error that names the address when there is no viewer or it has gone; nothing waits
// for it longer than a few seconds.
class TevClient {
 public:
  // Connects and makes an image of this name and size.
  TevClient(const TevAddress& address, std::string image, int width, int height);
  ~TevClient();
  TevClient(const TevClient&) = delete;
  TevClient& operator=(const TevClient&) = delete;

  // Sends those tiles of the film that have samples that they had not before.
  void update(const render::Film& film);

 private:
  void send(const std::vector<char>& packet);

  std::string address_, image_;
  int socket_ = -1;
  std::vector<std::uint64_t> sent_;  // samples of each tile when it was sent last
};

}  // namespace morsel::tools
