// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/mine_export.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace adit {
namespace {

// A tunnel with a box in it, labelled as a crib.
World tunnel_with_a_crib() {
  World world = tunnel_world(10, 4, 2);
  Mesh& m = world.mesh;
  const Mesh crib = box_mesh({4, -0.4, 0.5}, {5, 0.4, 1.5});
  const auto base = static_cast<std::uint32_t>(m.vertex.size());
  m.vertex.insert(m.vertex.end(), crib.vertex.begin(), crib.vertex.end());
  m.part.resize(m.face.size(), 0);
  for (const auto& f : crib.face) {
    m.face.push_back({base + f[0], base + f[2], base + f[1]});  // it bounds the void
    m.label.push_back(Label::crib);
    m.part.push_back(0);
  }
  m.reflectivity.clear();
  world.objects.push_back({Label::crib, 0, {4.5, 0, 1}, {1, 0.8, 1}, 0, 0.8});
  return world;
}

TEST(MineExport, AnObjIsReadAgainWithItsVolumeAndNamesItsGroups) {
  const World world = tunnel_with_a_crib();
  const std::string file = scratch("mine.obj");
  write_obj(file, world);
  EXPECT_NEAR(enclosed_volume(read_mesh(file)), enclosed_volume(world.mesh), 1e-6);
  EXPECT_NEAR(enclosed_volume(world.mesh), 10 * 4 * 2 - 0.8, 1e-9);
  const std::string text = read_text(file);
  for (const char* group : {"g floor\n", "g roof\n", "g crib_0\n", "mtllib mine.mtl\n"})
    EXPECT_NE(text.find(group), std::string::npos) << group;
  EXPECT_NE(read_text(scratch("mine.mtl")).find("newmtl crib"), std::string::npos);
}

TEST(MineExport, AGazeboModelLooksIntoTheVoidAndNamesItsFiles) {
  const World world = tunnel_with_a_crib();
  write_sdf(scratch("gz/pit.sdf"), world);
  EXPECT_NEAR(enclosed_volume(read_mesh(scratch("gz/pit/meshes/pit.obj"))), -enclosed_volume(world.mesh), 1e-6);
  EXPECT_NE(read_text(scratch("gz/pit/model.sdf")).find("model://pit/meshes/pit.obj"), std::string::npos);
  EXPECT_NE(read_text(scratch("gz/pit/model.config")).find("model.sdf"), std::string::npos);
  EXPECT_NE(read_text(scratch("gz/pit.sdf")).find("<uri>model://pit</uri>"), std::string::npos);
}

TEST(MineExport, InstancesNameTheirCategoryAndBox) {
  write_instances(scratch("objects.json"), tunnel_with_a_crib());
  const auto j = nlohmann::json::parse(read_text(scratch("objects.json")));
  EXPECT_EQ(j["categories"][0]["name"], "crib");
  EXPECT_EQ(j["annotations"][0]["category_id"], j["categories"][0]["id"]);
  EXPECT_EQ(j["annotations"][0]["bbox_3d"]["size"][1], 0.8);
}

TEST(MineExport, ACloudHasItsDensityAndEachPointTheLabelOfItsFace) {
  const World world = tunnel_with_a_crib();
  const LabelledCloud cloud = surface_cloud(world, 50);
  double area = 0, crib = 0;
  for (size_t f = 0; f < world.mesh.face.size(); ++f) {
    area += world.mesh.area(f);
    if (world.mesh.label[f] == Label::crib) crib += world.mesh.area(f);
  }
  const auto faces = static_cast<double>(world.mesh.face.size());
  EXPECT_NEAR(static_cast<double>(cloud.points.p.size()), 50 * area, faces);  // each face is rounded by chance
  const auto n = std::count(cloud.label.begin(), cloud.label.end(), static_cast<std::uint8_t>(Label::crib));
  EXPECT_NEAR(static_cast<double>(n), 50 * crib, 12);
  for (size_t i = 0; i < cloud.label.size(); ++i) {
    const Vec3& p = cloud.points.p[i];
    const bool in_box = p.x() > 3.9 && p.x() < 5.1 && std::abs(p.y()) < 0.41 && p.z() > 0.49 && p.z() < 1.51;
    ASSERT_EQ(cloud.label[i] == static_cast<std::uint8_t>(Label::crib), in_box) << p.transpose();
  }
  write_kitti_frame(scratch("kitti"), cloud);
  EXPECT_EQ(std::filesystem::file_size(scratch("kitti/velodyne/000000.bin")), 16 * cloud.label.size());
  EXPECT_EQ(std::filesystem::file_size(scratch("kitti/labels/000000.label")), 4 * cloud.label.size());
}

TEST(MineExport, ObjectsComeBackFromATruthFile) {
  const World world = tunnel_with_a_crib();
  save_world(scratch("world"), world);
  const World again = load_world(scratch("world"));
  ASSERT_EQ(again.objects.size(), 1u);
  EXPECT_EQ(again.objects[0].label, Label::crib);
  EXPECT_EQ(again.objects[0].size_m, world.objects[0].size_m);
  EXPECT_EQ(again.objects[0].volume_m3, 0.8);
}

}  // namespace
}  // namespace adit
