// SPDX-License-Identifier: BSD-3-Clause
#include "eval/histograms.h"
#include "eval/plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

// Height of the bars of the colour of what was measured, all together.
double bars_px(const Drawing& drawing) {
  double sum = 0;
  for (const auto& item : drawing.items)
    if (const auto* area = std::get_if<Area>(&item); area && area->colour == ink::map)
      sum += area->rings[0][2].y() - area->rings[0][0].y();
  return sum;
}
int stated_lines(const Drawing& drawing, size_t points) {
  int n = 0;
  for (const auto& item : drawing.items)
    if (const auto* line = std::get_if<Line>(&item))
      n += line->colour == ink::raw && line->dash_px == 0 && line->width_px == 2.5 && line->p.size() == points;
  return n;
}

TEST(Histograms, BarsAreAsHighAsTheirShares) {
  // Both sheets have the same scale: half of the values in one bin are the greatest share.
  const Drawing two = histogram_sheet({{"x", {1, 1, 2, 2}, {}}}, "two"),
                three = histogram_sheet({{"x", {1, 1, 1.4, 2}, {}}}, "three");
  EXPECT_NEAR(bars_px(two), bars_px(three), 1e-9);
  EXPECT_GT(bars_px(two), 100);
}

TEST(Histograms, WhatIsStatedIsALineOrAnOutline) {
  EXPECT_EQ(stated_lines(histogram_sheet({{"x", {1, 2}, {1.5, 1.5}}}, "line"), 2), 1);
  EXPECT_EQ(stated_lines(histogram_sheet({{"x", {1, 2}, {1.5, 1.75}}}, "outline"), 42), 1);  // 20 bins, 2 ends
  const Drawing none = histogram_sheet({{"x", {1, 2}, {}}}, "none");
  EXPECT_EQ(stated_lines(none, 2) + stated_lines(none, 42), 0);
}

TEST(Histograms, WhatHasNoValuesHasNoPanel) {
  const Drawing one = histogram_sheet({{"x", {1}, {}}, {"y", {}, {3}}}, "one");
  EXPECT_EQ(one.height_px, histogram_sheet({{"x", {1}, {}}}, "one").height_px);
  EXPECT_LT(one.height_px,
            histogram_sheet({{"x", {1}, {}}, {"y", {1}, {}}, {"z", {1}, {}}, {"u", {1}, {}}}, "").height_px);
}

}  // namespace
}  // namespace adit
