// SPDX-License-Identifier: BSD-3-Clause
// Sizes of falls: MSHA's fatality and near-miss notices; rates and angles: Pappas, Mark 2011 and practice.
#include "worlds/decay.h"

#include "base/rng.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace adit {
namespace {

constexpr double at_junctions = 0.7;  // of the falls
constexpr double off_rib_m = 0.15;    // a cavity ends before the rib: its brow
constexpr double head_m = 0.3;        // what is left between rubble and roof at least
constexpr double blocks_m = 0.15;     // rubble that no vehicle climbs
constexpr double pi = std::numbers::pi;

enum What : std::uint64_t { junction_fall = 1, passage_fall, skin_fall, stopping, car, beam };

class Lot {
 public:
  Lot(std::uint64_t seed, What what, size_t which) : seed_(seed), i_(static_cast<std::uint64_t>(what) << 40 | which) {}
  double uniform(double low, double high) {
    return low + (high - low) * adit::uniform(seed_, Draw::world_decay, i_, j_++);
  }
  double lognormal(double median, double s) {
    return median * std::exp(s * std::clamp(normal(seed_, Draw::world_decay, i_, j_++), -2.5, 2.5));
  }

 private:
  std::uint64_t seed_, i_, j_ = 0;
};

Vec2 turned(const Vec2& v) {
  return {-v.y(), v.x()};
}

struct Graph {
  const MinePlan& plan;
  std::vector<char> gone;  // (passages)

  /// Independent loops of what is left.
  int loops() const {
    std::vector<int> root(plan.nodes.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    int loops = 0;
    for (size_t p = 0; p < plan.passages.size(); ++p) {
      if (gone[p]) continue;
      const int a = find(plan.passages[p].a), b = find(plan.passages[p].b);
      if (a == b) ++loops;
      root[a] = b;
    }
    return loops;
  }
};

class Drawer {
 public:
  Drawer(const WorldSettings& s, const MinePlan& plan, const Workings& workings, std::uint64_t seed)
      : s_(s), plan_(plan), workings_(workings), seed_(seed), graph_{plan, std::vector<char>(plan.passages.size(), 0)} {
    degree_.assign(plan.nodes.size(), 0);
    for (size_t p = 0; p < plan.passages.size(); ++p) {
      ++degree_[plan.passages[p].a];
      ++degree_[plan.passages[p].b];
      length_.push_back(0.0);
      const auto& line = workings.drifts()[p].line;
      for (size_t i = 1; i < line.size(); ++i) length_.back() += (line[i] - line[i - 1]).norm();
      total_m_ += length_.back();
    }
    if (!workings.has_windows() && s.decay.falls_per_100m > 0) whole_ = workings.whole();
  }

  Decay draw() {
    if (s_.decay.falls_per_100m > 0) draw_falls();
    if (s_.decay.skins_per_100m > 0) draw_skins();
    out_.blocked = graph_.gone;
    draw_blockers();
    return std::move(out_);
  }

 private:
  // Marks passages as blocked if that is allowed.
  bool block(const std::vector<size_t>& passages) {
    std::vector<char> before = graph_.gone;
    for (size_t p : passages) graph_.gone[p] = 1;
    if (s_.decay.may_cut || graph_.loops() > 0) return true;
    graph_.gone = std::move(before);
    return false;
  }

  void draw_falls() {
    const double all = s_.decay.falls_per_100m * total_m_ / 100;
    const auto junctions =
        static_cast<double>(std::count_if(degree_.begin(), degree_.end(), [](int d) { return d > 2; }));
    for (size_t n = 0; n < plan_.nodes.size(); ++n) {
      if (degree_[n] < 3) continue;
      Lot lot(seed_, junction_fall, n);
      if (lot.uniform(0, 1) >= at_junctions * all / junctions) continue;
      for (size_t p = 0; p < plan_.passages.size(); ++p) {
        const auto& line = workings_.drifts()[p].line;
        const bool at_a = plan_.passages[p].a == static_cast<int>(n), at_b = plan_.passages[p].b == static_cast<int>(n);
        if (!at_a && !at_b) continue;
        const Vec2 at = at_a ? line.front() : line.back();
        add_fall(at, (line[line.size() / 2] - at).normalized(), p, lot);
        break;
      }
    }
    for (size_t p = 0; p < plan_.passages.size(); ++p) {
      Lot lot(seed_, passage_fall, p);
      const double share = junctions > 0 ? 1 - at_junctions : 1;
      if (lot.uniform(0, 1) >= share * all * length_[p] / total_m_) continue;
      const auto [at, along] = place(p, lot.uniform(0.25, 0.75));
      add_fall(at, along, p, lot);
    }
  }

  std::pair<Vec2, Vec2> place(size_t p, double share) const {
    const auto& line = workings_.drifts()[p].line;
    const auto k =
        std::clamp(static_cast<size_t>(share * static_cast<double>(line.size() - 1)), size_t{1}, line.size() - 2);
    return {line[k], (line[k + 1] - line[k - 1]).normalized()};
  }

  void add_fall(const Vec2& at, const Vec2& along, size_t passage, Lot& lot) {
    Fall f{};
    f.middle = at;
    f.along = along;
    f.half_along_m = lot.uniform(3, 6);
    f.half_across_m = std::min(f.half_along_m, plan_.passages[passage].width_m * lot.uniform(0.5, 0.65));
    f.height_m = std::min(5.0, lot.lognormal(s_.decay.fall_height_m, 0.4));
    f.wall = std::tan(lot.uniform(60, 80) * pi / 180);
    f.bed_m = lot.uniform(0, 1) < 0.5 ? lot.uniform(0.2, 0.45) : 0;
    f.repose = std::tan(lot.uniform(35, 40) * pi / 180);
    f.passage = static_cast<int>(passage);
    const double swell = lot.uniform(1.3, 1.5);
    if (lot.uniform(0, 1) >= s_.decay.cleared_share) {
      f.heap_m = heap_of(f, swell);
      if (!block(passages_under(f))) f.heap_m = 0;
    }
    out_.falls.push_back(f);
  }

  // The ridge's height at which the heap under the roof holds what came down, loosened.
  double heap_of(Fall f, double swell) const {
    constexpr double step = 0.2;
    f.heap_m = 3 * s_.height_m;
    const double reach = f.reach_m();
    const Frame2 frame{f.middle - Vec2::Constant(reach), f.middle + Vec2::Constant(reach)};
    const Outline seen = workings_.has_windows() ? workings_.window(frame) : Outline{};
    const Lattice& depth = workings_.has_windows() ? seen.depth : whole_.depth;
    struct Cell {
      Vec2 p;
      double cavity;
    };
    std::vector<Cell> cells;
    double came_down = 0;
    for (double y = frame.low.y(); y < frame.high.y(); y += step)
      for (double x = frame.low.x(); x < frame.high.x(); x += step) {
        const double d = depth.at({x, y});
        if (d >= 0) continue;
        cells.push_back({{x, y}, f.cavity_m({x, y}, d)});
        came_down += cells.back().cavity;
      }
    double low = 0, high = f.heap_m;
    for (int k = 0; k < 30; ++k) {
      f.heap_m = 0.5 * (low + high);
      double lies = 0;
      for (const Cell& c : cells) lies += std::min(f.rubble_m(c.p), s_.height_m + c.cavity - head_m);
      (lies < swell * came_down ? low : high) = f.heap_m;
    }
    return f.heap_m;
  }

  std::vector<size_t> passages_under(const Fall& f) const {
    std::vector<size_t> under;
    for (size_t p = 0; p < plan_.passages.size(); ++p) {
      const auto& line = workings_.drifts()[p].line;
      if (std::any_of(line.begin(), line.end(), [&](const Vec2& q) { return f.rubble_m(q) > blocks_m; }))
        under.push_back(p);
    }
    return under;
  }

  void draw_skins() {
    for (size_t p = 0; p < plan_.passages.size(); ++p) {
      const double expected = s_.decay.skins_per_100m * length_[p] / 100;
      for (int k = 0; k < 8; ++k) {
        Lot lot(seed_, skin_fall, 8 * p + static_cast<size_t>(k));
        if (lot.uniform(0, 1) >= expected / 8) continue;
        const auto [at, along] = place(p, lot.uniform(0.1, 0.9));
        Fall f{};
        const double width = plan_.passages[p].width_m;
        f.skin = true;
        f.half_along_m = 0.5 * std::min(9.0, lot.lognormal(3, 0.5));
        f.half_across_m = 0.5 * lot.uniform(0.9, std::max(0.95, std::min(2.5, width - 0.8)));
        f.middle = at + turned(along) * lot.uniform(-0.5, 0.5) * std::max(0.0, width - 0.6 - 2 * f.half_across_m);
        f.along = along;
        f.height_m = lot.uniform(0.05, 0.4);
        f.wall = 3;
        f.passage = static_cast<int>(p);
        out_.falls.push_back(f);
      }
    }
  }

  void draw_blockers() {
    const auto draw = [&](What what, Label label, size_t p, double expected, double margin_m) {
      Lot lot(seed_, what, p);
      if (lot.uniform(0, 1) >= expected || length_[p] < 2 * margin_m + 1 || graph_.gone[p]) return;
      const double from = margin_m / length_[p], share = lot.uniform(from, 1 - from);
      if (block({p})) out_.blockers.push_back({label, p, share});
    };
    const FurnitureSettings& f = s_.furniture;
    for (size_t p = 0; p < plan_.passages.size(); ++p) {
      const bool through = degree_[plan_.passages[p].a] > 1 && degree_[plan_.passages[p].b] > 1;
      if (through) draw(stopping, Label::stopping, p, f.stopping_share, 4);
      draw(car, Label::car, p, f.cars_per_100m * length_[p] / 100, 6);
      draw(beam, Label::beam, p, f.beams_per_100m * length_[p] / 100, 5);
    }
  }

  const WorldSettings& s_;
  const MinePlan& plan_;
  const Workings& workings_;
  std::uint64_t seed_;
  Graph graph_;
  std::vector<int> degree_;
  std::vector<double> length_;
  double total_m_ = 0;
  Outline whole_;
  Decay out_;
};

}  // namespace

double Fall::cavity_m(const Vec2& p, double depth_m) const {
  const Vec2 w = p - middle;
  const double u = std::abs(w.dot(along)), v = std::abs(w.dot(turned(along)));
  if (u > half_along_m || v > half_across_m) return 0;
  const double e = std::hypot(u / half_along_m, v / half_across_m);
  const double within = skin ? std::min(half_along_m - u, half_across_m - v) : (1 - e) * half_across_m;
  const double room = std::min(within, -depth_m - off_rib_m);
  if (room <= 0) return 0;
  double h = std::min(skin ? height_m : height_m * (bed_m > 0 ? 1 : 1 - 0.3 * e * e), wall * room);
  if (bed_m > 0) {  // broken to bedding planes, each step as steep as the sides
    const double step = std::floor(h / bed_m), rest = h / bed_m - step;
    h = bed_m * (step + std::min(1.0, 3 * rest));
    h = std::min(h, height_m);
  }
  return h;
}

double Fall::rubble_m(const Vec2& p) const {
  if (heap_m <= 0) return 0;
  const Vec2 w = p - middle;
  const double ridge = std::max(0.0, half_along_m - half_across_m);
  const double u = std::max(0.0, std::abs(w.dot(along)) - ridge), v = w.dot(turned(along));
  return std::max(0.0, heap_m - repose * std::hypot(u, v));
}

double Fall::reach_m() const {
  return std::max(half_along_m, half_along_m - half_across_m + (heap_m > 0 ? heap_m / repose : 0)) + 0.5;
}

bool Fall::buried(const Vec2& p) const {
  if (heap_m <= 0) return false;
  const Vec2 w = p - middle;
  const double reach = reach_m();
  if (w.squaredNorm() > reach * reach) return false;
  return std::hypot(w.dot(along) / half_along_m, w.dot(turned(along)) / half_across_m) < 1 || rubble_m(p) > 0.05;
}

// Nearest of points scattered over squares: each stone has its own height and lean.
double stones_m(const Vec2& p, std::uint64_t seed) {
  constexpr double gap_m = 0.55;
  const Vec2 at = p / gap_m;
  const double x0 = std::floor(at.x()), y0 = std::floor(at.y());
  double least = 1e9, height = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const auto key = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) + (1 << 24)); };
      const std::uint64_t i = key(x0 + dx) << 32 | key(y0 + dy);
      const auto u = [&](std::uint64_t k) { return uniform(seed, Draw::world_decay, i, (std::uint64_t{1} << 40) + k); };
      const Vec2 site(x0 + dx + u(0), y0 + dy + u(1));
      const double d = (at - site).squaredNorm();
      if (d >= least) continue;
      least = d;
      height = 0.3 * (u(2) - 0.5) + (u(3) - 0.5) * (at - site).x() * 0.5 + (u(4) - 0.5) * (at - site).y() * 0.5;
    }
  return height;
}

Decay draw_decay(const WorldSettings& settings, const MinePlan& plan, const Workings& workings, std::uint64_t seed) {
  return Drawer(settings, plan, workings, seed).draw();
}

}  // namespace adit
