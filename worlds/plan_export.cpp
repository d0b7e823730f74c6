// SPDX-License-Identifier: BSD-3-Clause
#include "base/dxf.h"
#include "base/files.h"
#include "base/grid.h"
#include "worlds/worlds.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

constexpr double grid_cell_m = 0.1;
constexpr double most_cells = 4e7;
constexpr double margin_m = 2;

using nlohmann::json;
using Ring = std::vector<Vec2>;

std::string mm(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f", v);
  return text;
}

struct Bounds {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
};

std::vector<Ring> rings_of(const World& world) {
  std::vector<Ring> rings{world.outline};
  for (const Pillar& p : world.pillars) rings.push_back(p.outline);
  return rings;
}

Bounds bounds_of(const World& world) {
  Bounds b;
  for (const Vec2& p : world.outline) {
    b.low = b.low.cwiseMin(p);
    b.high = b.high.cwiseMax(p);
  }
  b.low.array() -= margin_m;
  b.high.array() += margin_m;
  return b;
}

Ring flat(const std::vector<Vec3>& line) {
  Ring ring;
  for (const Vec3& v : line) ring.push_back(v.head<2>());
  return ring;
}

// SVG: a unit is a metre, y down.
std::string svg_points(const Ring& ring) {
  std::string text;
  for (const Vec2& p : ring) text += (text.empty() ? "" : " ") + mm(p.x()) + "," + mm(-p.y());
  return text;
}

std::string svg_of(const World& world) {
  const Bounds b = bounds_of(world);
  const Vec2 size = b.high - b.low;
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + mm(size.x()) + "mm\" height=\"" +
                     mm(size.y()) + "mm\" viewBox=\"" + mm(b.low.x()) + " " + mm(-b.high.y()) + " " + mm(size.x()) +
                     " " + mm(size.y()) + "\">\n<title>plan, 1:1000</title>\n";
  text += "<g id=\"void\" fill=\"#fbfbfa\" stroke=\"#6d6a65\" stroke-width=\"0.15\"><polygon points=\"" +
          svg_points(world.outline) +
          "\"/></g>\n<g id=\"pillars\" fill=\"#d3d0ca\" stroke=\"#6d6a65\" "
          "stroke-width=\"0.15\">\n";
  for (size_t i = 0; i < world.pillars.size(); ++i)
    text +=
        "<polygon id=\"pillar-" + std::to_string(i) + "\" points=\"" + svg_points(world.pillars[i].outline) + "\"/>\n";
  text += "</g>\n<g id=\"centre-lines\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"0.2\">\n";
  for (size_t i = 0; i < world.passages.size(); ++i)
    text += "<polyline id=\"passage-" + std::to_string(i) + "\" points=\"" +
            svg_points(flat(world.passages[i].centre_line)) + "\"/>\n";
  text += "</g>\n<g id=\"junctions\" fill=\"#d55e00\">\n";
  for (size_t i = 0; i < world.junctions.size(); ++i)
    text += "<circle id=\"junction-" + std::to_string(i) + "\" cx=\"" + mm(world.junctions[i].p_W.x()) + "\" cy=\"" +
            mm(-world.junctions[i].p_W.y()) + "\" r=\"0.5\"/>\n";
  return text + "</g>\n</svg>\n";
}

std::string dxf_of(const World& world) {
  Dxf dxf;
  dxf.polyline("VOID", world.outline, true);
  for (const Pillar& p : world.pillars) dxf.polyline("PILLARS", p.outline, true);
  for (const Passage& p : world.passages) dxf.polyline("CENTRE_LINES", flat(p.centre_line), false);
  for (const Junction& j : world.junctions) dxf.point("JUNCTIONS", j.p_W.head<2>());
  return dxf.text();
}

double to_mm(double v) {
  return std::round(v * 1000) / 1000;
}

json ring_json(const Ring& ring, bool close) {
  json points = json::array();
  for (const Vec2& p : ring) points.push_back({to_mm(p.x()), to_mm(p.y())});
  if (close && !ring.empty()) points.push_back(points.front());
  return points;
}

json feature(json properties, const std::string& type, json coordinates) {
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry", {{"type", type}, {"coordinates", std::move(coordinates)}}}};
}

std::string geojson_of(const World& world) {
  std::string text = "{\"type\": \"FeatureCollection\", \"features\": [";
  bool first = true;
  const auto add = [&](const json& f) {  // one by one: values take ten times the room of their text
    text += (first ? "\n" : ",\n") + f.dump();
    first = false;
  };
  json rings = json::array({ring_json(world.outline, true)});
  for (const Pillar& p : world.pillars) {
    Ring hole(p.outline.rbegin(), p.outline.rend());  // RFC 7946: holes run clockwise
    rings.push_back(ring_json(hole, true));
  }
  add(feature({{"kind", "void"}, {"area_m2", world.numbers.floor_area_m2}}, "Polygon", std::move(rings)));
  for (size_t i = 0; i < world.pillars.size(); ++i)
    add(feature({{"kind", "pillar"}, {"id", i}, {"area_m2", world.pillars[i].area_m2}}, "Polygon",
                json::array({ring_json(world.pillars[i].outline, true)})));
  for (size_t i = 0; i < world.passages.size(); ++i) {
    const Passage& p = world.passages[i];
    add(feature({{"kind", "passage"},
                 {"id", i},
                 {"a", p.a},
                 {"b", p.b},
                 {"width_m", p.width_m},
                 {"height_m", p.height_m},
                 {"length_m", p.length_m},
                 {"volume_m3", p.volume_m3}},
                "LineString", ring_json(flat(p.centre_line), false)));
  }
  for (size_t i = 0; i < world.junctions.size(); ++i) {
    const Vec3& p = world.junctions[i].p_W;
    add(feature({{"kind", "junction"}, {"id", i}, {"degree", world.junctions[i].degree()}}, "Point",
                {to_mm(p.x()), to_mm(p.y()), to_mm(p.z())}));
  }
  return text + "\n]}\n";
}

// Where a row at height y crosses the rings, from left to right: the void lies between every second pair.
std::vector<double> crossings(const std::vector<Ring>& rings, double y) {
  std::vector<double> x;
  for (const Ring& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if ((a.y() > y) != (b.y() > y)) x.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
  }
  std::sort(x.begin(), x.end());
  return x;
}

Grid grid_of(const World& world) {
  const Bounds b = bounds_of(world);
  Grid grid;
  grid.cell_m = grid_cell_m;
  while ((b.high - b.low).prod() / (grid.cell_m * grid.cell_m) > most_cells) grid.cell_m *= 2;
  grid.origin = (b.low / grid.cell_m).array().floor().matrix() * grid.cell_m;
  grid.width = static_cast<int>(std::ceil((b.high.x() - grid.origin.x()) / grid.cell_m));
  grid.height = static_cast<int>(std::ceil((b.high.y() - grid.origin.y()) / grid.cell_m));
  grid.log_odds.assign(static_cast<size_t>(grid.width) * grid.height, 0.0f);
  const std::vector<Ring> rings = rings_of(world);
  for (int j = 0; j < grid.height; ++j) {
    const std::vector<double> x = crossings(rings, grid.centre(0, j).y());
    for (size_t k = 0; k + 1 < x.size(); k += 2)
      for (int i = std::max(0, static_cast<int>(std::ceil((x[k] - grid.origin.x()) / grid.cell_m - 0.5)));
           i < grid.width && grid.centre(i, j).x() < x[k + 1]; ++i)
        grid.log_odds[grid.index(i, j)] = -4;
  }
  for (const Ring& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &p = ring[i], &q = ring[(i + 1) % ring.size()];
      const int n = std::max(1, static_cast<int>(std::ceil(2 * (q - p).norm() / grid.cell_m)));
      for (int k = 0; k <= n; ++k) {
        const Vec2 at = (p + (q - p) * k / n - grid.origin) / grid.cell_m;
        grid.log_odds[grid.index(static_cast<int>(at.x()), static_cast<int>(at.y()))] = 4;
      }
    }
  }
  return grid;
}

}  // namespace

void save_plan(const std::string& dir, const World& world) {
  if (world.outline.empty()) return;
  write_text(dir + "/plan.svg", svg_of(world));
  write_text(dir + "/plan.dxf", dxf_of(world));
  write_text(dir + "/plan.geojson", geojson_of(world));
  write_grid(dir + "/plan.pgm", grid_of(world));
}

}  // namespace adit
