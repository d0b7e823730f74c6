// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "eval/picture.h"
#include "eval/type.h"

#include <string>
#include <variant>
#include <vector>

namespace adit {

/// A flat drawing that can be set as SVG (sharp at every size) or as a picture. Lengths are pixels of its own size, x
/// right, y down.
struct Area {
  std::vector<std::vector<Vec2>> rings;  // inside = crossed an odd number of times
  Colour colour;
};
struct Line {
  std::vector<Vec2> p;
  Colour colour;
  double width_px = 1.5;
  double dash_px = 0;  // length of dashes and gaps; 0 = solid
};
struct Disc {
  Vec2 centre;
  double radius_px = 4;
  Colour fill = {}, rim = {};
  double rim_px = 0;
  std::string link = {}, title = {};  // in SVG: where a click leads, what a pointer reads
};
struct Words {
  Vec2 at;  // left, middle or right of the base line
  std::string text;
  Type type;
};
struct Layer {
  Picture picture;
  Vec2 low, high;  // upper left and lower right corner
};

struct Drawing {
  double width_px = 1200, height_px = 800;
  Colour background = rgb(0xf3f3f0);
  std::vector<std::variant<Area, Line, Disc, Words, Layer>> items;

  template <class Item>
  void add(Item item) {
    items.emplace_back(std::move(item));
  }
};

/// An <svg> element with `alt` as its title; layers are embedded. Every text is escaped.
std::string to_svg(const Drawing& drawing, const std::string& alt);
/// The drawing `scale` times as large, anti-aliased.
Picture to_picture(const Drawing& drawing, double scale = 1);

/// Many discs as one layer over a rectangle, which keeps an SVG small.
Layer flattened(const std::vector<Disc>& discs, const Vec2& low, const Vec2& high, double scale = 1.5);

/// Text that may stand between tags or in a quoted attribute.
std::string escaped(const std::string& text);
std::string base64(const std::string& bytes);

}  // namespace adit
