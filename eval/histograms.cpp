// SPDX-License-Identifier: BSD-3-Clause
#include "eval/histograms.h"

#include "eval/chart_axes.h"
#include "eval/ramp.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

constexpr int bins = 20, columns = 3;
constexpr double panel_px = 400, height_px = 250, head_px = 70;

// Per cent of the values in each of the bins of [low, high].
std::vector<double> shares(const std::vector<double>& values, double low, double high) {
  std::vector<double> share(bins, 0);
  for (const double v : values)
    share[std::clamp(static_cast<int>((v - low) / (high - low) * bins), 0, bins - 1)] +=
        100.0 / static_cast<double>(values.size());
  return share;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

void add_stated(Drawing& drawing, const Axes& axes, const std::vector<double>& stated) {
  const auto [least, most] = std::minmax_element(stated.begin(), stated.end());
  if (*most - *least < 1e-9 * std::max(1.0, std::abs(*most))) {
    drawing.add(Line{{axes(*least, 0), axes(*least, axes.high.y())}, ink::raw, 2.5});
    return;
  }
  const std::vector<double> share = shares(stated, axes.low.x(), axes.high.x());
  const double wide = (axes.high.x() - axes.low.x()) / bins;
  Line outline{{axes(axes.low.x(), 0)}, ink::raw, 2.5};
  for (int k = 0; k < bins; ++k)
    for (const int end : {0, 1}) outline.p.push_back(axes(axes.low.x() + (k + end) * wide, share[k]));
  outline.p.push_back(axes(axes.high.x(), 0));
  drawing.add(std::move(outline));
}

void add_panel(Drawing& drawing, const Histogram& h, const Vec2& corner_px) {
  double low = 1e300, high = -1e300;
  for (const auto* list : {&h.value, &h.stated})
    for (const double v : *list) low = std::min(low, v), high = std::max(high, v);
  const double margin = high > low ? 0.03 * (high - low) : (high == 0 ? 0.5 : 0.1 * std::abs(high));
  low -= margin, high += margin;
  const std::vector<double> share = shares(h.value, low, high);
  double top = *std::max_element(share.begin(), share.end());
  if (!h.stated.empty()) {
    const std::vector<double> asked = shares(h.stated, low, high);
    if (*std::max_element(asked.begin(), asked.end()) < 99)
      top = std::max(top, *std::max_element(asked.begin(), asked.end()));
  }
  const Axes axes{{low, 0}, {high, 1.1 * top}, corner_px + Vec2(52, 44), {panel_px - 82, height_px - 104}, 2};
  add_axes(drawing, axes, "", "");
  const double wide = (high - low) / bins;
  for (int k = 0; k < bins; ++k) {
    if (share[k] <= 0) continue;
    const Vec2 a = axes(low + k * wide, share[k]) + Vec2(0.5, 0), b = axes(low + (k + 1) * wide, 0) - Vec2(0.5, 0);
    drawing.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::map});
  }
  if (!h.stated.empty()) add_stated(drawing, axes, h.stated);
  drawing.add(Words{corner_px + Vec2(52, 16), h.name, {.size_px = 16, .colour = ink::text, .bold = true}});
  std::string words = "% of " + std::to_string(h.value.size()) + ", mean " + plain_number(mean_of(h.value));
  if (!h.stated.empty()) words += ", stated " + plain_number(mean_of(h.stated));
  drawing.add(Words{corner_px + Vec2(52, 36), words, {.size_px = 14, .colour = ink::faint}});
}

}  // namespace

Drawing histogram_sheet(const std::vector<Histogram>& all, const std::string& title) {
  std::vector<const Histogram*> shown;
  for (const Histogram& h : all)
    if (!h.value.empty()) shown.push_back(&h);
  Drawing drawing;
  drawing.width_px = columns * panel_px;
  drawing.height_px = head_px + height_px * std::ceil(static_cast<double>(shown.size()) / columns);
  drawing.add(Words{{24, 34}, title, {.size_px = 22, .colour = ink::text, .bold = true}});
  const double next = add_key(drawing, {640, 34}, ink::map, "measured", 17);
  add_key(drawing, {640 + next, 34}, ink::raw, "stated", 17);
  for (size_t k = 0; k < shown.size(); ++k)
    add_panel(drawing, *shown[k],
              {panel_px * static_cast<double>(k % columns), head_px + height_px * std::floor(k / columns)});
  return drawing;
}

}  // namespace adit
