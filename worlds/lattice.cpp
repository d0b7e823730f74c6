// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/lattice.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace adit {
namespace {

// Edges of the lattice have numbers: 2 * node for the one to the right of it, 2 * node + 1 for the one above it.
struct Link {
  std::uint64_t from, to;
  bool operator<(const Link& other) const { return from < other.from; }
};

// Corner k of a cell is corner_of[k], side k runs from corner k to k + 1, counter-clockwise from the lower left.
constexpr std::array<std::array<int, 2>, 4> corner_of{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

void link_cell(const Lattice& f, double level, int i, int j, std::vector<Link>& links) {
  std::array<bool, 4> below;
  int count = 0;
  for (int k = 0; k < 4; ++k) {
    below[k] = f.value[f.index(i + corner_of[k][0], j + corner_of[k][1])] < level;
    count += below[k];
  }
  if (count == 0 || count == 4) return;
  const std::uint64_t here = f.index(i, j);
  const std::array<std::uint64_t, 4> side{2 * here, 2 * f.index(i + 1, j) + 1, 2 * f.index(i, j + 1), 2 * here + 1};
  // Going round counter-clockwise, a line with the part below on its left enters where we go from above to below ...
  // and leaves where we go from below to above; in a saddle the two corners below are joined.
  std::vector<int> enters, leaves;
  for (int k = 0; k < 4; ++k) {
    const bool now = below[k], next = below[(k + 1) % 4];
    if (now && !next) enters.push_back(k);
    if (!now && next) leaves.push_back(k);
  }
  for (int in : enters) {
    int out = leaves[0];
    for (int k = 1; k < 4;
         ++k) {  // the first way out, round the corners above: they stay apart, those below are joined
      const int candidate = (in + k) % 4;
      if (std::find(leaves.begin(), leaves.end(), candidate) != leaves.end()) {
        out = candidate;
        break;
      }
    }
    links.push_back({side[in], side[out]});
  }
}

Vec2 crossing(const Lattice& f, double level, std::uint64_t edge) {
  const std::uint64_t node = edge / 2;
  const int i = static_cast<int>(node % f.width), j = static_cast<int>(node / f.width);
  const bool up = edge % 2;
  const double a = f.value[node], b = f.value[up ? f.index(i, j + 1) : f.index(i + 1, j)];
  const double s = std::clamp((level - a) / (b - a), 0.0, 1.0);
  return f.node(i, j) + f.cell_m * (up ? Vec2(0, s) : Vec2(s, 0));
}

}  // namespace

double Lattice::at(const Vec2& p) const {
  const double x = std::clamp((p.x() - origin.x()) / cell_m, 0.0, width - 1.001);
  const double y = std::clamp((p.y() - origin.y()) / cell_m, 0.0, height - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * value[index(i, j)] + u * value[index(i + 1, j)]) +
         v * ((1 - u) * value[index(i, j + 1)] + u * value[index(i + 1, j + 1)]);
}

std::vector<Loop> contours(const Lattice& f, double level) {
  std::vector<Link> links;
  for (int j = 0; j + 1 < f.height; ++j)
    for (int i = 0; i + 1 < f.width; ++i) link_cell(f, level, i, j, links);
  std::sort(links.begin(), links.end());
  std::vector<char> used(links.size(), 0);
  std::vector<Loop> loops;
  for (size_t first = 0; first < links.size(); ++first) {
    if (used[first]) continue;
    Loop loop;
    for (size_t at = first; !used[at];) {
      used[at] = 1;
      loop.push_back(crossing(f, level, links[at].from));
      const auto next = std::lower_bound(links.begin(), links.end(), Link{links[at].to, 0});
      ADIT_CHECK(next != links.end() && next->from == links[at].to);  // else a line runs off the lattice
      at = static_cast<size_t>(next - links.begin());
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

double enclosed_area(const Loop& loop) {
  double twice = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i] - loop[0], b = loop[(i + 1) % loop.size()] - loop[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

}  // namespace adit
