// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/plan.h"

namespace adit {

/// Axes of a chart: x and y values laid on a rectangle, y up.
struct Axes {
  Vec2 low, high;           // values of the corners
  Vec2 corner_px, size_px;  // upper left
  double x_steps = 5;       // along x, between this and two and a half times as many

  Vec2 operator()(double x, double y) const {
    return corner_px + Vec2((x - low.x()) / (high.x() - low.x()) * size_px.x(),
                            (high.y() - y) / (high.y() - low.y()) * size_px.y());
  }
};

/// Its ground, ticks with numbers, grid lines and words.
void add_axes(Drawing& drawing, const Axes& axes, const std::string& x_words, const std::string& y_words);

}  // namespace adit
