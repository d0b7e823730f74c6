// SPDX-License-Identifier: BSD-3-Clause
// Meshes and plans in programs that are not ours: each test runs where the program is installed.
#include "base/files.h"
#include "base/mine_export.h"
#include "tests/support/scratch.h"
#include "worlds/lattice.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

namespace adit {
namespace {

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

// What a command says, on both streams.
std::string said_by(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen(("timeout 120 " + command + " 2>&1").c_str(), "r");
  char block[4096];
  while (const size_t n = std::fread(block, 1, sizeof block, pipe)) text.append(block, n);
  ::pclose(pipe);
  return text;
}

// The number that follows some words; NaN where they are not said.
double number_after(const std::string& text, const std::string& words) {
  const size_t at = text.find(words);
  return at == std::string::npos ? std::nan("") : std::strtod(text.c_str() + at + words.size(), nullptr);
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f) area += mesh.area(f);
  return area;
}

// A small mine with a wall in it, saved once.
struct Saved {
  std::string dir = scratch("foreign");
  World world;
  double area_m2;

  Saved() {
    WorldSettings s;
    s.kind = "panel";
    s.mesh_edge_m = 0.4;
    s.panel.stopping_share = 0.5;
    world = make_world(s, 1);
    area_m2 = area_of(world.mesh);
    save_world(dir, world);
    save_plan(dir, world);
  }
};

const Saved& saved() {
  static const Saved once;
  return once;
}

// They compute in floats, some about the origin: a mine of 100 m to 1e-7 of its coordinates, areas of small faces worse.
constexpr double relative = 3e-5;

TEST(Foreign, MeshLabFindsTheSameAreaAndVolume) {
  if (!installed("meshlabserver") || !installed("xvfb-run"))
    GTEST_SKIP() << "meshlabserver or xvfb-run is not installed";
  const Saved& mine = saved();
  write_text(mine.dir + "/measure.mlx",
             "<!DOCTYPE FilterScript>\n<FilterScript><filter name=\"Compute Geometric Measures\"/></FilterScript>\n");
  const std::string said =
      said_by("xvfb-run -a meshlabserver -i " + mine.dir + "/mine.ply -s " + mine.dir + "/measure.mlx");
  EXPECT_NEAR(number_after(said, "Mesh Surface Area is "), mine.area_m2, relative * mine.area_m2) << said;
  EXPECT_NEAR(number_after(said, "Mesh Volume  is "), mine.world.numbers.volume_m3,
              relative * mine.world.numbers.volume_m3)
      << said;
}

TEST(Foreign, CloudCompareFindsTheSameVolume) {
  if (!installed("CloudCompare")) GTEST_SKIP() << "CloudCompare is not installed";
  const Saved& mine = saved();
  const std::string said =
      said_by("env QT_QPA_PLATFORM=offscreen CloudCompare -SILENT -O " + mine.dir + "/mine.ply -MESH_VOLUME");
  EXPECT_NEAR(number_after(said, "V = "), mine.world.numbers.volume_m3, relative * mine.world.numbers.volume_m3)
      << said;
}

TEST(Foreign, AssimpReadsTheSameAreaAndVolumeFromGltf) {
  if (!installed("assimp")) GTEST_SKIP() << "assimp is not installed";
  const Saved& mine = saved();
  const std::string file = mine.dir + "/assimp.ply";
  const std::string said = said_by("assimp export " + mine.dir + "/mine.glb " + file);
  const Mesh again = read_mesh(file);
  EXPECT_EQ(again.face.size(), mine.world.mesh.face.size()) << said;
  EXPECT_NEAR(area_of(again), mine.area_m2, relative * mine.area_m2);
  EXPECT_NEAR(enclosed_volume(again), mine.world.numbers.volume_m3, relative * mine.world.numbers.volume_m3);
}

TEST(Foreign, AssimpReadsTheSameAreaAndVolumeFromObj) {
  if (!installed("assimp")) GTEST_SKIP() << "assimp is not installed";
  const Saved& mine = saved();
  const std::string obj = mine.dir + "/mine.obj", file = mine.dir + "/assimp-obj.ply";
  write_obj(obj, mine.world, false);
  const std::string said = said_by("assimp export " + obj + " " + file);
  const Mesh again = read_mesh(file);
  EXPECT_EQ(again.face.size(), mine.world.mesh.face.size()) << said;
  EXPECT_NEAR(area_of(again), mine.area_m2, relative * mine.area_m2);
  EXPECT_NEAR(enclosed_volume(again), mine.world.numbers.volume_m3, relative * mine.world.numbers.volume_m3);
}

// Gazebo's own parser. It must refuse what is wrong, else that it accepts ours says nothing.
TEST(Foreign, SdformatAcceptsTheWorldAndItsModel) {
  if (!installed("ign") || said_by("ign sdf --versions").find("12.") == std::string::npos)
    GTEST_SKIP() << "needs ignition-tools and libsdformat-dev: ci/setup --peers";
  const Saved& mine = saved();
  const std::string world = mine.dir + "/gazebo/mine.sdf", model = mine.dir + "/gazebo/mine/model.sdf";
  write_sdf(world, mine.world);
  const auto verdict = [&](const std::string& file) {
    return said_by("env SDF_PATH=" + mine.dir + "/gazebo ign sdf -k " + file);
  };
  EXPECT_NE(verdict(model).find("Valid."), std::string::npos) << verdict(model);
  EXPECT_NE(verdict(world).find("Valid."), std::string::npos) << verdict(world);
  std::string wrong = read_text(model);
  wrong.erase(wrong.find(" name=\"rock\""), 12);
  write_text(mine.dir + "/gazebo/wrong.sdf", wrong);
  EXPECT_EQ(verdict(mine.dir + "/gazebo/wrong.sdf").find("Valid."), std::string::npos);
}

TEST(Foreign, GdalReadsTheLayersOfTheDxf) {
  if (!installed("ogr2ogr")) GTEST_SKIP() << "ogr2ogr is not installed";
  const Saved& mine = saved();
  const std::string said =
      said_by("ogr2ogr -f CSV /vsistdout/ " + mine.dir + "/plan.dxf -select Layer -lco GEOMETRY=AS_WKT");
  std::map<std::string, size_t> found;
  double pillars_m2 = 0;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    const size_t name = line.rfind(',') + 1;
    ++found[line.substr(name)];
    if (line.substr(name) != "PILLARS") continue;
    Loop ring;
    std::string numbers = line.substr(line.find('(') + 1);
    for (char& c : numbers)
      if (std::string("(),").find(c) != std::string::npos) c = ' ';
    std::istringstream in(numbers);
    for (double x, y, z; in >> x >> y >> z;) ring.emplace_back(x, y);
    pillars_m2 += std::abs(enclosed_area(ring));
  }
  EXPECT_EQ(found["VOID"], 1u) << said.substr(0, 300);
  EXPECT_EQ(found["PILLARS"], mine.world.pillars.size());
  EXPECT_EQ(found["CENTRE_LINES"], mine.world.passages.size());
  EXPECT_EQ(found["JUNCTIONS"], mine.world.junctions.size());
  double expected = 0;
  for (const Pillar& p : mine.world.pillars) expected += p.area_m2;
  EXPECT_NEAR(pillars_m2, expected, 1e-4 * expected);  // coordinates to a millimetre
}

// ADIT_GLTF_VALIDATOR: a folder in which `npm install gltf-validator` was run (Khronos's own validator).
TEST(Foreign, TheValidatorOfKhronosHasNothingToSay) {
  const char* folder = std::getenv("ADIT_GLTF_VALIDATOR");
  if (!folder || !installed("node")) GTEST_SKIP() << "ADIT_GLTF_VALIDATOR is not set, or node is not installed";
  const Saved& mine = saved();
  const std::string said = said_by(
      "env NODE_PATH=" + std::string(folder) +
      "/node_modules node -e \"require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync('" +
      mine.dir +
      "/mine.glb'))).then(r => console.log('found', r.issues.numErrors + r.issues.numWarnings + "
      "r.issues.numInfos + r.issues.numHints, 'in', r.info.totalTriangleCount))\"");
  EXPECT_EQ(number_after(said, "found "), 0) << said;
  EXPECT_EQ(number_after(said, " in "), static_cast<double>(mine.world.mesh.face.size())) << said;
}

TEST(Foreign, APlanInTheFormatsOfGdalIsTheMineThatItIsInGeoJson) {
  if (!installed("ogr2ogr")) GTEST_SKIP() << "ogr2ogr is not installed";
  const Saved& mine = saved();
  WorldSettings s;
  s.mesh_edge_m = 0.5;
  s.plan = mine.dir + "/plan.geojson";
  const World expected = make_world(s, 1);
  for (const std::string format : {"gpkg", "gml"}) {
    s.plan = mine.dir + "/plan." + format;
    std::remove(s.plan.c_str());
    // A table holds one kind of geometry: the void is enough.
    const std::string said =
        said_by("ogr2ogr -where \"kind='void'\" -nlt POLYGON " + s.plan + " " + mine.dir + "/plan.geojson");
    const World again = make_world(s, 1);
    EXPECT_EQ(again.pillars.size(), expected.pillars.size()) << said;
    EXPECT_NEAR(again.numbers.floor_area_m2, expected.numbers.floor_area_m2, 1e-3);  // coordinates to a micrometre
  }
}

}  // namespace
}  // namespace adit
