// SPDX-License-Identifier: BSD-3-Clause
// The sole owner of libpng.
#include "base/error.h"
#include "eval/picture.h"

#include <png.h>

#include <algorithm>
#include <cstring>

namespace adit {

namespace {

struct Reader {
  const std::string& bytes;
  size_t at = 0;
};

void write_some(png_structp png, png_bytep data, png_size_t n) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), n);
}

void read_some(png_structp png, png_bytep data, png_size_t n) {
  auto& reader = *static_cast<Reader*>(png_get_io_ptr(png));
  if (reader.at + n > reader.bytes.size()) png_error(png, "cut short");
  std::memcpy(data, reader.bytes.data() + reader.at, n);
  reader.at += n;
}

// libpng would jump; we throw instead, which its C frames let through (built with unwind tables on Debian).
[[noreturn]] void fail(png_structp png, png_const_charp what) {
  throw Error(*static_cast<const std::string*>(png_get_error_ptr(png)) + ": not a PNG that can be used: " + what);
}
void ignore(png_structp, png_const_charp) {}

}  // namespace

std::string encode_png(const Picture& picture) {
  ADIT_CHECK(!picture.empty());
  const bool opaque =
      std::all_of(picture.pixel.begin(), picture.pixel.end(), [](const Colour& c) { return c.a == 255; });
  const std::string name = "picture";
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, const_cast<std::string*>(&name), fail, ignore);
  png_infop info = png_create_info_struct(png);
  std::string bytes;
  png_set_write_fn(png, &bytes, write_some, nullptr);
  // A tenth larger than at libpng's own choice, in a fifth of the time.
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_set_IHDR(png, info, picture.width, picture.height, 8, opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  std::vector<std::uint8_t> row;
  for (int y = 0; y < picture.height; ++y) {
    row.clear();
    for (int x = 0; x < picture.width; ++x) {
      const Colour& c = picture.at(x, y);
      row.insert(row.end(), {c.r, c.g, c.b});
      if (!opaque) row.push_back(c.a);
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Picture decode_png(const std::string& bytes, const std::string& name) {
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
    throw Error(name + ": not a PNG picture");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, const_cast<std::string*>(&name), fail, ignore);
  png_infop info = png_create_info_struct(png);
  Reader reader{bytes};
  try {
    png_set_read_fn(png, &reader, read_some);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_strip_16(png);
    png_set_gray_to_rgb(png);
    png_set_filler(png, 255, PNG_FILLER_AFTER);
    png_read_update_info(png, info);
    Picture picture(static_cast<int>(png_get_image_width(png, info)), static_cast<int>(png_get_image_height(png, info)),
                    {});
    std::vector<png_bytep> rows(picture.height);
    for (int y = 0; y < picture.height; ++y) rows[y] = reinterpret_cast<png_bytep>(&picture.at(0, y));
    png_read_image(png, rows.data());
    png_destroy_read_struct(&png, &info, nullptr);
    return picture;
  } catch (...) {
    png_destroy_read_struct(&png, &info, nullptr);
    throw;
  }
}

}  // namespace adit
