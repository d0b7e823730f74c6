// SPDX-License-Identifier: BSD-3-Clause
#include "eval/chart_axes.h"

#include <cmath>

namespace adit {

void add_axes(Drawing& drawing, const Axes& axes, const std::string& x_words, const std::string& y_words) {
  const Type type{.size_px = 16, .colour = ink::faint, .anchor = Anchor::middle};
  const Vec2 a = axes.corner_px, b = a + axes.size_px;
  drawing.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::open});
  const double dx = round_down_125((axes.high.x() - axes.low.x()) / axes.x_steps),
               dy = round_down_125((axes.high.y() - axes.low.y()) / 3);
  for (double x = dx * std::ceil(axes.low.x() / dx); x <= axes.high.x() + 1e-9; x += dx) {
    const Vec2 p = axes(x, axes.low.y());
    drawing.add(Line{{p, p + Vec2(0, 6)}, ink::faint, 1.5});
    drawing.add(Words{p + Vec2(0, 24), plain_number(x, 4), type});
  }
  Type right = type;
  right.anchor = Anchor::end;
  for (double y = dy * std::ceil(axes.low.y() / dy - 1e-9); y <= axes.high.y() + 1e-9; y += dy) {
    const Vec2 p = axes(axes.low.x(), y);
    drawing.add(Line{{p, p + Vec2(axes.size_px.x(), 0)}, ink::rock, 1});
    drawing.add(Words{p + Vec2(-9, 6), plain_number(y, 3), right});
  }
  drawing.add(Words{{b.x(), b.y() + 46}, x_words, right});
  drawing.add(Words{a + Vec2(0, -12), y_words, {.size_px = 16, .colour = ink::faint}});
}

}  // namespace adit
