// SPDX-License-Identifier: BSD-3-Clause
#include "eval/packed.h"

#include "base/error.h"
#include "eval/drawing.h"

#include <zlib.h>

namespace adit {

namespace {

template <class Number>
std::string differences(const std::vector<Number>& values, size_t stride) {
  std::string bytes(values.size() * sizeof(Number), '\0');
  // Byte k of all numbers stands together: high bytes are nearly all alike.
  for (size_t i = 0; i < values.size(); ++i) {
    const auto d = static_cast<Number>(values[i] - (i >= stride ? values[i - stride] : 0));
    // The sign goes to the lowest bit, so that small steps either way have empty high bytes.
    const bool down = d >> (8 * sizeof(Number) - 1);
    const auto code = static_cast<Number>(down ? ~static_cast<Number>(d << 1) : d << 1);
    for (size_t b = 0; b < sizeof(Number); ++b) bytes[b * values.size() + i] = static_cast<char>(code >> (8 * b));
  }
  return bytes;
}

}  // namespace

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string small(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(small.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6);
  ADIT_CHECK(code == Z_OK);
  small.resize(size);
  return base64(small);
}

std::string delta_bytes(const std::vector<std::uint16_t>& values, size_t stride) {
  return differences(values, stride);
}
std::string delta_bytes(const std::vector<std::uint32_t>& values, size_t stride) {
  return differences(values, stride);
}

}  // namespace adit
