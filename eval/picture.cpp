// SPDX-License-Identifier: BSD-3-Clause
#include "eval/picture.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {

Colour rgb(std::uint32_t hex) {
  return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8), static_cast<std::uint8_t>(hex),
          255};
}

namespace {
std::uint8_t mixed(std::uint8_t a, std::uint8_t b, double s) {
  return static_cast<std::uint8_t>(std::lround(a + (b - a) * s));
}
}  // namespace

Colour mix(Colour a, Colour b, double s) {
  s = std::clamp(s, 0.0, 1.0);
  return {mixed(a.r, b.r, s), mixed(a.g, b.g, s), mixed(a.b, b.b, s), mixed(a.a, b.a, s)};
}

std::string hex_of(Colour colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.r, colour.g, colour.b);
  return text;
}

Picture::Picture(int width_px, int height_px, Colour background)
    : width(width_px), height(height_px), pixel(static_cast<size_t>(width_px) * height_px, background) {}

void blend(Picture& picture, int x, int y, Colour colour, double coverage) {
  if (!picture.contains(x, y)) return;
  Colour& under = picture.at(x, y);
  if (coverage >= 1 && colour.a == 255) {
    under = colour;
    return;
  }
  const double over = std::clamp(coverage, 0.0, 1.0) * colour.a / 255;
  const double rest = under.a / 255.0 * (1 - over), alpha = over + rest;
  if (alpha <= 0) return;
  const double share = over / alpha;  // of the colour on top, in what is seen
  under = {mixed(under.r, colour.r, share), mixed(under.g, colour.g, share), mixed(under.b, colour.b, share),
           static_cast<std::uint8_t>(std::lround(255 * alpha))};
}

void fill_rect(Picture& picture, int x, int y, int width, int height, Colour colour) {
  for (int j = std::max(0, y); j < std::min(picture.height, y + height); ++j)
    for (int i = std::max(0, x); i < std::min(picture.width, x + width); ++i) blend(picture, i, j, colour);
}

void paste(Picture& picture, const Picture& top, int x, int y) {
  for (int j = 0; j < top.height; ++j)
    for (int i = 0; i < top.width; ++i) blend(picture, x + i, y + j, top.at(i, j));
}

Picture halve(const Picture& picture) {
  ADIT_CHECK(picture.width % 2 == 0 && picture.height % 2 == 0);
  Picture half(picture.width / 2, picture.height / 2, {});
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      int r = 2, g = 2, b = 2, a = 2;  // rounding
      for (const int k : {0, 1, 2, 3}) {
        const Colour& c = picture.at(2 * x + k % 2, 2 * y + k / 2);
        r += c.r, g += c.g, b += c.b, a += c.a;
      }
      half.at(x, y) = {static_cast<std::uint8_t>(r / 4), static_cast<std::uint8_t>(g / 4),
                       static_cast<std::uint8_t>(b / 4), static_cast<std::uint8_t>(a / 4)};
    }
  return half;
}

void write_png(const std::string& file, const Picture& picture) {
  write_text(file, encode_png(picture));
}

Picture read_png(const std::string& file) {
  return decode_png(read_text(file), file);
}

}  // namespace adit
