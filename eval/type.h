// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/picture.h"

#include <string>

namespace adit {

/// Which point of a line of type its position means: the left end, the middle or the right end of its base line.
enum class Anchor { start, middle, end };

/// How a line of type looks.
struct Type {
  double size_px = 18;
  Colour colour;
  Anchor anchor = Anchor::start;
  bool bold = false;
  double halo_px = 0;  // white rim that keeps it readable over a picture
};

/// Width that the text takes, pixels. UTF-8.
double text_width(const std::string& text, double size_px, bool bold = false);
/// Sets a line of type with its base line at (x, y), in DejaVu Sans.
/// @throws Error where the font is not installed (package fonts-dejavu-core, or ADIT_FONTS = its folder).
void draw_text(Picture& picture, double x, double y, const std::string& text, const Type& type);

}  // namespace adit
