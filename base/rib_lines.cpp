// SPDX-License-Identifier: BSD-3-Clause
#include "base/rib_lines.h"

#include "base/dxf.h"
#include "base/files.h"
#include "base/polyline.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace adit {
namespace {

/// Crossings of the level between neighbouring cells. A crossing on the way from (i, j) to the right is number 2 n, up
/// to the next row 2 n + 1, n = the cell's index.
class Contour {
 public:
  explicit Contour(const Grid& grid) : grid_(grid), next_(2 * grid.log_odds.size(), none) {
    for (int j = 0; j + 1 < grid.height; ++j)
      for (int i = 0; i + 1 < grid.width; ++i) add_square(i, j);
  }

  std::vector<std::vector<Vec2>> rings() {
    std::vector<std::vector<Vec2>> all;
    for (std::uint32_t first = 0; first < next_.size(); ++first) {
      if (next_[first] == none) continue;
      std::vector<Vec2> ring;
      for (std::uint32_t at = first; next_[at] != none;) {
        ring.push_back(point(at));
        const std::uint32_t to = next_[at];
        next_[at] = none;
        at = to;
      }
      all.push_back(std::move(ring));
    }
    return all;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  // Free is positive. Cells at the border count as not free, so that every ring closes.
  double freedom(int i, int j) const {
    constexpr double sure = 2, unseen = -0.2;
    if (i == 0 || j == 0 || i + 1 == grid_.width || j + 1 == grid_.height) return unseen;
    const double odds = grid_.log_odds[grid_.index(i, j)];
    return odds == 0 ? unseen : std::clamp(-odds, -sure, sure);
  }
  bool is_free(int i, int j) const { return freedom(i, j) > 0; }

  Vec2 point(std::uint32_t crossing) const {
    const int i = static_cast<int>(crossing / 2 % grid_.width), j = static_cast<int>(crossing / 2 / grid_.width);
    const bool up = crossing % 2 == 1;
    const double a = freedom(i, j), b = freedom(i + !up, j + up);
    const double s = a / (a - b);
    return grid_.centre(i, j) + grid_.cell_m * (up ? Vec2(0, s) : Vec2(s, 0));
  }

  // Links the crossings of the square between four cells, free space on the left hand.
  void add_square(int i, int j) {
    const bool corner[4] = {is_free(i, j), is_free(i + 1, j), is_free(i + 1, j + 1), is_free(i, j + 1)};
    const auto n = static_cast<std::uint32_t>(grid_.index(i, j)), above = n + static_cast<std::uint32_t>(grid_.width);
    const std::uint32_t side[4] = {2 * n, 2 * (n + 1) + 1, 2 * above, 2 * n + 1};  // bottom, right, top, left
    // Round the square: free space is entered between a corner that is not and one that is. The line leaves where the
    // stretch of free corners ends and comes in where it begins: corners that touch at a point only stay apart.
    for (int k = 0; k < 4; ++k) {
      if (corner[k] || !corner[(k + 1) % 4]) continue;
      int end = (k + 1) % 4;
      while (corner[(end + 1) % 4]) end = (end + 1) % 4;
      next_[side[end]] = side[k];
    }
  }

  const Grid& grid_;
  std::vector<std::uint32_t> next_;
};

nlohmann::json json_of(const std::vector<Vec2>& ring) {
  const auto to_mm = [](double v) { return std::round(v * 1000) / 1000; };
  nlohmann::json points = nlohmann::json::array();
  for (size_t k = 0; k <= ring.size(); ++k) {
    const Vec2& p = ring[k % ring.size()];
    points.push_back({to_mm(p.x()), to_mm(p.y())});
  }
  return points;
}

}  // namespace

std::vector<std::vector<Vec2>> rib_lines(const Grid& grid, const RibLineSettings& settings) {
  std::vector<std::vector<Vec2>> rings;
  if (grid.width < 2 || grid.height < 2) return rings;
  for (std::vector<Vec2>& ring : Contour(grid).rings()) {
    if (std::abs(signed_area(ring)) < settings.least_m2) continue;
    ring.push_back(ring.front());
    ring = simplified(ring, settings.tolerance_m);
    ring.pop_back();
    if (ring.size() >= 3) rings.push_back(std::move(ring));
  }
  std::stable_sort(rings.begin(), rings.end(),
                   [](const auto& a, const auto& b) { return std::abs(signed_area(a)) > std::abs(signed_area(b)); });
  return rings;
}

void write_rib_lines(const std::string& file, const std::vector<std::vector<Vec2>>& rings) {
  Dxf dxf;
  std::vector<nlohmann::json> polygons;
  std::vector<size_t> outer;  // ring of each polygon
  for (size_t k = 0; k < rings.size(); ++k) {
    const bool is_pillar = signed_area(rings[k]) < 0;
    dxf.polyline(is_pillar ? "PILLARS" : "VOID", rings[k], true);
    if (is_pillar) continue;
    outer.push_back(k);
    polygons.push_back(nlohmann::json::array({json_of(rings[k])}));
  }
  for (const std::vector<Vec2>& ring : rings) {
    if (signed_area(ring) > 0) continue;
    // The smallest polygon about it: rings come by size.
    for (size_t n = outer.size(); n-- > 0;)
      if (contains(rings[outer[n]], ring.front())) {
        polygons[n].push_back(json_of(ring));
        break;
      }
  }
  std::string text = "{\"type\": \"FeatureCollection\", \"features\": [";
  for (size_t n = 0; n < polygons.size(); ++n) {
    const nlohmann::json feature = {{"type", "Feature"},
                                    {"properties", {{"kind", "void"}}},
                                    {"geometry", {{"type", "Polygon"}, {"coordinates", polygons[n]}}}};
    text += (n ? ",\n" : "\n") + feature.dump();
  }
  write_text(file + ".geojson", text + "\n]}\n");
  write_text(file + ".dxf", dxf.text());
}

}  // namespace adit
