// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/polygons.h"

#include "base/error.h"
#include "base/files.h"
#include "worlds/ogr.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double largest_m = 30000, least_ring_m2 = 0.01;

using nlohmann::json;

std::string place(const Vec2& p) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.1f, %.1f)", p.x(), p.y());
  return text;
}

Loop ring_of(const json& points, const std::string& where) {
  Loop ring;
  for (const json& p : points) {
    const Vec2 q(p.at(0).get<double>(), p.at(1).get<double>());
    if (!q.allFinite()) throw Error(where + " has a point that is not finite");
    if (ring.empty() || (q - ring.back()).norm() > 1e-6) ring.push_back(q);
  }
  if (ring.size() > 1 && (ring.front() - ring.back()).norm() < 1e-6) ring.pop_back();
  if (ring.size() < 3) throw Error(where + " has fewer than three points");
  return ring;
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

struct Piece {
  Vec2 a, b;
  size_t ring, index, of;
  double low() const { return std::min(a.x(), b.x()); }
  double high() const { return std::max(a.x(), b.x()); }
};

bool follow_each_other(const Piece& p, const Piece& q) {
  if (p.ring != q.ring) return false;
  const size_t apart = p.index > q.index ? p.index - q.index : q.index - p.index;
  return apart == 1 || apart + 1 == p.of;
}

bool pieces_cross(const Piece& p, const Piece& q) {
  const Vec2 u = p.b - p.a, v = q.b - q.a;
  const double a = cross(u, q.a - p.a), b = cross(u, q.b - p.a), c = cross(v, p.a - q.a), d = cross(v, p.b - q.a);
  return a * b < 0 && c * d < 0;
}

// Sweeps from left to right: only pieces whose spans in x meet are compared.
void check_crossings(const Polygon& polygon, const std::string& where) {
  std::vector<Piece> pieces;
  for (size_t r = 0; r < polygon.size(); ++r)
    for (size_t i = 0; i < polygon[r].size(); ++i)
      pieces.push_back({polygon[r][i], polygon[r][(i + 1) % polygon[r].size()], r, i, polygon[r].size()});
  std::sort(pieces.begin(), pieces.end(), [](const Piece& p, const Piece& q) { return p.low() < q.low(); });
  for (size_t i = 0; i < pieces.size(); ++i) {
    for (size_t j = i + 1; j < pieces.size() && pieces[j].low() <= pieces[i].high(); ++j) {
      const Piece &p = pieces[i], &q = pieces[j];
      if (follow_each_other(p, q) || !pieces_cross(p, q)) continue;
      const std::string rings = p.ring == q.ring ? "ring " + std::to_string(p.ring) + " crosses itself"
                                                 : "rings " + std::to_string(std::min(p.ring, q.ring)) + " and " +
                                                       std::to_string(std::max(p.ring, q.ring)) + " cross";
      throw Error(where + ": " + rings + " near " + place(0.5 * (p.a + p.b)));
    }
  }
}

void check_size(const std::vector<Polygon>& polygons, const std::string& file) {
  Vec2 low(1e300, 1e300), high(-1e300, -1e300);
  for (const Polygon& polygon : polygons) {
    for (const Vec2& p : polygon[0]) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const double size = (high - low).maxCoeff();
  if (size > largest_m)
    throw Error(file + ": the plan spans " + std::to_string(std::lround(size / 1000)) + " km; at most " +
                std::to_string(std::lround(largest_m / 1000)) + " km can be made, and coordinates are metres");
  if (size < 5)
    throw Error(file + ": the plan spans " + std::to_string(size) +
                " m; coordinates must be metres, not degrees (ogr2ogr -t_srs turns them)");
}

Polygon polygon_of(const json& rings, const std::string& where) {
  Polygon polygon;
  for (const json& ring : rings) polygon.push_back(ring_of(ring, where + ": ring " + std::to_string(polygon.size())));
  if (polygon.empty()) throw Error(where + " has no ring");
  check_crossings(polygon, where);
  for (size_t r = 0; r < polygon.size(); ++r)
    if (std::abs(enclosed_area(polygon[r])) < least_ring_m2)
      throw Error(where + ": ring " + std::to_string(r) + " encloses no area");
  return polygon;
}

void add_geometry(const json& geometry, const std::string& where, std::vector<Polygon>& polygons) {
  const std::string type = geometry.at("type").get<std::string>();
  if (type == "Polygon") polygons.push_back(polygon_of(geometry.at("coordinates"), where));
  if (type == "MultiPolygon")
    for (const json& rings : geometry.at("coordinates")) polygons.push_back(polygon_of(rings, where));
}

}  // namespace

bool names_polygons(const std::string& plan) {
  const size_t dot = plan.find_last_of("./");
  return dot != std::string::npos && plan[dot] == '.' && plan.substr(dot) != ".json";
}

std::vector<Polygon> read_polygons(const std::string& file) {
  std::vector<Polygon> polygons;
  try {
    const json text = json::parse(file.ends_with(".geojson") ? read_text(file) : as_geojson(file));
    const std::string type = text.at("type").get<std::string>();
    if (type != "FeatureCollection") {
      add_geometry(type == "Feature" ? text.at("geometry") : text, file, polygons);
    } else {
      size_t number = 0;
      for (const json& feature : text.at("features")) {
        const std::string where = file + ": feature " + std::to_string(number++);
        const json properties = feature.value("properties", json::object());
        const bool is_void = !properties.is_object() || properties.value("kind", "void") == "void";
        if (is_void && feature.at("geometry").is_object()) add_geometry(feature["geometry"], where, polygons);
      }
    }
  } catch (const json::exception& e) {
    throw Error(file + ": not GeoJSON of polygons: " + e.what());
  }
  if (polygons.empty()) throw Error(file + ": has no Polygon or MultiPolygon that is the void of a mine");
  check_size(polygons, file);
  return polygons;
}

}  // namespace adit
