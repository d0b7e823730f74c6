// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/lattice.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace adit {
namespace {

// Corner k of a cell is corner_of[k], side k runs from corner k to k + 1, counter-clockwise from the lower left.
constexpr std::array<std::array<int, 2>, 4> corner_of{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

// Where the level is crossed between a node and the one to the right of it or above it.
Vec2 crossing(const Lattice& f, double level, int i, int j, bool up) {
  const double a = f.value[f.index(i, j)], b = f.value[up ? f.index(i, j + 1) : f.index(i + 1, j)];
  const double s = std::clamp((level - a) / (b - a), 0.0, 1.0);
  return f.node(i, j) + f.cell_m * (up ? Vec2(0, s) : Vec2(s, 0));
}

void link_cell(const Lattice& f, double level, int i, int j, std::vector<Link>& links) {
  std::array<bool, 4> below;
  int count = 0;
  for (int k = 0; k < 4; ++k) {
    below[k] = f.value[f.index(i + corner_of[k][0], j + corner_of[k][1])] < level;
    count += below[k];
  }
  if (count == 0 || count == 4) return;
  // Sides of the lattice have numbers: 2 * node for the one to the right of it, 2 * node + 1 for the one above it.
  const auto number = [&](int x, int y, bool up) {
    return 2 * (static_cast<std::uint64_t>(f.j0 + y) << 31 | static_cast<std::uint64_t>(f.i0 + x)) + up;
  };
  const std::array<std::uint64_t, 4> side{number(i, j, false), number(i + 1, j, true), number(i, j + 1, false),
                                          number(i, j, true)};
  const auto place = [&](int k) { return crossing(f, level, i + (k == 1), j + (k == 2), k % 2 == 1); };
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
    links.push_back({side[in], side[out], place(in), place(out)});
  }
}

}  // namespace

double Lattice::at(const Vec2& p) const {
  const double x = std::clamp((p.x() - origin.x()) / cell_m - i0, 0.0, width - 1.001);
  const double y = std::clamp((p.y() - origin.y()) / cell_m - j0, 0.0, height - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * value[index(i, j)] + u * value[index(i + 1, j)]) +
         v * ((1 - u) * value[index(i, j + 1)] + u * value[index(i + 1, j + 1)]);
}

void add_links(const Lattice& f, double level, int i_begin, int i_end, int j_begin, int j_end,
               std::vector<Link>& links) {
  for (int j = std::max(0, j_begin); j < std::min(f.height - 1, j_end); ++j)
    for (int i = std::max(0, i_begin); i < std::min(f.width - 1, i_end); ++i) link_cell(f, level, i, j, links);
}

std::vector<Loop> join_links(std::vector<Link> links) {
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.from < b.from; });
  std::vector<char> used(links.size(), 0);
  std::vector<Loop> loops;
  for (size_t first = 0; first < links.size(); ++first) {
    if (used[first]) continue;
    Loop loop;
    for (size_t at = first; !used[at];) {
      used[at] = 1;
      loop.push_back(links[at].at);
      const auto next = std::lower_bound(links.begin(), links.end(), links[at].to,
                                         [](const Link& a, std::uint64_t side) { return a.from < side; });
      ADIT_CHECK(next != links.end() && next->from == links[at].to);  // else a line runs off the lattice
      at = static_cast<size_t>(next - links.begin());
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

std::vector<Loop> contours(const Lattice& f, double level) {
  std::vector<Link> links;
  add_links(f, level, 0, f.width, 0, f.height, links);
  return join_links(std::move(links));
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
