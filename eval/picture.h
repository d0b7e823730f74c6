// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// sRGB, alpha 255 = opaque.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Colour&) const = default;
};
/// From 0xRRGGBB.
Colour rgb(std::uint32_t hex);
/// From a (s = 0) to b (s = 1), each channel of its own.
Colour mix(Colour a, Colour b, double s);
/// "#rrggbb", alpha left out.
std::string hex_of(Colour colour);

/// An image, row 0 on top.
struct Picture {
  int width = 0, height = 0;
  std::vector<Colour> pixel;  // (height x width)

  Picture() = default;
  Picture(int width_px, int height_px, Colour background);
  Colour& at(int x, int y) { return pixel[static_cast<size_t>(y) * width + x]; }
  const Colour& at(int x, int y) const { return pixel[static_cast<size_t>(y) * width + x]; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  bool empty() const { return pixel.empty(); }
};

/// Lays a colour over a pixel with coverage 0..1 (times the colour's alpha). Pixels outside are left alone.
void blend(Picture& picture, int x, int y, Colour colour, double coverage = 1);
void fill_rect(Picture& picture, int x, int y, int width, int height, Colour colour);
/// Lays `top` over the picture with its upper left corner at (x, y).
void paste(Picture& picture, const Picture& top, int x, int y);
/// Half the size, each pixel the mean of 2 x 2; width and height must be even.
Picture halve(const Picture& picture);

/// PNG bytes, RGB where every pixel is opaque, else RGBA; the same bytes for the same picture.
std::string encode_png(const Picture& picture);
/// @throws Error naming `name` where the bytes are no PNG.
Picture decode_png(const std::string& bytes, const std::string& name);
void write_png(const std::string& file, const Picture& picture);
Picture read_png(const std::string& file);

}  // namespace adit
