// SPDX-License-Identifier: BSD-3-Clause
#include "eval/drawing.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace adit {

namespace {

// Coverage of the pixels of a picture, row by row, gathered before the colour is laid on once.
class Mask {
 public:
  Mask(int width, int height, Vec2 low, Vec2 high)
      : x0_(std::clamp(static_cast<int>(std::floor(low.x())) - 1, 0, width)),
        y0_(std::clamp(static_cast<int>(std::floor(low.y())) - 1, 0, height)),
        x1_(std::clamp(static_cast<int>(std::ceil(high.x())) + 1, 0, width)),
        y1_(std::clamp(static_cast<int>(std::ceil(high.y())) + 1, 0, height)),
        cover_(static_cast<size_t>(std::max(0, x1_ - x0_)) * std::max(0, y1_ - y0_), 0.f) {}

  int x0() const { return x0_; }
  int x1() const { return x1_; }
  int y0() const { return y0_; }
  int y1() const { return y1_; }
  float& at(int x, int y) { return cover_[static_cast<size_t>(y - y0_) * (x1_ - x0_) + (x - x0_)]; }
  void lay(Picture& picture, Colour colour) {
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x)
        if (at(x, y) > 0) blend(picture, x, y, colour, at(x, y));
  }

 private:
  int x0_, y0_, x1_, y1_;
  std::vector<float> cover_;
};

std::pair<Vec2, Vec2> bounds(const std::vector<Vec2>& points) {
  Vec2 low = points.front(), high = low;
  for (const Vec2& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return {low, high};
}

// A pixel is covered by 1/2 + half width - distance to the segment, as by a line with an edge one pixel soft.
void cover_segment(Mask& mask, const Vec2& a, const Vec2& b, double half_px) {
  const double reach = half_px + 1;
  const Vec2 low = a.cwiseMin(b), high = a.cwiseMax(b), d = b - a;
  const double length2 = d.squaredNorm();
  for (int y = std::max(mask.y0(), static_cast<int>(low.y() - reach));
       y <= std::min(mask.y1() - 1, static_cast<int>(high.y() + reach)); ++y)
    for (int x = std::max(mask.x0(), static_cast<int>(low.x() - reach));
         x <= std::min(mask.x1() - 1, static_cast<int>(high.x() + reach)); ++x) {
      const Vec2 q = Vec2(x + 0.5, y + 0.5) - a;
      const double s = length2 > 0 ? std::clamp(q.dot(d) / length2, 0.0, 1.0) : 0;
      const double cover = std::clamp(0.5 + half_px - (q - s * d).norm(), 0.0, 1.0) * std::min(1.0, 2 * half_px);
      mask.at(x, y) = std::max(mask.at(x, y), static_cast<float>(cover));
    }
}

// The line cut into dashes, or as it is.
std::vector<std::pair<Vec2, Vec2>> strokes_of(const Line& line) {
  std::vector<std::pair<Vec2, Vec2>> strokes;
  double along = 0;
  for (size_t k = 1; k < line.p.size(); ++k) {
    const Vec2 &a = line.p[k - 1], &b = line.p[k];
    if (line.dash_px <= 0) {
      strokes.emplace_back(a, b);
      continue;
    }
    const double length = (b - a).norm();
    for (double s = 0; s < length;) {
      const double phase = std::fmod(along + s, 2 * line.dash_px);
      const double step = std::min(length - s, (phase < line.dash_px ? line.dash_px : 2 * line.dash_px) - phase + 1e-6);
      if (phase < line.dash_px) strokes.emplace_back(a + (b - a) * (s / length), a + (b - a) * ((s + step) / length));
      s += step;
    }
    along += length;
  }
  return strokes;
}

void draw(Picture& picture, const Line& line, double scale) {
  if (line.p.empty()) return;
  const double half = line.width_px * scale / 2;
  auto [low, high] = bounds(line.p);
  Mask mask(picture.width, picture.height, scale * low - Vec2::Constant(half + 1),
            scale * high + Vec2::Constant(half + 1));
  for (const auto& [a, b] : strokes_of(line)) cover_segment(mask, scale * a, scale * b, half);
  mask.lay(picture, line.colour);
}

// Scan lines at four heights a pixel; exact coverage along x.
void draw(Picture& picture, const Area& area, double scale) {
  constexpr int fine = 4;
  std::vector<Vec2> all;
  for (const auto& ring : area.rings) all.insert(all.end(), ring.begin(), ring.end());
  if (all.empty()) return;
  auto [low, high] = bounds(all);
  Mask mask(picture.width, picture.height, scale * low, scale * high);
  std::map<int, std::vector<double>> crossings;  // by fine scan line
  for (const auto& ring : area.rings)
    for (size_t k = 0; k < ring.size(); ++k) {
      Vec2 a = scale * ring[k], b = scale * ring[(k + 1) % ring.size()];
      if (a.y() > b.y()) std::swap(a, b);
      const int first = std::max(mask.y0() * fine, static_cast<int>(std::ceil(a.y() * fine - 0.5)));
      const int last = std::min(mask.y1() * fine - 1, static_cast<int>(std::ceil(b.y() * fine - 0.5)) - 1);
      for (int row = first; row <= last; ++row)
        crossings[row].push_back(a.x() + (b.x() - a.x()) * ((row + 0.5) / fine - a.y()) / (b.y() - a.y()));
    }
  for (auto& [row, at] : crossings) {
    std::sort(at.begin(), at.end());
    for (size_t k = 0; k + 1 < at.size(); k += 2)
      for (int x = std::max(mask.x0(), static_cast<int>(std::floor(at[k]))); x < std::min<double>(mask.x1(), at[k + 1]);
           ++x)
        mask.at(x, row / fine) +=
            static_cast<float>(std::max(0.0, std::min(at[k + 1], x + 1.0) - std::max<double>(at[k], x)) / fine);
  }
  mask.lay(picture, area.colour);
}

void draw(Picture& picture, const Disc& disc, double scale) {
  const Vec2 c = scale * disc.centre;
  const double outer = scale * (disc.radius_px + disc.rim_px / 2), inner = scale * (disc.radius_px - disc.rim_px / 2);
  const Vec2 reach = Vec2::Constant(outer + 1);
  Mask ring(picture.width, picture.height, c - reach, c + reach), core = ring;
  cover_segment(ring, c, c, outer);
  cover_segment(core, c, c, inner);
  for (int y = ring.y0(); y < ring.y1(); ++y)
    for (int x = ring.x0(); x < ring.x1(); ++x) ring.at(x, y) -= core.at(x, y);
  if (disc.rim_px > 0) ring.lay(picture, disc.rim);
  core.lay(picture, disc.fill);
}

void draw(Picture& picture, const Words& words, double scale) {
  Type type = words.type;
  type.size_px *= scale;
  type.halo_px *= scale;
  draw_text(picture, scale * words.at.x(), scale * words.at.y(), words.text, type);
}

// Whether each of a layer's pixels falls on one of the picture's.
bool fits(const Layer& layer, const Vec2& low, const Vec2& size) {
  return size.x() == layer.picture.width && size.y() == layer.picture.height && low.x() == std::round(low.x()) &&
         low.y() == std::round(low.y());
}

// Each pixel takes the mean of the layer's pixels below it, or its nearest where the layer is the coarser one.
void draw(Picture& picture, const Layer& layer, double scale) {
  const Vec2 low = scale * layer.low, size = scale * (layer.high - layer.low);
  if (fits(layer, low, size)) {
    paste(picture, layer.picture, static_cast<int>(low.x()), static_cast<int>(low.y()));
    return;
  }
  const double per_x = layer.picture.width / size.x(), per_y = layer.picture.height / size.y();
  for (int y = std::max(0, static_cast<int>(low.y())); y < std::min<double>(picture.height, low.y() + size.y()); ++y)
    for (int x = std::max(0, static_cast<int>(low.x())); x < std::min<double>(picture.width, low.x() + size.x()); ++x) {
      const int u0 = static_cast<int>((x - low.x()) * per_x), v0 = static_cast<int>((y - low.y()) * per_y);
      const int u1 = std::max(u0 + 1, static_cast<int>((x + 1 - low.x()) * per_x)),
                v1 = std::max(v0 + 1, static_cast<int>((y + 1 - low.y()) * per_y));
      double r = 0, g = 0, b = 0, a = 0;
      for (int v = v0; v < v1; ++v)
        for (int u = u0; u < u1; ++u) {
          if (!layer.picture.contains(u, v)) continue;
          const Colour& c = layer.picture.at(u, v);
          r += c.a * c.r, g += c.a * c.g, b += c.a * c.b, a += c.a;
        }
      if (a <= 0) continue;
      const double n = static_cast<double>(u1 - u0) * (v1 - v0);
      blend(picture, x, y,
            {static_cast<std::uint8_t>(r / a), static_cast<std::uint8_t>(g / a), static_cast<std::uint8_t>(b / a), 255},
            a / 255 / n);
    }
}

}  // namespace

Layer flattened(const std::vector<Disc>& discs, const Vec2& low, const Vec2& high, double scale) {
  Drawing drawing;
  drawing.width_px = high.x() - low.x();
  drawing.height_px = high.y() - low.y();
  drawing.background = {255, 255, 255, 0};
  for (Disc disc : discs) {
    disc.centre -= low;
    drawing.add(std::move(disc));
  }
  return {to_picture(drawing, scale), low, high};
}

Picture to_picture(const Drawing& drawing, double scale) {
  Picture picture(static_cast<int>(std::lround(scale * drawing.width_px)),
                  static_cast<int>(std::lround(scale * drawing.height_px)), drawing.background);
  for (const auto& item : drawing.items) std::visit([&](const auto& one) { draw(picture, one, scale); }, item);
  return picture;
}

}  // namespace adit
