// SPDX-License-Identifier: BSD-3-Clause
// Pictures against those that were looked at: by what an eye would tell apart, not by bytes. ADIT_GOLDEN=write makes them
// anew.
#include "eval/render.h"
#include "tests/eval/synthetic_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

const std::string folder = ADIT_SOURCE_DIR "/tests/eval/golden/";

Vec3 lab_of(const Colour& c) {
  const auto linear = [](std::uint8_t v) {
    const double s = v / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double r = linear(c.r), g = linear(c.g), b = linear(c.b);
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047), y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
               z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// Share of pixels whose colours differ by more than CIE 1976 delta E 6, which an eye sees side by side. Pictures are
// halved first: an eye that sees a whole page does not tell an edge's last half pixel.
double told_apart(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height) return 1;
  size_t n = 0;
  for (size_t k = 0; k < a.pixel.size(); ++k) n += (lab_of(a.pixel[k]) - lab_of(b.pixel[k])).norm() > 6;
  return static_cast<double>(n) / static_cast<double>(a.pixel.size());
}

Picture small_view(const std::string& view, double range_m = 0) {
  static const SyntheticRun run = synthetic_run(0.4, 1.0);
  ReportSettings settings;
  settings.width_px = 648;  // so that every picture can be halved
  settings.range_m = range_m;
  return halve(render_view(view, run.input(), settings));
}

TEST(Golden, PicturesLookAsTheyDidWhenTheyWereLookedAt) {
  for (const std::string view : {"plan", "cutaway", "interior-1", "coverage", "errors"}) {
    const std::string file = folder + view + ".png";
    const Picture now = small_view(view);
    if (std::getenv("ADIT_GOLDEN")) write_png(file, now);
    // One pixel in a hundred: another rasteriser moves edges and type, not areas.
    EXPECT_LT(told_apart(now, read_png(file)), 0.01) << file;
  }
}

TEST(Golden, AnotherRangeOfColoursOrAShiftIsTold) {
  const Picture plan = read_png(folder + "plan.png");
  EXPECT_GT(told_apart(small_view("plan", 0.1), plan), 0.02);
  Picture shifted = plan;
  for (int y = 0; y < plan.height; ++y)
    for (int x = 3; x < plan.width; ++x) shifted.at(x, y) = plan.at(x - 3, y);
  EXPECT_GT(told_apart(shifted, plan), 0.02);
}

}  // namespace
}  // namespace adit
