// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"
#include "base/error.h"
#include "base/files.h"
#include "worlds/plan.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace adit {
namespace {

using nlohmann::json;

struct PlanText {
  std::string name, text;
};

PlanText text_of(const std::string& plan) {
  if (plan.ends_with(".json") || plan.find('/') != std::string::npos) return {plan, read_text(plan)};
  const std::string path = "worlds/plans/" + plan + ".json";
  const std::string_view text = bundled(path);
  if (!text.empty()) return {path, std::string(text)};
  std::string known;
  for (const std::string& name : bundled_names("worlds/plans")) known += (known.empty() ? "" : ", ") + name;
  throw Error("world.plan = \"" + plan + "\": no bundled plan has this name (there are: " + known +
              "); a file's name ends in .json or .geojson");
}

struct Box2 {
  double x_min, x_max, y_min, y_max;
  bool holds(const Vec2& p) const { return p.x() > x_min && p.x() < x_max && p.y() > y_min && p.y() < y_max; }
  // Share of the way from p (inside) to q (outside) at which the border lies.
  double leaves(const Vec2& p, const Vec2& q) const {
    double s = 1;
    const Vec2 d = q - p;
    if (q.x() >= x_max) s = std::min(s, (x_max - p.x()) / d.x());
    if (q.x() <= x_min) s = std::min(s, (x_min - p.x()) / d.x());
    if (q.y() >= y_max) s = std::min(s, (y_max - p.y()) / d.y());
    if (q.y() <= y_min) s = std::min(s, (y_min - p.y()) / d.y());
    return s;
  }
};

std::map<int, Vec2> nodes_of(const std::string& name, const json& plan) {
  std::map<int, Vec2> nodes;
  for (const json& n : plan.at("nodes")) {
    const int id = n.at("id").get<int>();
    if (!nodes.emplace(id, Vec2(n.at("x_m").get<double>(), n.at("y_m").get<double>())).second)
      throw Error(name + ": two nodes have the id " + std::to_string(id));
  }
  return nodes;
}

PlanPassage passage_of(const std::string& name, const json& edge, const std::map<int, Vec2>& nodes, double scale) {
  PlanPassage p{edge.at("a").get<int>(), edge.at("b").get<int>(), scale * edge.at("width_m").get<double>(), {}};
  const std::string which = name + ": the passage from node " + std::to_string(p.a) + " to " + std::to_string(p.b);
  for (int id : {p.a, p.b})
    if (!nodes.contains(id)) throw Error(which + " names a node that is not there");
  if (!(p.width_m >= 1.5 && p.width_m <= 12))
    throw Error(which + " has width_m = " + edge.at("width_m").dump() + "; 1.5 to 12 m can be made");
  p.line.push_back(nodes.at(p.a));
  if (edge.contains("via"))
    for (const json& v : edge["via"]) p.line.emplace_back(v.at(0).get<double>(), v.at(1).get<double>());
  p.line.push_back(nodes.at(p.b));
  for (size_t i = 1; i < p.line.size(); ++i)
    if (!((p.line[i] - p.line[i - 1]).norm() > 0.1)) throw Error(which + " has two points in the same place");
  return p;
}

double length_of(const std::vector<Vec2>& line) {
  double length = 0;
  for (size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

// What of a line that begins inside lies before the border.
std::vector<Vec2> clipped(const std::vector<Vec2>& line, const Box2& box) {
  std::vector<Vec2> kept{line.front()};
  for (size_t i = 1; i < line.size(); ++i) {
    if (box.holds(line[i])) {
      kept.push_back(line[i]);
      continue;
    }
    const double s = box.leaves(line[i - 1], line[i]);
    if (s > 1e-9) kept.push_back(line[i - 1] + s * (line[i] - line[i - 1]));
    break;
  }
  return kept;
}

// Numbers nodes as they come, in the order of their ids; passages that leave the box end at its border.
class Selection {
 public:
  Selection(const std::map<int, Vec2>& nodes, const Box2& box) : box_(box) {
    for (const auto& [id, p] : nodes)
      if (box.holds(p)) inside_.emplace(id, p);
  }

  void add(PlanPassage p) {
    const bool a_in = inside_.contains(p.a), b_in = inside_.contains(p.b);
    if (!a_in && !b_in) return;
    if (!a_in) {
      std::swap(p.a, p.b);
      std::reverse(p.line.begin(), p.line.end());
    }
    if (!(a_in && b_in)) {
      p.line = clipped(p.line, box_);
      if (length_of(p.line) < 1.5 * p.width_m) return;  // no more than the junction itself
    }
    p.a = number(p.a);
    p.b = a_in && b_in ? number(p.b) : new_node(p.line.back(), 1);
    plan_.passages.push_back(std::move(p));
  }

  MinePlan take() { return std::move(plan_); }

 private:
  int new_node(const Vec2& p, char cut) {
    plan_.nodes.push_back(p);
    plan_.cut.push_back(cut);
    return static_cast<int>(plan_.nodes.size()) - 1;
  }
  int number(int id) {
    const auto known = number_.find(id);
    if (known != number_.end()) return known->second;
    return number_[id] = new_node(inside_.at(id), 0);
  }

  Box2 box_;
  std::map<int, Vec2> inside_;
  std::map<int, int> number_;
  MinePlan plan_;
};

}  // namespace

MinePlan read_plan(const WorldSettings& s) {
  if (s.x_min >= s.x_max || s.y_min >= s.y_max)
    throw Error(
        "world.x_min, x_max, y_min, y_max: the part selected is empty; each minimum must lie below its maximum");
  const PlanText source = text_of(s.plan);
  try {
    const json text = json::parse(source.text);
    const std::map<int, Vec2> nodes = nodes_of(source.name, text);
    Selection selection(nodes, {s.x_min, s.x_max, s.y_min, s.y_max});
    for (const json& edge : text.at("edges")) {
      PlanPassage p = passage_of(source.name, edge, nodes, s.width_scale);
      if (edge.value("open", true) || s.passages == "all") selection.add(std::move(p));
    }
    return selection.take();
  } catch (const json::exception& e) {
    throw Error(source.name +
                ": not a plan ({\"nodes\": [{id, x_m, y_m}], \"edges\": [{a, b, width_m}]}): " + e.what());
  }
}

}  // namespace adit
