// SPDX-License-Identifier: BSD-3-Clause
#include "eval/plan.h"

#include "eval/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

namespace adit {

std::string plain_number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  const int before = size > 0 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 1;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", std::clamp(digits - before, 0, 6), value);
  std::string s = text;
  if (s.find('.') != std::string::npos) {
    while (s.ends_with('0')) s.pop_back();
    if (s.ends_with('.')) s.pop_back();
  }
  if (s == "-0") s = "0";
  if (s.starts_with('-')) s = "−" + s.substr(1);
  return s;
}

std::pair<Drawing, PlanFrame> plan_sheet(const Vec2& low_W, const Vec2& high_W, double width_px,
                                         const std::array<double, 4>& room_px) {
  PlanFrame frame;
  frame.low_W = low_W;
  frame.high_W = high_W;
  frame.px_per_m = (width_px - room_px[0] - room_px[2]) / std::max(1e-6, high_W.x() - low_W.x());
  frame.origin_px = Vec2(room_px[0], room_px[1]);
  Drawing drawing;
  drawing.width_px = width_px;
  drawing.height_px = 2 * std::ceil((room_px[1] + room_px[3] + frame.height_px()) / 2);
  drawing.background = ink::paper;
  return {drawing, frame};
}

void add_ground(Drawing& drawing, const PlanFrame& frame, const std::vector<std::vector<Vec2>>& outline) {
  const Vec2 a = frame.origin_px, b = a + Vec2(frame.width_px(), frame.height_px());
  drawing.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::rock});
  std::vector<std::vector<Vec2>> rings;
  for (const auto& ring : outline) {
    rings.emplace_back();
    for (const Vec2& p : clipped_ring(ring, frame.low_W, frame.high_W)) rings.back().push_back(frame(p));
    if (rings.back().size() < 3) rings.pop_back();
  }
  if (rings.empty()) return;
  drawing.add(Area{rings, ink::open});
}

void add_rim(Drawing& drawing, const PlanFrame& frame, const std::vector<std::vector<Vec2>>& outline, Colour colour,
             double width_px) {
  for (const auto& ring : outline) {
    Line line{{}, colour, width_px};
    const auto flush = [&] {
      if (line.p.size() > 1) drawing.add(line);
      line.p.clear();
    };
    for (size_t k = 0; k < ring.size(); ++k) {
      const auto stretch = clipped_stretch(ring[k], ring[(k + 1) % ring.size()], frame.low_W, frame.high_W);
      if (!stretch) {
        flush();
        continue;
      }
      const Vec2 a = frame(stretch->first), b = frame(stretch->second);
      if (line.p.empty() || (line.p.back() - a).norm() > 1e-6) flush(), line.p.push_back(a);
      line.p.push_back(b);
    }
    flush();
  }
}

void add_path(Drawing& drawing, const PlanFrame& frame, const std::vector<Vec2>& line_W, Colour colour, double width_px,
              double dash_px) {
  Line line{{}, colour, width_px, dash_px};
  for (const Vec2& p : simplified(line_W, 0.3 / frame.px_per_m)) line.p.push_back(frame(p));
  if (line.p.size() > 1) drawing.add(std::move(line));
}

void add_axes(Drawing& drawing, const PlanFrame& frame, double type_px) {
  const double step = round_down_125(std::max(1e-3, (frame.high_W - frame.low_W).maxCoeff() / 4));
  const Vec2 a = frame.origin_px, b = a + Vec2(frame.width_px(), frame.height_px());
  const Type type{.size_px = type_px, .colour = ink::faint, .anchor = Anchor::middle};
  for (double x = step * std::ceil(frame.low_W.x() / step); x <= frame.high_W.x() + 1e-9; x += step) {
    const double px = frame({x, frame.low_W.y()}).x();
    drawing.add(Line{{{px, b.y()}, {px, b.y() + 6}}, ink::faint, 1.5});
    drawing.add(Words{{px, b.y() + 8 + type_px}, plain_number(x, 4), type});
  }
  Type right = type;
  right.anchor = Anchor::end;
  for (double y = step * std::ceil(frame.low_W.y() / step); y <= frame.high_W.y() + 1e-9; y += step) {
    const double px = frame({frame.low_W.x(), y}).y();
    drawing.add(Line{{{a.x() - 6, px}, {a.x(), px}}, ink::faint, 1.5});
    drawing.add(Words{{a.x() - 9, px + 0.35 * type_px}, plain_number(y, 4), right});
  }
}

void add_scale_bar(Drawing& drawing, const Vec2& at_px, double px_per_m, double longest_px, double type_px,
                   const std::string& note) {
  const double metres = round_down_125(longest_px / px_per_m), length = metres * px_per_m;
  drawing.add(Line{{at_px, at_px + Vec2(length, 0)}, ink::white, 7});
  drawing.add(Line{{at_px + Vec2(0, -5), at_px + Vec2(0, 5)}, ink::text, 3});
  drawing.add(Line{{at_px + Vec2(length, -5), at_px + Vec2(length, 5)}, ink::text, 3});
  drawing.add(Line{{at_px, at_px + Vec2(length, 0)}, ink::text, 3});
  drawing.add(Words{at_px + Vec2(0, -10),
                    plain_number(metres) + " m" + note,
                    {.size_px = type_px, .colour = ink::text, .halo_px = 2}});
}

void add_north(Drawing& drawing, const Vec2& at_px, double length_px) {
  const double h = length_px, w = 0.28 * length_px;
  drawing.add(
      Area{{{at_px + Vec2(0, -h / 2), at_px + Vec2(w, h / 2), at_px + Vec2(0, 0.3 * h), at_px + Vec2(-w, h / 2)}},
           ink::text});
  drawing.add(Words{at_px + Vec2(0, h / 2 + 0.55 * h),
                    "N",
                    {.size_px = 0.5 * h, .colour = ink::text, .anchor = Anchor::middle, .bold = true, .halo_px = 2}});
}

void add_colour_bar(Drawing& drawing, const Ramp& ramp, const Vec2& at_px, double width_px, double type_px) {
  const int columns = 256;
  Picture picture(columns, 1, {});
  for (int x = 0; x < columns; ++x)
    picture.at(x, 0) = ramp.colour(ramp.low + (ramp.high - ramp.low) * x / (columns - 1.0));
  const double height = 0.8 * type_px, top = at_px.y() + 1.35 * type_px;
  drawing.add(Words{at_px + Vec2(0, type_px),
                    ramp.quantity + ", " + ramp.unit,
                    {.size_px = type_px, .colour = ink::text, .halo_px = 2}});
  drawing.add(Layer{picture, {at_px.x(), top}, {at_px.x() + width_px, top + height}});
  for (int k = 0; k <= 4; ++k) {
    const double s = k / 4.0, x = at_px.x() + s * width_px, value = ramp.low + s * (ramp.high - ramp.low);
    drawing.add(Line{{{x, top + height}, {x, top + height + 5}}, ink::text, 1.5});
    const std::string sign = value > 1e-12 && ramp.low < 0 ? "+" : "";
    drawing.add(Words{{x, top + height + 5 + type_px},
                      sign + plain_number(value),
                      {.size_px = type_px, .colour = ink::text, .anchor = Anchor::middle, .halo_px = 2}});
  }
}

namespace {

// Where the number of ring k stands: on the ring, up to the right unless another ring or number is nearer than elsewhere.
Vec2 tag_of(const std::vector<Vec2>& rings, const std::vector<Vec2>& tags, size_t k, double radius_px) {
  constexpr std::array<double, 8> ways = {45, 135, -45, -135, 90, -90, 0, 180};
  const double ring_px = 1.9 * radius_px, enough_px = 2.2 * radius_px;
  Vec2 best = rings[k];
  double most = -1;
  for (const double way : ways) {
    const double a = way * std::numbers::pi / 180;
    const Vec2 tag = rings[k] + 1.06 * ring_px * Vec2(std::cos(a), -std::sin(a));
    double clear = enough_px;
    for (const Vec2& other : tags) clear = std::min(clear, (other - tag).norm());
    for (size_t j = 0; j < rings.size(); ++j)
      if (j != k) clear = std::min(clear, std::abs((rings[j] - tag).norm() - ring_px) + radius_px);
    if (clear > most + 1e-9) most = clear, best = tag;
  }
  return best;
}

}  // namespace

void add_marks(Drawing& drawing, const PlanFrame& frame, const std::vector<Vec2>& places_W, double radius_px,
               const std::vector<std::string>& titles, const std::string& link_stem) {
  std::vector<Vec2> rings, tags;
  for (const Vec2& p : places_W) rings.push_back(frame(p));
  for (size_t k = 0; k < rings.size(); ++k) tags.push_back(tag_of(rings, tags, k, radius_px));
  for (size_t k = rings.size(); k-- > 0;)
    for (const auto& [colour, width] : {std::pair(ink::white, 6.0), std::pair(ink::mark, 2.5)})
      drawing.add(
          Disc{.centre = rings[k], .radius_px = 1.9 * radius_px, .fill = {0, 0, 0, 0}, .rim = colour, .rim_px = width});
  for (size_t k = rings.size(); k-- > 0;) {
    const std::string number = std::to_string(k + 1);
    drawing.add(Disc{.centre = tags[k],
                     .radius_px = radius_px,
                     .fill = ink::mark,
                     .rim = ink::white,
                     .rim_px = 2,
                     .link = link_stem.empty() ? "" : link_stem + number,
                     .title = k < titles.size() ? titles[k] : ""});
    drawing.add(Words{tags[k] + Vec2(0, 0.42 * radius_px),
                      number,
                      {.size_px = 1.2 * radius_px, .colour = ink::white, .anchor = Anchor::middle, .bold = true}});
  }
}

double add_key(Drawing& drawing, const Vec2& at_px, Colour colour, const std::string& words, double type_px,
               double dash_px) {
  drawing.add(
      Line{{at_px + Vec2(0, -0.35 * type_px), at_px + Vec2(1.8 * type_px, -0.35 * type_px)}, colour, 3.5, dash_px});
  drawing.add(Words{at_px + Vec2(2.3 * type_px, 0), words, {.size_px = type_px, .colour = ink::text, .halo_px = 2}});
  return 2.3 * type_px + text_width(words, type_px) + 1.4 * type_px;
}

Layer cell_layer(const PlanFrame& frame, double fine, size_t n, const std::function<Vec2(size_t)>& at,
                 const std::function<Colour(std::span<const std::uint32_t>)>& colour) {
  const int width = std::max(1, static_cast<int>(std::lround(fine * frame.width_px())));
  const int height = std::max(1, static_cast<int>(std::lround(fine * frame.height_px())));
  constexpr std::uint32_t outside = ~0u;
  std::vector<std::uint32_t> cell(n, outside), begin(static_cast<size_t>(width) * height + 1, 0);
  for (size_t k = 0; k < n; ++k) {
    const Vec2 px = frame(at(k)) - frame.origin_px;
    const double x = px.x() / frame.width_px() * width, y = px.y() / frame.height_px() * height;
    if (!(x >= 0 && y >= 0 && x < width && y < height)) continue;
    cell[k] = static_cast<std::uint32_t>(y) * width + static_cast<std::uint32_t>(x);
    ++begin[cell[k] + 1];
  }
  for (size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  std::vector<std::uint32_t> member(begin.back()), next(begin.begin(), begin.end() - 1);
  for (size_t k = 0; k < n; ++k)
    if (cell[k] != outside) member[next[cell[k]]++] = static_cast<std::uint32_t>(k);
  Layer layer{Picture(width, height, {0, 0, 0, 0}), frame.origin_px,
              frame.origin_px + Vec2(frame.width_px(), frame.height_px())};
  for (size_t c = 0; c + 1 < begin.size(); ++c)
    if (begin[c + 1] > begin[c]) layer.picture.pixel[c] = colour({member.data() + begin[c], begin[c + 1] - begin[c]});
  return layer;
}

}  // namespace adit
