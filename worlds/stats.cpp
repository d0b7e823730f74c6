// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/stats.h"

#include "rays/caster.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

// Mean of what a look from the middle of the passage finds to either side of it, away from its junctions.
struct Looks {
  double width = 0, height = 0, n = 0;
};

Looks look_along(const Caster& caster, const Passage& p) {
  Looks looks;
  const double clear_m = 0.5 * p.width_m + 2.5;
  double behind = 0;
  for (size_t i = 1; i + 1 < p.centre_line.size(); ++i) {
    behind += (p.centre_line[i] - p.centre_line[i - 1]).head<2>().norm();
    if (behind < clear_m || p.length_m - behind < clear_m) continue;
    const Vec2 along = (p.centre_line[i + 1] - p.centre_line[i - 1]).head<2>().normalized();
    const Vec3 eye = p.centre_line[i] + Vec3(0, 0, 0.5 * p.height_m), left(-along.y(), along.x(), 0), up(0, 0, 1);
    const auto span = [&](const Vec3& way) {
      return caster.nearest({eye, way, 50}).range_m + caster.nearest({eye, -way, 50}).range_m;
    };
    const double width = span(left), height = span(up);
    if (!std::isfinite(width) || !std::isfinite(height)) continue;
    looks.width += width;
    looks.height += height;
    ++looks.n;
  }
  return looks;
}

// Mean square of how far points (along, off) lie from the straight line that fits them best.
double off_line2(const std::vector<Vec2>& points) {
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : points) middle += p / static_cast<double>(points.size());
  double aa = 0, ao = 0, oo = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p - middle;
    aa += d.x() * d.x(), ao += d.x() * d.y(), oo += d.y() * d.y();
  }
  return std::max(0.0, oo - ao * ao / aa) / static_cast<double>(points.size());
}

// Where the passage's line is `along_m` from its beginning, and its way there.
std::pair<Vec3, Vec2> place_on(const std::vector<Vec3>& line, double along_m) {
  for (size_t i = 1; i < line.size(); ++i) {
    const Vec3 step = line[i] - line[i - 1];
    const double length = step.head<2>().norm();
    if (along_m <= length || i + 1 == line.size())
      return {line[i - 1] + std::min(1.0, along_m / length) * step, step.head<2>().normalized()};
    along_m -= length;
  }
  return {line.front(), Vec2::UnitX()};
}

// Roughness of one side of a passage: what rays square to its line meet, stretch by stretch. NaN where no stretch is plain.
double roughness_m(const Caster& caster, const Passage& p, Label side) {
  constexpr double stretch_m = 4, step_m = 0.1;
  const double clear_m = 0.5 * p.width_m + 2.5;
  double sum = 0;
  int n = 0;
  for (double from = clear_m; from + stretch_m <= p.length_m - clear_m; from += stretch_m) {
    const Vec2 along = place_on(p.centre_line, from + 0.5 * stretch_m).second, left(-along.y(), along.x());
    for (const double sign : {1.0, -1.0}) {
      if (side != Label::rib && sign != (side == Label::roof ? 1.0 : -1.0)) continue;
      const Vec3 way = side == Label::rib ? Vec3(sign * left.x(), sign * left.y(), 0) : Vec3(0, 0, sign);
      std::vector<Vec2> profile;
      for (double s = 0; s < stretch_m - 1e-9; s += step_m) {
        const Vec3 eye = place_on(p.centre_line, from + s).first + Vec3(0, 0, 0.5 * p.height_m);
        const Hit hit = caster.nearest({eye, way, 50});
        if (hit.face < 0 || caster.mesh().label[static_cast<size_t>(hit.face)] != side) break;
        const Vec3 met = eye + hit.range_m * way;
        profile.emplace_back(along.dot(met.head<2>()), way.dot(met));
      }
      if (static_cast<double>(profile.size()) * step_m < stretch_m - 0.5 * step_m) continue;
      sum += off_line2(profile);
      ++n;
    }
  }
  return n ? std::sqrt(sum / n) : std::nan("");
}

}  // namespace

void measure(const World& world, MineSamples& samples) {
  const Caster caster(world.mesh);
  for (const Passage& p : world.passages) {
    samples.length_m.push_back(p.length_m);
    const Vec3 way = p.centre_line.back() - p.centre_line.front();
    if (p.length_m > 5) samples.grade_percent.push_back(100 * std::abs(way.z()) / p.length_m);
    const Looks looks = look_along(caster, p);
    if (looks.n == 0) continue;
    samples.width_m.push_back(looks.width / looks.n);
    samples.height_m.push_back(looks.height / looks.n);
    for (const auto& [side, list] :
         {std::pair(Label::floor, &samples.floor_rough_m), std::pair(Label::roof, &samples.roof_rough_m),
          std::pair(Label::rib, &samples.rib_rough_m)})
      if (const double rough = roughness_m(caster, p, side); std::isfinite(rough)) list->push_back(rough);
  }
  for (const Junction& j : world.junctions) ++samples.junctions[j.degree()];
  for (const Pillar& p : world.pillars) samples.pillar_m2.push_back(p.area_m2);
  samples.extraction.push_back(world.numbers.extraction_ratio);
  double length = 0, blocked = 0;
  for (const Passage& p : world.passages) {
    length += p.length_m;
    if (p.blocked) blocked += p.length_m;
  }
  std::map<Label, int> things;
  for (const MineObject& o : world.objects) ++things[o.label];
  for (const auto& [label, n] : things) samples.per_100m[label].push_back(100 * n / length);
  const double bare = world.numbers.bare_m3;
  samples.blocked_share.push_back(blocked / length);
  samples.bodies_share.push_back(bare > 0 ? 1 - world.numbers.volume_m3 / bare : 0);
}

void append(MineSamples& all, const MineSamples& more) {
  const auto join = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (auto list :
       {&MineSamples::width_m, &MineSamples::height_m, &MineSamples::grade_percent, &MineSamples::length_m,
        &MineSamples::floor_rough_m, &MineSamples::roof_rough_m, &MineSamples::rib_rough_m, &MineSamples::pillar_m2,
        &MineSamples::extraction, &MineSamples::blocked_share, &MineSamples::bodies_share})
    join(all.*list, more.*list);
  for (const auto& [degree, n] : more.junctions) all.junctions[degree] += n;
  for (const auto& [label, values] : more.per_100m) join(all.per_100m[label], values);
}

Spread spread_of(std::vector<double> values) {
  Spread s;
  s.n = values.size();
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  for (double v : values) s.mean += v / static_cast<double>(s.n);
  for (double v : values) s.sd += (v - s.mean) * (v - s.mean);
  s.sd = s.n > 1 ? std::sqrt(s.sd / static_cast<double>(s.n - 1)) : 0;
  const auto at = [&](double share) { return values[static_cast<size_t>(share * static_cast<double>(s.n - 1) + 0.5)]; };
  s.p5 = at(0.05);
  s.p50 = at(0.5);
  s.p95 = at(0.95);
  return s;
}

}  // namespace adit
