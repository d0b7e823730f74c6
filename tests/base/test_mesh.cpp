// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/mesh.h"
#include "base/ply.h"
#include "base/points.h"
#include "base/rng.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>

namespace adit {
namespace {

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.reflectivity, b.reflectivity);
  ASSERT_EQ(a.vertex.size(), b.vertex.size());
  for (size_t i = 0; i < a.vertex.size(); ++i) EXPECT_EQ(a.vertex[i], b.vertex[i]);
}

TEST(Mesh, VolumeOfABoxIsLengthTimesWidthTimesHeight) {
  EXPECT_NEAR(enclosed_volume(box_mesh({10, 20, 30}, {12, 23, 34})), 24, 24 * 1e-14);  // a dozen roundings
}

TEST(Mesh, VolumeOfAMeshTurnedInsideOutIsNegative) {
  Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  for (auto& f : box.face) std::swap(f[0], f[1]);
  EXPECT_NEAR(enclosed_volume(box), -1, 1e-14);
}

TEST(Mesh, VolumeFarFromTheOriginKeepsItsDigits) {
  const Vec3 far(1e6, -1e6, 0);
  EXPECT_NEAR(enclosed_volume(box_mesh(far, far + Vec3(1, 1, 1))), 1, 1e-8);  // corners are rounded to 1e-10 m there
}

TEST(Mesh, AreaAndNormalOfARightTriangle) {
  Mesh m;
  m.vertex = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  m.face = {{0, 1, 2}};
  EXPECT_DOUBLE_EQ(m.area(0), 6);
  EXPECT_EQ(m.normal(0), Vec3(0, 0, 1));
}

TEST(Mesh, AClosedMeshHasNoOpenEdgeAndALostFaceOpensThree) {
  Mesh box = fine_box_mesh({0, 0, 0}, {3, 2, 1}, 0.5);
  EXPECT_EQ(open_edges(box), 0u);
  box.face.pop_back();
  EXPECT_EQ(open_edges(box), 3u);
}

TEST(Mesh, AFlippedFaceOpensItsThreeEdges) {
  Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  std::swap(box.face[4][0], box.face[4][1]);
  EXPECT_EQ(open_edges(box), 3u);
}

TEST(Mesh, APlyFileGivesTheSameMeshBack) {
  Mesh mesh = fine_box_mesh({-1, -2, 0}, {3, 2, 1.7}, 0.3);
  for (size_t i = 0; i < mesh.vertex.size(); ++i) mesh.vertex[i] *= 1 + 1e-3 * normal(1, Draw::test, i);
  const std::string file = scratch("back.ply");
  write_mesh(file, mesh);
  expect_same(read_mesh(file), mesh);
}

TEST(Mesh, APlainMeshComesBackWithoutColumnsThatItHadNot) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.label.clear();
  mesh.part.clear();
  mesh.reflectivity.clear();
  const std::string file = scratch("plain.ply");
  write_mesh(file, mesh);
  expect_same(read_mesh(file), mesh);
}

const char* ascii_square =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_index\nproperty int part\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 7\n";

TEST(Mesh, AnAsciiPolygonIsFannedIntoTriangles) {
  const std::string file = scratch("square.ply");
  write_text(file, ascii_square);
  const Mesh mesh = read_mesh(file);
  ASSERT_EQ(mesh.face.size(), 2u);
  EXPECT_DOUBLE_EQ(mesh.area(0) + mesh.area(1), 1);
  EXPECT_EQ(mesh.part, (std::vector<int>{7, 7}));
}

TEST(Mesh, ABigEndianFileIsRead) {
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  const auto big = [&](auto v) {
    char bytes[sizeof v];
    std::memcpy(bytes, &v, sizeof v);
    text.append(std::reverse_iterator(bytes + sizeof v), std::reverse_iterator(bytes));
  };
  for (double v : {0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0, 0.0}) big(v);
  big(std::uint8_t{3});
  for (std::uint16_t v : {0, 1, 2}) big(v);
  const std::string file = scratch("big.ply");
  write_text(file, text);
  EXPECT_DOUBLE_EQ(read_mesh(file).area(0), 6);
}

TEST(Mesh, ATruncatedPlyNamesTheFile) {
  const std::string file = scratch("cut.ply");
  write_mesh(file, fine_box_mesh({0, 0, 0}, {1, 1, 1}, 0.3));
  const std::string whole = read_text(file);
  for (size_t bytes : {size_t{0}, size_t{20}, size_t{200}, whole.size() / 2, whole.size() - 1}) {
    write_text(file, whole.substr(0, bytes));
    const std::string what = error_of([&] { read_mesh(file); });
    EXPECT_NE(what.find(file), std::string::npos) << bytes << " bytes: " << what;
  }
}

TEST(Mesh, AFaceThatNamesAVertexThatIsNotThereIsRefused) {
  std::string text = ascii_square;
  text.replace(text.find("4 0 1 2 3"), 9, "4 0 1 2 4");
  const std::string file = scratch("index.ply");
  write_text(file, text);
  EXPECT_NE(error_of([&] { read_mesh(file); }).find("vertex 4"), std::string::npos);
}

TEST(Mesh, AFileOfAnotherKindIsRefused) {
  const std::string file = scratch("foreign.ply");
  write_text(file, "solid cube\nfacet normal 0 0 1\n");
  EXPECT_NE(error_of([&] { read_mesh(file); }).find("does not begin with 'ply'"), std::string::npos);
}

TEST(Mesh, GlbHoldsEveryTriangleOnceAndOneMaterialALabel) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  const std::string file = scratch("box.glb");
  write_glb(file, mesh);
  const std::string bytes = read_text(file);
  const auto word = [&](size_t at) {
    std::uint32_t v;
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
  };
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  ASSERT_EQ(word(8), bytes.size());
  const auto gltf = nlohmann::json::parse(bytes.substr(20, word(12)));
  size_t indices = 0;
  for (const auto& p : gltf["meshes"][0]["primitives"])
    indices += gltf["accessors"][p["indices"].get<size_t>()]["count"].get<size_t>();
  EXPECT_EQ(indices, 3 * mesh.face.size());
  EXPECT_EQ(gltf["materials"].size(), 3u);                                  // floor, roof, rib
  EXPECT_EQ(gltf["accessors"][0]["max"], nlohmann::json({1.0, 3.0, 0.0}));  // z up becomes y up
  EXPECT_EQ(20 + word(12) + 8 + gltf["buffers"][0]["byteLength"].get<size_t>(), bytes.size());
}

TEST(Points, AFileGivesThePointsBackRoundedToFloat) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) {
    cloud.p.push_back(100 *
                      Vec3(normal(1, Draw::test, i, 0), normal(1, Draw::test, i, 1), normal(1, Draw::test, i, 2)));
    cloud.stamp_s.push_back(0.1 * i);
    cloud.laser.push_back(static_cast<std::uint8_t>(i % 4));
  }
  const std::string file = scratch("points.ply");
  write_points(file, cloud);
  const PointCloud back = read_points(file);
  ASSERT_EQ(back.size(), cloud.size());
  EXPECT_EQ(back.stamp_s, cloud.stamp_s);
  EXPECT_EQ(back.laser, cloud.laser);
  for (size_t i = 0; i < cloud.size(); ++i)  // half a unit in the last place of a float
    EXPECT_LE((back.p[i] - cloud.p[i]).cwiseAbs().maxCoeff(), cloud.p[i].cwiseAbs().maxCoeff() * 0x1p-24);
}

TEST(Mesh, PassageMaterialAndWetnessComeBackFromAFile) {
  Mesh mesh = box_mesh({0, 0, 0}, {3, 2, 1});
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    mesh.passage.push_back(static_cast<int>(f));
    mesh.material.push_back(f % 2 ? Material::coal : Material::rock_dust);
    mesh.wetness.push_back(static_cast<float>(f) / 16);
  }
  write_mesh(scratch("rock.ply"), mesh);
  const Mesh back = read_mesh(scratch("rock.ply"));
  expect_same(mesh, back);
  EXPECT_EQ(back.passage, mesh.passage);
  EXPECT_EQ(back.material, mesh.material);
  EXPECT_EQ(back.wetness, mesh.wetness);
}

TEST(Mesh, AWavefrontFileIsReadWithPolygonsFannedAndIndicesFromEitherEnd) {
  write_text(scratch("box.obj"),
             "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\n"
             "f 4 3 2 1\nf 5/1/1 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf -6 -5 -1 -2\nf 4 1 5 8\n");
  const Mesh box = read_mesh(scratch("box.obj"));
  EXPECT_EQ(open_edges(box), 0u);
  EXPECT_NEAR(enclosed_volume(box), 6, 1e-12);
  write_text(scratch("bad.obj"), "v 0 0 0\nf 1 2 3\n");
  EXPECT_NE(error_of([] { read_mesh(scratch("bad.obj")); }).find("bad.obj:2: no vertex '2'"), std::string::npos);
}

}  // namespace
}  // namespace adit
