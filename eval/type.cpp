// SPDX-License-Identifier: BSD-3-Clause
// The sole owner of stb_truetype.
#include "eval/type.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#include <stb/stb_truetype.h>
#pragma GCC diagnostic pop

namespace adit {

namespace {

struct Font {
  std::string bytes;
  stbtt_fontinfo info;
};

std::unique_ptr<Font> load_font(const std::string& file_name) {
  const char* folder = std::getenv("ADIT_FONTS");
  const std::string file = (folder ? std::string(folder) : "/usr/share/fonts/truetype/dejavu") + "/" + file_name;
  auto font = std::make_unique<Font>();
  try {
    font->bytes = read_text(file);
  } catch (const Error&) {
    throw Error(
        file + ": the font of the pictures is missing; install fonts-dejavu-core or set ADIT_FONTS to its folder",
        Fault::file);
  }
  const auto* data = reinterpret_cast<const unsigned char*>(font->bytes.data());
  const int offset = stbtt_GetFontOffsetForIndex(data, 0);
  if (offset < 0 || !stbtt_InitFont(&font->info, data, offset))
    throw Error(file + ": not a TrueType font", Fault::file);
  return font;
}

const Font& font_of(bool bold) {
  static const std::unique_ptr<Font> regular = load_font("DejaVuSans.ttf"), heavy = load_font("DejaVuSans-Bold.ttf");
  return bold ? *heavy : *regular;
}

// Code points of a UTF-8 text; a broken byte becomes U+FFFD.
std::vector<int> code_points(const std::string& text) {
  std::vector<int> points;
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
    if (length == 0 || i + length > text.size()) {
      points.push_back(0xFFFD);
      ++i;
      continue;
    }
    int point = length == 1 ? lead : lead & (0x7F >> length);
    for (int k = 1; k < length; ++k) point = point << 6 | (text[i + k] & 0x3F);
    points.push_back(point);
    i += length;
  }
  return points;
}

double advance_of(const Font& font, int point, int next, double scale) {
  int advance = 0, bearing = 0;
  stbtt_GetCodepointHMetrics(&font.info, point, &advance, &bearing);
  const int kern = next ? stbtt_GetCodepointKernAdvance(&font.info, point, next) : 0;
  return scale * (advance + kern);
}

// A glyph's coverage, laid on with its rim first widened by `spread` pixels.
void lay_glyph(Picture& picture, const Font& font, int point, double x, double y, double scale, Colour colour,
               int spread) {
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  int x0, y0, x1, y1;
  const auto s = static_cast<float>(scale), sx = static_cast<float>(fx), sy = static_cast<float>(fy);
  stbtt_GetCodepointBitmapBoxSubpixel(&font.info, point, s, s, sx, sy, &x0, &y0, &x1, &y1);
  const int w = x1 - x0, h = y1 - y0;
  if (w <= 0 || h <= 0) return;
  std::vector<unsigned char> mask(static_cast<size_t>(w) * h);
  stbtt_MakeCodepointBitmapSubpixel(&font.info, mask.data(), w, h, w, s, s, sx, sy, point);
  const int left = static_cast<int>(std::floor(x)) + x0, top = static_cast<int>(std::floor(y)) + y0;
  for (int j = -spread; j < h + spread; ++j)
    for (int i = -spread; i < w + spread; ++i) {
      int most = 0;
      for (int b = std::max(0, j - spread); b <= std::min(h - 1, j + spread); ++b)
        for (int a = std::max(0, i - spread); a <= std::min(w - 1, i + spread); ++a)
          if ((a - i) * (a - i) + (b - j) * (b - j) <= spread * spread)
            most = std::max<int>(most, mask[static_cast<size_t>(b) * w + a]);
      if (most > 0) blend(picture, left + i, top + j, colour, most / 255.0);
    }
}

}  // namespace

double text_width(const std::string& text, double size_px, bool bold) {
  const Font& font = font_of(bold);
  const double scale = stbtt_ScaleForMappingEmToPixels(&font.info, static_cast<float>(size_px));
  const auto points = code_points(text);
  double width = 0;
  for (size_t k = 0; k < points.size(); ++k)
    width += advance_of(font, points[k], k + 1 < points.size() ? points[k + 1] : 0, scale);
  return width;
}

void draw_text(Picture& picture, double x, double y, const std::string& text, const Type& type) {
  const Font& font = font_of(type.bold);
  const double scale = stbtt_ScaleForMappingEmToPixels(&font.info, static_cast<float>(type.size_px));
  const double width = text_width(text, type.size_px, type.bold);
  if (type.anchor == Anchor::middle) x -= width / 2;
  if (type.anchor == Anchor::end) x -= width;
  const auto points = code_points(text);
  for (const bool halo : {true, false}) {
    if (halo && type.halo_px <= 0) continue;
    double pen = x;
    for (size_t k = 0; k < points.size(); ++k) {
      lay_glyph(picture, font, points[k], pen, y, scale, halo ? Colour{255, 255, 255, 230} : type.colour,
                halo ? static_cast<int>(std::lround(type.halo_px)) : 0);
      pen += advance_of(font, points[k], k + 1 < points.size() ? points[k + 1] : 0, scale);
    }
  }
}

}  // namespace adit
