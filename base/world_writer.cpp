// SPDX-License-Identifier: BSD-3-Clause
#include "base/world_writer.h"

#include "base/error.h"
#include "base/files.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstring>

namespace adit {
namespace {

using nlohmann::json;

json array_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
json array_of(const Vec2& v) {
  return {v.x(), v.y()};
}
template <class V>
json array_of(const std::vector<V>& vectors) {
  json a = json::array();
  for (const V& v : vectors) a.push_back(array_of(v));
  return a;
}

json passage_of(const Passage& p, size_t id) {
  json j = {{"id", id},
            {"a", p.a},
            {"b", p.b},
            {"width_m", p.width_m},
            {"height_m", p.height_m},
            {"length_m", p.length_m},
            {"volume_m3", p.volume_m3},
            {"centre_line", array_of(p.centre_line)}};
  if (p.blocked) j["blocked"] = true;
  return j;
}

json junction_of(const Junction& j, size_t id) {
  return {{"id", id}, {"p_W", array_of(j.p_W)}, {"passages", j.passages}};
}

json pillar_of(const Pillar& p, size_t id) {
  return {{"id", id}, {"area_m2", p.area_m2}, {"outline", array_of(p.outline)}};
}

json object_of(const MineObject& o, size_t id) {
  json j = {{"id", id},
            {"label", label_name(o.label)},
            {"passage", o.passage},
            {"middle_W", array_of(o.middle_W)},
            {"size_m", array_of(o.size_m)},
            {"yaw_rad", o.yaw_rad},
            {"volume_m3", o.volume_m3}};
  if (o.ground) j["ground"] = true;
  if (o.blocks) j["blocks"] = true;
  return j;
}

// A list with one entry a line: readable, and small beside a full indentation. No more than an entry is held.
template <class T, class F>
void put_lines(std::ostream& out, const std::string& key, const std::vector<T>& entries, const F& json_of) {
  out << ",\n  \"" << key << "\": [";
  for (size_t i = 0; i < entries.size(); ++i) out << (i ? ",\n    " : "\n    ") << json_of(entries[i], i).dump();
  out << (entries.empty() ? "]" : "\n  ]");
}

}  // namespace

WorldWriter::WorldWriter(std::string dir) : dir_(std::move(dir)), ply_(dir_ + "/mine.ply"), glb_(dir_ + "/mine.glb") {}

void WorldWriter::add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id) {
  ply_.add(mesh, vertex_id);
  glb_.add(mesh, vertex_id);
  reflects_ = reflects_ || !mesh.reflectivity.empty();
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const double area = mesh.area(f);
    const auto add = [&](Sums& sums) {
      sums.area_m2 += area;
      if (!mesh.reflectivity.empty()) sums.reflected += area * mesh.reflectivity[f];
      if (!mesh.wetness.empty()) sums.wet += area * mesh.wetness[f];
    };
    if (!mesh.label.empty()) add(labels_[mesh.label[f]]);
    if (!mesh.material.empty()) add(rocks_[mesh.material[f]]);
  }
}

void WorldWriter::close(const World& world) {
  ply_.close();
  glb_.close();
  json materials = json::object(), rocks = json::object();
  for (const auto& [label, sum] : labels_) {
    json& m = materials[label_name(label)];
    m["area_m2"] = sum.area_m2;
    if (reflects_ && sum.area_m2 > 0) m["reflectivity_905nm"] = sum.reflected / sum.area_m2;
  }
  for (const auto& [name, id] : material_ids()) {
    const auto found = rocks_.find(static_cast<Material>(id));
    if (found == rocks_.end() || !(found->second.area_m2 > 0)) continue;
    const Sums& sum = found->second;
    rocks[name] = {{"id", id},
                   {"area_m2", sum.area_m2},
                   {"reflectivity_905nm", sum.reflected / sum.area_m2},
                   {"wetness", sum.wet / sum.area_m2}};
  }
  json labels = json::object();  // those of every mine, and those that this one has
  for (const auto& [name, id] : label_ids())
    if (id <= static_cast<int>(Label::pusher) || labels_.contains(static_cast<Label>(id))) labels[name] = id;
  const WorldNumbers& n = world.numbers;
  write_whole(dir_ + "/truth.json", [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << "{\n  \"name\": " << json(world.name).dump();
    const auto put = [&](const char* key, const json& value) { out << ",\n  \"" << key << "\": " << value.dump(); };
    put("volume_m3", n.volume_m3);
    if (n.bare_m3 > 0) put("bare_volume_m3", n.bare_m3);
    put("floor_area_m2", n.floor_area_m2);
    put("extraction_ratio", n.extraction_ratio);
    put("loops", n.loops);
    put("labels", labels);
    put("materials", materials);
    put("rocks", rocks);
    put("cycles", cycle_basis(world));
    put("outline", array_of(world.outline));
    if (!world.left_out.empty()) {
      json left_out = json::object();
      for (const auto& [label, things] : world.left_out) left_out[label_name(label)] = things;
      put("left_out", left_out);
    }
    put_lines(out, "junctions", world.junctions, junction_of);
    put_lines(out, "passages", world.passages, passage_of);
    put_lines(out, "pillars", world.pillars, pillar_of);
    if (!world.objects.empty()) put_lines(out, "objects", world.objects, object_of);
    out << "\n}\n";
    out.close();
    if (!out) throw Error(dir_ + "/truth.json: cannot write: " + std::strerror(errno), Fault::file);
  });
}

}  // namespace adit
