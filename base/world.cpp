// SPDX-License-Identifier: BSD-3-Clause
#include "base/world.h"

#include "base/error.h"
#include "base/files.h"
#include "base/world_writer.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstring>
#include <map>

namespace adit {
namespace {

using nlohmann::json;

// Reads 8 bytes at a time; each word is stirred as in splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
class Digest {
 public:
  void add(std::uint64_t word) {
    std::uint64_t x = state_ ^ word;
    x += 0x9E3779B97F4A7C15;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EB;
    state_ = x ^ (x >> 31);
  }
  void add(double v) {
    std::uint64_t word;
    std::memcpy(&word, &v, sizeof word);
    add(word);
  }
  std::string hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(state_));
    return text;
  }

 private:
  std::uint64_t state_ = 0x61646974;
};

Vec3 vec3_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}
Vec2 vec2_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>()};
}

Passage passage_of(const json& j) {
  Passage p{j.at("a").get<int>(),          j.at("b").get<int>(),           {},
            j.at("width_m").get<double>(), j.at("height_m").get<double>(), j.at("length_m").get<double>(),
            j.value("volume_m3", 0.0),     j.value("blocked", false)};
  for (const json& v : j.at("centre_line")) p.centre_line.push_back(vec3_of(v));
  return p;
}

Pillar pillar_of(const json& j) {
  Pillar p{{}, j.at("area_m2").get<double>()};
  for (const json& v : j.at("outline")) p.outline.push_back(vec2_of(v));
  return p;
}

MineObject object_of(const json& j) {
  const auto label = label_ids().find(j.at("label").get<std::string>());
  if (label == label_ids().end()) throw Error("an object has the unknown label " + j.at("label").dump());
  return {static_cast<Label>(label->second), j.at("passage").get<int>(),    vec3_of(j.at("middle_W")),
          vec3_of(j.at("size_m")),           j.at("yaw_rad").get<double>(), j.at("volume_m3").get<double>(),
          j.value("ground", false),          j.value("blocks", false)};
}

void read_truth(const json& j, World& world) {
  world.name = j.at("name").get<std::string>();
  world.numbers = {j.at("volume_m3").get<double>(), j.at("floor_area_m2").get<double>(),
                   j.at("extraction_ratio").get<double>(), j.at("loops").get<int>(), j.value("bare_volume_m3", 0.0)};
  for (const json& v : j.at("junctions"))
    world.junctions.push_back({vec3_of(v.at("p_W")), v.at("passages").get<std::vector<int>>()});
  for (const json& v : j.at("passages")) world.passages.push_back(passage_of(v));
  for (const json& v : j.at("pillars")) world.pillars.push_back(pillar_of(v));
  if (j.contains("objects"))
    for (const json& v : j["objects"]) world.objects.push_back(object_of(v));
  if (j.contains("left_out"))
    for (const auto& [label, n] : j["left_out"].items())
      if (const auto found = label_ids().find(label); found != label_ids().end())
        world.left_out[static_cast<Label>(found->second)] = n.get<int>();
  if (j.contains("outline"))
    for (const json& v : j["outline"]) world.outline.push_back(vec2_of(v));
}

void check_graph(const std::string& file, const World& world) {
  const int junctions = static_cast<int>(world.junctions.size()), passages = static_cast<int>(world.passages.size());
  for (const Passage& p : world.passages)
    if (std::min(p.a, p.b) < 0 || std::max(p.a, p.b) >= junctions || p.centre_line.size() < 2)
      throw Error(file + ": a passage names a junction that is not there, or has no centre line");
  for (const Junction& j : world.junctions)
    for (int id : j.passages)
      if (id < 0 || id >= passages)
        throw Error(file + ": a junction names passage " + std::to_string(id) + ", which is not there");
}

}  // namespace

// Each passage that a tree from the lowest junction leaves out closes one cycle through the tree.
std::vector<std::vector<int>> cycle_basis(const World& world) {
  const size_t n = world.junctions.size();
  std::vector<int> parent(n, -1), by(n, -1), depth(n, -1), order;
  for (size_t root = 0; root < n; ++root) {
    if (depth[root] >= 0) continue;
    depth[root] = 0;
    order.push_back(static_cast<int>(root));
    for (size_t k = order.size() - 1; k < order.size(); ++k) {
      for (int id : world.junctions[order[k]].passages) {
        const Passage& p = world.passages[id];
        const int next = p.a == order[k] ? p.b : p.a;
        if (depth[next] >= 0) continue;
        depth[next] = depth[order[k]] + 1;
        parent[next] = order[k];
        by[next] = id;
        order.push_back(next);
      }
    }
  }
  std::vector<std::vector<int>> cycles;
  for (size_t i = 0; i < world.passages.size(); ++i) {
    int a = world.passages[i].a, b = world.passages[i].b;
    if (by[a] == static_cast<int>(i) || by[b] == static_cast<int>(i)) continue;
    std::vector<int> down, up;  // from b back to where both ways meet, and from a
    while (a != b) {
      if (depth[b] >= depth[a]) {
        down.push_back(by[b]);
        b = parent[b];
      } else {
        up.push_back(by[a]);
        a = parent[a];
      }
    }
    std::vector<int> cycle{static_cast<int>(i)};
    cycle.insert(cycle.end(), down.begin(), down.end());
    cycle.insert(cycle.end(), up.rbegin(), up.rend());
    cycles.push_back(std::move(cycle));
  }
  return cycles;
}

Mesh floor_of(const World& world) {
  const Mesh& mesh = world.mesh;
  Mesh floor;
  std::vector<std::int64_t> new_index(mesh.vertex.size(), -1);
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    if (mesh.label.size() <= f || !is_ground(mesh.label[f])) continue;
    std::array<std::uint32_t, 3> face;
    for (int k = 0; k < 3; ++k) {
      std::int64_t& index = new_index[mesh.face[f][k]];
      if (index < 0) {
        index = static_cast<std::int64_t>(floor.vertex.size());
        floor.vertex.push_back(mesh.corner(f, k));
      }
      face[k] = static_cast<std::uint32_t>(index);
    }
    floor.face.push_back(face);
    floor.label.push_back(mesh.label[f]);
    if (!mesh.part.empty()) floor.part.push_back(mesh.part[f]);
    if (!mesh.reflectivity.empty()) floor.reflectivity.push_back(mesh.reflectivity[f]);
  }
  return floor;
}

std::string world_hash(const World& world) {
  Digest digest;
  for (const Vec3& v : world.mesh.vertex)
    for (int k = 0; k < 3; ++k) digest.add(v[k]);
  for (const auto& f : world.mesh.face)
    for (std::uint32_t v : f) digest.add(std::uint64_t{v});
  for (Label l : world.mesh.label) digest.add(static_cast<std::uint64_t>(l));
  for (int p : world.mesh.part) digest.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(p)));
  for (float r : world.mesh.reflectivity) digest.add(static_cast<double>(r));
  for (float w : world.mesh.wetness) digest.add(static_cast<double>(w));
  const WorldNumbers& n = world.numbers;
  for (double v : {n.volume_m3, n.floor_area_m2, n.extraction_ratio}) digest.add(v);
  digest.add(static_cast<std::uint64_t>(n.loops));
  return digest.hex();
}

void save_world(const std::string& dir, const World& world) {
  WorldWriter out(dir);
  out.add(world.mesh, all_vertices(world.mesh));
  out.close(world);
}

World load_world(const std::string& dir) {
  const std::string file = dir + "/truth.json";
  World world;
  try {
    read_truth(json::parse(read_text(file)), world);
  } catch (const json::exception& e) {
    throw Error(file + ": not a world's truth: " + e.what());
  }
  check_graph(file, world);
  world.mesh = read_mesh(dir + "/mine.ply");
  return world;
}

}  // namespace adit
