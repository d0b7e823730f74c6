// SPDX-License-Identifier: BSD-3-Clause
#include "base/mine_export.h"

#include "base/files.h"
#include "base/mesh_writer.h"
#include "base/rng.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::uint64_t cloud_address = std::uint64_t{1} << 60;

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", v);
  return text;
}

Label label_at(const Mesh& mesh, size_t f) {
  return mesh.label.empty() ? Label::none : mesh.label[f];
}

// The group of a face: its label, and of a thing its number besides.
std::string group_of(const Mesh& mesh, size_t f) {
  const Label label = label_at(mesh, f);
  const bool thing = is_numbered(label) && f < mesh.part.size();
  return label_name(label) + (thing ? "_" + std::to_string(mesh.part[f]) : "");
}

template <class T>
void put(std::string& out, T v) {
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

}  // namespace

void write_obj(const std::string& file, const World& world, bool inward) {
  const Mesh& mesh = world.mesh;
  const std::string materials = fs::path(file).stem().string() + ".mtl";
  std::map<std::string, std::vector<size_t>> groups;
  std::set<Label> labels;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    groups[group_of(mesh, f)].push_back(f);
    labels.insert(label_at(mesh, f));
  }
  std::string text = "# adit: " + world.name + "\nmtllib " + materials + "\n";
  for (const Vec3& v : mesh.vertex) text += "v " + number(v.x()) + " " + number(v.y()) + " " + number(v.z()) + "\n";
  for (const auto& [name, faces] : groups) {
    text += "o " + name + "\ng " + name + "\nusemtl " + label_name(label_at(mesh, faces[0])) + "\n";
    for (size_t f : faces) {
      const auto& c = mesh.face[f];
      text += "f " + std::to_string(c[0] + 1) + " " + std::to_string(c[inward ? 2 : 1] + 1) + " " +
              std::to_string(c[inward ? 1 : 2] + 1) + "\n";
    }
  }
  write_text(file, text);
  std::string list;
  for (Label label : labels) {
    const auto rgb = label_colour(label);
    list += "newmtl " + label_name(label) + "\nKd " + number(rgb[0]) + " " + number(rgb[1]) + " " + number(rgb[2]) +
            "\nKa 0 0 0\nKs " + (label == Label::water ? "0.8 0.8 0.8" : "0 0 0") + "\n";
  }
  write_text((fs::path(file).parent_path() / materials).string(), list);
}

void write_sdf(const std::string& file, const World& world) {
  const std::string name = fs::path(file).stem().string();
  const std::string dir = (fs::path(file).parent_path() / name).string();
  write_obj(dir + "/meshes/" + name + ".obj", world, true);
  write_text(dir + "/model.config", "<?xml version=\"1.0\"?>\n<model>\n  <name>" + name +
                                        "</name>\n  <version>1.0</version>\n  <sdf version=\"1.6\">model.sdf</sdf>\n"
                                        "  <description>A room-and-pillar mine made by adit</description>\n</model>\n");
  const std::string mesh = "<geometry><mesh><uri>model://" + name + "/meshes/" + name + ".obj</uri></mesh></geometry>";
  write_text(dir + "/model.sdf",
             "<?xml version=\"1.0\"?>\n<sdf version=\"1.6\">\n  <model name=\"" + name +
                 "\">\n    <static>true</static>\n    <link name=\"rock\">\n      <collision name=\"collision\">" +
                 mesh + "</collision>\n      <visual name=\"visual\">" + mesh +
                 "</visual>\n    </link>\n  </model>\n</sdf>\n");
  const Vec3 lamp = world.junctions.empty() ? Vec3(0, 0, 1) : Vec3(world.junctions[0].p_W + Vec3(0, 0, 1.5));
  write_text(file,
             "<?xml version=\"1.0\"?>\n<sdf version=\"1.6\">\n  <world name=\"" + name +
                 "\">\n    <gravity>0 0 -9.81</gravity>\n    <scene><ambient>0.3 0.3 0.3 1</ambient></scene>\n"
                 "    <light type=\"point\" name=\"lamp\"><pose>" +
                 number(lamp.x()) + " " + number(lamp.y()) + " " + number(lamp.z()) +
                 " 0 0 0</pose><diffuse>0.8 0.8 0.7 1</diffuse><attenuation><range>30</range><linear>0.05</linear>"
                 "<constant>0.3</constant><quadratic>0.01</quadratic></attenuation></light>\n    <include>\n      "
                 "<uri>model://" +
                 name + "</uri>\n    </include>\n  </world>\n</sdf>\n");
}

void write_instances(const std::string& file, const World& world) {
  ordered_json all;
  all["info"] = {
      {"description", "things in the mine " + world.name}, {"frame", "W, z up"}, {"units", "metres, radians"}};
  all["categories"] = ordered_json::array();
  std::set<Label> there;
  for (const MineObject& o : world.objects) there.insert(o.label);
  for (Label label : there)
    all["categories"].push_back(
        {{"id", static_cast<int>(label)}, {"name", label_name(label)}, {"supercategory", "mine"}});
  all["annotations"] = ordered_json::array();
  for (size_t i = 0; i < world.objects.size(); ++i) {
    const MineObject& o = world.objects[i];
    all["annotations"].push_back({{"id", i},
                                  {"category_id", static_cast<int>(o.label)},
                                  {"bbox_3d",
                                   {{"middle", {o.middle_W.x(), o.middle_W.y(), o.middle_W.z()}},
                                    {"size", {o.size_m.x(), o.size_m.y(), o.size_m.z()}},
                                    {"yaw", o.yaw_rad}}},
                                  {"volume_m3", o.volume_m3},
                                  {"passage", o.passage},
                                  {"blocks", o.blocks}});
  }
  write_text(file, all.dump(1) + "\n");
}

// As many as the area asks for, the fraction by chance; each point even over its face.
LabelledCloud surface_cloud(const World& world, double per_m2) {
  const Mesh& mesh = world.mesh;
  LabelledCloud cloud;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const std::uint64_t at = cloud_address + f;
    const auto n = static_cast<int>(per_m2 * mesh.area(f) + uniform(0, Draw::world_furniture, at, 0));
    const Vec3 a = mesh.corner(f, 0), ab = mesh.corner(f, 1) - a, ac = mesh.corner(f, 2) - a;
    for (int k = 0; k < n; ++k) {
      const auto j = 1 + 2 * static_cast<std::uint64_t>(k);
      double u = uniform(0, Draw::world_furniture, at, j), v = uniform(0, Draw::world_furniture, at, j + 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      cloud.points.p.push_back(a + u * ab + v * ac);
      cloud.label.push_back(static_cast<std::uint8_t>(label_at(mesh, f)));
      cloud.part.push_back(f < mesh.part.size() ? mesh.part[f] : -1);
    }
  }
  return cloud;
}

void write_labelled_ply(const std::string& file, const LabelledCloud& cloud) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment adit\nelement vertex " +
                    std::to_string(cloud.points.p.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar label\nproperty int "
                    "instance\nend_header\n";
  for (size_t i = 0; i < cloud.points.p.size(); ++i) {
    for (int k = 0; k < 3; ++k) put(out, static_cast<float>(cloud.points.p[i][k]));
    put(out, cloud.label[i]);
    put(out, cloud.part[i]);
  }
  write_text(file, out);
}

void write_kitti_frame(const std::string& dir, const LabelledCloud& cloud) {
  std::string points, labels;
  for (size_t i = 0; i < cloud.points.p.size(); ++i) {
    for (int k = 0; k < 3; ++k) put(points, static_cast<float>(cloud.points.p[i][k]));
    put(points, 0.0f);  // remission is not told
    put(labels, cloud.label[i] | (static_cast<std::uint32_t>(cloud.part[i] + 1) << 16));
  }
  write_text(dir + "/velodyne/000000.bin", points);
  write_text(dir + "/labels/000000.label", labels);
}

}  // namespace adit
