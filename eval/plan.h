// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "eval/drawing.h"
#include "eval/ramp.h"

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// Colours that all drawings share. Categories are those of Okabe and Ito, told apart by colour-blind people.
namespace ink {
inline const Colour paper = rgb(0xf3f3f0), rock = rgb(0xd3d0ca), open = rgb(0xfbfbfa), edge = rgb(0x6d6a65),
                    text = rgb(0x22242a), faint = rgb(0x6c6f75), truth = rgb(0x22242a), map = rgb(0x0072b2),
                    raw = rgb(0xd55e00), good = rgb(0x009e73), mark = rgb(0x111111), white = rgb(0xffffff);
}  // namespace ink

/// Lays a rectangle of the world's plan on a drawing, north up.
struct PlanFrame {
  Vec2 low_W, high_W;  // metres
  Vec2 origin_px;      // where (low.x, high.y) lies
  double px_per_m = 1;

  Vec2 operator()(const Vec2& p_W) const {
    return origin_px + px_per_m * Vec2(p_W.x() - low_W.x(), high_W.y() - p_W.y());
  }
  Vec2 metres(const Vec2& px) const {
    return {low_W.x() + (px.x() - origin_px.x()) / px_per_m, high_W.y() - (px.y() - origin_px.y()) / px_per_m};
  }
  double width_px() const { return px_per_m * (high_W.x() - low_W.x()); }
  double height_px() const { return px_per_m * (high_W.y() - low_W.y()); }
};

/// A drawing width_px wide, as high as the rectangle asks for plus room for axes, and the frame in it.
/// @param room_px  around the plan: left, top, right, bottom
std::pair<Drawing, PlanFrame> plan_sheet(const Vec2& low_W, const Vec2& high_W, double width_px,
                                         const std::array<double, 4>& room_px);

/// Rock, and the open ground inside of the outline.
void add_ground(Drawing& drawing, const PlanFrame& frame, const std::vector<std::vector<Vec2>>& outline);
/// The outline's lines inside of the frame.
void add_rim(Drawing& drawing, const PlanFrame& frame, const std::vector<std::vector<Vec2>>& outline, Colour colour,
             double width_px);
/// Ticks with coordinates in metres along the left and lower border, north arrow and scale bar.
void add_axes(Drawing& drawing, const PlanFrame& frame, double type_px);
void add_scale_bar(Drawing& drawing, const Vec2& at_px, double px_per_m, double longest_px, double type_px,
                   const std::string& note = "");
void add_north(Drawing& drawing, const Vec2& at_px, double length_px);
/// A bar of colours, ticks below, quantity and unit above. Level, its upper left corner at `at_px`.
void add_colour_bar(Drawing& drawing, const Ramp& ramp, const Vec2& at_px, double width_px, double type_px);
/// A line of the world's plan.
void add_path(Drawing& drawing, const PlanFrame& frame, const std::vector<Vec2>& line_W, Colour colour, double width_px,
              double dash_px = 0);
/// Numbered marks, the first is the worst.
void add_marks(Drawing& drawing, const PlanFrame& frame, const std::vector<Vec2>& places_W, double radius_px,
               const std::vector<std::string>& titles, const std::string& link_stem);
/// An entry of a legend: a stroke of the colour and its words. Returns the width that it took.
double add_key(Drawing& drawing, const Vec2& at_px, Colour colour, const std::string& words, double type_px,
               double dash_px = 0);

/// A layer over the frame's rectangle with one pixel for each of the drawing's (times `fine`), coloured by the cell's
/// points.
/// @param n        points; `at(k)` is the place of one
/// @param colour   of a cell, given the indices of its points; alpha 0 leaves it open
Layer cell_layer(const PlanFrame& frame, double fine, size_t n, const std::function<Vec2(size_t)>& at,
                 const std::function<Colour(std::span<const std::uint32_t>)>& colour);

/// "12.3", with as many decimals as the size asks for and never "-0".
std::string plain_number(double value, int digits = 3);

}  // namespace adit
