// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0 binary container: a JSON chunk and one buffer, written by hand (sections 3.6 and 4.4 of the specification).
#include "base/error.h"
#include "base/files.h"
#include "base/mesh_writer.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

namespace adit {
namespace {

using nlohmann::json;

template <class T>
void put(std::ostream& out, T v) {
  out.write(reinterpret_cast<const char*>(&v), sizeof v);
}

// W has z up, glTF y: (x, y, z) becomes (x, z, -y).
std::array<float, 3> y_up(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.z()), static_cast<float>(-v.y())};
}

// The buffer's views, one after the other, and what describes them.
class Contents {
 public:
  Contents() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "adit"}};
    json_["scene"] = 0;
    json_["scenes"] = json::array({{{"nodes", {0}}}});
    json_["nodes"] = json::array({{{"mesh", 0}, {"name", "mine"}}});
    json_["materials"] = json_["bufferViews"] = json_["accessors"] = json::array();
  }

  void add_positions(std::uint64_t bytes, const std::array<float, 3>& low, const std::array<float, 3>& high) {
    json_["accessors"].push_back({{"bufferView", view(bytes, 34962)},
                                  {"componentType", 5126},
                                  {"count", bytes / 12},
                                  {"type", "VEC3"},
                                  {"min", low},
                                  {"max", high}});
  }

  void add_primitive(const std::string& name, const std::array<double, 3>& rgb, std::uint64_t bytes) {
    json_["materials"].push_back(
        {{"name", name},
         {"doubleSided", true},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {rgb[0], rgb[1], rgb[2], 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}}});
    json_["accessors"].push_back(
        {{"bufferView", view(bytes, 34963)}, {"componentType", 5125}, {"count", bytes / 4}, {"type", "SCALAR"}});
    primitives_.push_back({{"attributes", {{"POSITION", 0}}},
                           {"indices", json_["accessors"].size() - 1},
                           {"material", json_["materials"].size() - 1},
                           {"mode", 4}});
  }

  // An empty list is not allowed in glTF: what there is none of is left out.
  std::string text() {
    if (bytes_ > 0) {
      json_["meshes"] = json::array({{{"name", "mine"}, {"primitives", primitives_}}});
      json_["buffers"] = json::array({{{"byteLength", bytes_}}});
    } else {
      for (const char* key : {"materials", "bufferViews", "accessors"}) json_.erase(key);
      json_["nodes"] = json::array({{{"name", "mine"}}});
    }
    std::string text = json_.dump();
    text.append((4 - text.size() % 4) % 4, ' ');
    return text;
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  size_t view(std::uint64_t bytes, int target) {
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", bytes}, {"target", target}});
    bytes_ += bytes;
    return json_["bufferViews"].size() - 1;
  }

  json json_, primitives_ = json::array();
  std::uint64_t bytes_ = 0;  // floats and indices: a multiple of 4 always
};

}  // namespace

std::array<double, 3> label_colour(Label label) {
  switch (label) {
    case Label::floor:
      return {0.42, 0.38, 0.33};
    case Label::roof:
      return {0.55, 0.55, 0.58};
    case Label::rib:
      return {0.66, 0.64, 0.60};
    case Label::cap:
      return {0.75, 0.35, 0.20};
    case Label::cavity:
    case Label::scar:
      return {0.30, 0.27, 0.26};
    case Label::rubble:
    case Label::talus:
    case Label::block:
      return {0.35, 0.33, 0.32};
    case Label::post:
    case Label::crossbar:
    case Label::crib:
    case Label::tie:
    case Label::beam:
      return {0.55, 0.38, 0.20};
    case Label::bolt:
    case Label::rail:
    case Label::pipe:
    case Label::car:
      return {0.45, 0.25, 0.18};
    case Label::water:
      return {0.15, 0.30, 0.40};
    case Label::sludge:
      return {0.80, 0.55, 0.15};
    case Label::cable:
    case Label::belt:
      return {0.12, 0.12, 0.13};
    case Label::stopping:
      return {0.70, 0.70, 0.68};
    case Label::door:
      return {0.75, 0.15, 0.12};
    default:
      return {0.5, 0.5, 0.5};
  }
}

GlbWriter::GlbWriter(std::string file) : file_(std::move(file)), positions_(file_, "positions") {}

void GlbWriter::add(const Mesh& m, const std::vector<std::uint32_t>& vertex_id) {
  for (size_t v = 0; v < m.vertex.size(); ++v) {
    if (vertex_id[v] != vertex_count_) continue;
    const auto p = y_up(m.vertex[v]);
    if (vertex_count_++ == 0) low_ = high_ = p;
    for (int k = 0; k < 3; ++k) {
      low_[k] = std::min(low_[k], p[k]);
      high_[k] = std::max(high_[k], p[k]);
      positions_.put(p[k]);
    }
  }
  for (size_t f = 0; f < m.face.size(); ++f) {
    const Label label = m.label.empty() ? Label::none : m.label[f];
    auto& spool = indices_[label];
    if (!spool) spool = std::make_unique<Spool>(file_, label_name(label));
    for (std::uint32_t v : m.face[f]) spool->put(vertex_id[v]);
  }
}

void GlbWriter::close() {
  Contents contents;
  std::vector<Spool*> buffer;
  if (!indices_.empty()) {
    contents.add_positions(positions_.bytes(), low_, high_);
    buffer.push_back(&positions_);
    for (const auto& [name, id] : label_ids()) {
      const auto found = indices_.find(static_cast<Label>(id));
      if (found == indices_.end()) continue;
      contents.add_primitive(name, label_colour(found->first), found->second->bytes());
      buffer.push_back(found->second.get());
    }
  }
  const std::string text = contents.text();
  const std::uint64_t total = 12 + 8 + text.size() + (contents.bytes() > 0 ? 8 + contents.bytes() : 0);
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error(file_ + ": the mesh is too large for one glTF file, which holds 4 GiB; raise world.mesh_edge_m");
  write_whole(file_, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    put(out, std::uint32_t{0x46546C67});
    put(out, std::uint32_t{2});
    put(out, static_cast<std::uint32_t>(total));
    put(out, static_cast<std::uint32_t>(text.size()));
    put(out, std::uint32_t{0x4E4F534A});
    out << text;
    if (contents.bytes() > 0) {
      put(out, static_cast<std::uint32_t>(contents.bytes()));
      put(out, std::uint32_t{0x004E4942});
    }
    for (Spool* spool : buffer) spool->copy_to(out);
    out.close();
    if (!out) throw Error(file_ + ": cannot write: " + std::strerror(errno), Fault::file);
  });
}

void write_glb(const std::string& file, const Mesh& mesh) {
  GlbWriter out(file);
  out.add(mesh, all_vertices(mesh));
  out.close();
}

}  // namespace adit
