// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// Bytes as a page carries them: deflated (zlib's format), then base64. The same text for the same bytes.
std::string packed(const std::string& bytes);

/// Little-endian numbers, each as its difference from the one `stride` before it: neighbours in space are alike, so that
/// they pack small.
std::string delta_bytes(const std::vector<std::uint16_t>& values, size_t stride);
std::string delta_bytes(const std::vector<std::uint32_t>& values, size_t stride);

}  // namespace adit
