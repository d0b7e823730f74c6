// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0 binary container: a JSON chunk and one buffer, written by hand (sections 3.6 and 4.4 of the specification).
#include "base/error.h"
#include "base/files.h"
#include "base/mesh.h"

#include <nlohmann/json.hpp>

#include <cstring>
#include <fstream>

namespace adit {
namespace {

using nlohmann::json;

template <class T>
void put(std::string& out, T v) {
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

std::array<double, 3> colour_of(Label label) {
  switch (label) {
    case Label::floor:
      return {0.42, 0.38, 0.33};
    case Label::roof:
      return {0.55, 0.55, 0.58};
    case Label::rib:
      return {0.66, 0.64, 0.60};
    case Label::cap:
      return {0.75, 0.35, 0.20};
    default:
      return {0.5, 0.5, 0.5};
  }
}

// W has z up, glTF y: (x, y, z) becomes (x, z, -y).
std::array<float, 3> y_up(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.z()), static_cast<float>(-v.y())};
}

class Builder {
 public:
  explicit Builder(const Mesh& mesh) : mesh_(mesh) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "adit"}};
    json_["scene"] = 0;
    json_["scenes"] = json::array({{{"nodes", {0}}}});
    json_["nodes"] = json::array({{{"mesh", 0}, {"name", "mine"}}});
    json_["materials"] = json_["bufferViews"] = json_["accessors"] = json::array();
  }

  std::string build() {
    json primitives = json::array();
    if (!mesh_.face.empty()) {
      const size_t position = add_positions();
      for (const auto& [name, id] : label_ids()) add_primitive(static_cast<Label>(id), name, position, primitives);
    }
    json_["meshes"] = json::array({{{"name", "mine"}, {"primitives", primitives}}});
    if (mesh_.face.empty()) return pack_without_mesh();
    json_["buffers"] = json::array({{{"byteLength", bytes_.size()}}});
    return pack();
  }

 private:
  size_t view(size_t begin, int target) {
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}, {"target", target}});
    return json_["bufferViews"].size() - 1;
  }

  size_t add_positions() {
    std::array<float, 3> low = y_up(mesh_.vertex.front()), high = low;
    const size_t begin = bytes_.size();
    for (const Vec3& v : mesh_.vertex) {
      const auto p = y_up(v);
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
        put(bytes_, p[k]);
      }
    }
    json_["accessors"].push_back({{"bufferView", view(begin, 34962)},
                                  {"componentType", 5126},
                                  {"count", mesh_.vertex.size()},
                                  {"type", "VEC3"},
                                  {"min", low},
                                  {"max", high}});
    return json_["accessors"].size() - 1;
  }

  void add_primitive(Label label, const std::string& name, size_t position, json& primitives) {
    const size_t begin = bytes_.size();
    for (size_t f = 0; f < mesh_.face.size(); ++f) {
      if ((mesh_.label.empty() ? Label::none : mesh_.label[f]) != label) continue;
      for (std::uint32_t v : mesh_.face[f]) put(bytes_, v);
    }
    if (bytes_.size() == begin) return;
    const auto rgb = colour_of(label);
    json_["materials"].push_back(
        {{"name", name},
         {"doubleSided", true},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {rgb[0], rgb[1], rgb[2], 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}}});
    json_["accessors"].push_back({{"bufferView", view(begin, 34963)},
                                  {"componentType", 5125},
                                  {"count", (bytes_.size() - begin) / 4},
                                  {"type", "SCALAR"}});
    primitives.push_back({{"attributes", {{"POSITION", position}}},
                          {"indices", json_["accessors"].size() - 1},
                          {"material", json_["materials"].size() - 1},
                          {"mode", 4}});
  }

  // An empty list is not allowed in glTF: what there is none of is left out.
  std::string pack_without_mesh() {
    for (const char* key : {"meshes", "materials", "bufferViews", "accessors"}) json_.erase(key);
    json_["nodes"] = json::array({{{"name", "mine"}}});
    return pack();
  }

  std::string pack() const {
    std::string text = json_.dump();
    text.append((4 - text.size() % 4) % 4, ' ');
    std::string out;
    const size_t binary = bytes_.empty() ? 0 : 8 + bytes_.size();
    put(out, std::uint32_t{0x46546C67});
    put(out, std::uint32_t{2});
    put(out, static_cast<std::uint32_t>(12 + 8 + text.size() + binary));
    put(out, static_cast<std::uint32_t>(text.size()));
    put(out, std::uint32_t{0x4E4F534A});
    out += text;
    if (bytes_.empty()) return out;
    put(out, static_cast<std::uint32_t>(bytes_.size()));
    put(out, std::uint32_t{0x004E4942});
    return out + bytes_;
  }

  const Mesh& mesh_;
  json json_;
  std::string bytes_;  // floats and indices: a multiple of 4 always
};

}  // namespace

void write_glb(const std::string& file, const Mesh& mesh) {
  write_text(file, Builder(mesh).build());
}

}  // namespace adit
