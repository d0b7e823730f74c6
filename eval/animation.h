// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace adit {

constexpr int frame_ms = 400;  // of a sequence along the path

/// An animated PNG that runs for ever; readers that know none show its first picture.
/// @param pngs  its pictures as encode_png gives them, of one size, opaque, at least one
/// Source: W3C, Portable Network Graphics (third edition), 2025, sections 11.3.6 and 5.3.
std::string encode_animation(const std::vector<std::string>& pngs, int each_ms);

}  // namespace adit
