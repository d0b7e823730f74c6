// SPDX-License-Identifier: BSD-3-Clause
#include "eval/animation.h"

#include "base/error.h"

#include <array>
#include <cstdint>

namespace adit {

namespace {

std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int k = bytes - 1; k >= 0; --k) text += static_cast<char>(value >> (8 * k));
  return text;
}

std::uint32_t number_at(const std::string& bytes, size_t at) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return value;
}

std::string chunk(const std::string& kind, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + kind + data + big_endian(crc_of(kind + data));
}

struct Chunk {
  std::string kind, data;
};
std::vector<Chunk> chunks_of(const std::string& png) {
  std::vector<Chunk> chunks;
  for (size_t at = 8; at + 12 <= png.size();) {
    const std::uint32_t length = number_at(png, at);
    chunks.push_back({png.substr(at + 4, 4), png.substr(at + 8, length)});
    at += 12 + length;
  }
  return chunks;
}

}  // namespace

std::string encode_animation(const std::vector<std::string>& pngs, int each_ms) {
  ADIT_CHECK(!pngs.empty());
  constexpr size_t size_at = 16, head_end = 33;  // of width and height in the first chunk, which ends there
  std::string file;
  std::uint32_t sequence = 0;
  for (const std::string& png : pngs) {
    ADIT_CHECK(png.compare(0, head_end - 4, pngs[0], 0, head_end - 4) == 0);  // the same size and kind
    const bool first = file.empty();
    if (first) file = png.substr(0, 8);
    bool controlled = false;
    for (const Chunk& c : chunks_of(png)) {
      if (c.kind == "IDAT" && !controlled) {
        controlled = true;
        if (first) file += chunk("acTL", big_endian(static_cast<std::uint32_t>(pngs.size())) + big_endian(0));
        file += chunk("fcTL", big_endian(sequence++) + png.substr(size_at, 8) + big_endian(0) + big_endian(0) +
                                  big_endian(static_cast<std::uint32_t>(each_ms), 2) + big_endian(1000, 2) +
                                  std::string(2, '\0'));
      }
      if (c.kind == "IDAT")
        file += first ? chunk("IDAT", c.data) : chunk("fdAT", big_endian(sequence++) + c.data);
      else if (first && c.kind != "IEND")
        file += chunk(c.kind, c.data);
    }
  }
  return file + chunk("IEND", "");
}

}  // namespace adit
