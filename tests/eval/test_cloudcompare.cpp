// SPDX-License-Identifier: BSD-3-Clause
// Distances of points to a mesh as CloudCompare has them (Debian: cloudcompare), asked by its command line.
#include "base/files.h"
#include "base/mesh.h"
#include "base/rng.h"
#include "eval/map_error.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace adit {
namespace {

// CloudCompare keeps coordinates in floats: multiples of 1/1024 below 8 m are exact there.
double snapped(double v) {
  return std::round(v * 1024) / 1024;
}

TEST(CloudCompare, FindsTheSameDistancesToAMicrometreAndTheSameSides) {
  if (std::system("command -v CloudCompare >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "CloudCompare is not installed (Debian: cloudcompare)";
  Mesh mesh = sphere_mesh(Vec3::Zero(), 2, 3);
  for (size_t i = 0; i < mesh.vertex.size(); ++i)  // a lump, no ball: faces lean every way
    for (int k = 0; k < 3; ++k)
      mesh.vertex[i][k] = snapped(mesh.vertex[i][k] * (1 + 0.1 * normal(1, Draw::test, i, 9)));
  MapPoints points;
  std::string text;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = snapped(6 * uniform(2, Draw::test, i, static_cast<std::uint64_t>(k)) - 3);
    points.p_M.push_back(p);
    char line[96];
    std::snprintf(line, sizeof line, "%.10f %.10f %.10f\n", p.x(), p.y(), p.z());
    text += line;
  }
  points.weight.assign(points.p_M.size(), 1);
  const std::string folder = scratch("cloudcompare");
  std::filesystem::remove_all(folder);
  write_text(folder + "/cloud.asc", text);
  Mesh bare = mesh;
  bare.label.clear(), bare.part.clear(), bare.reflectivity.clear();
  write_mesh(folder + "/mesh.ply", bare);
  const std::string words =
      "cd " + folder +
      " && QT_QPA_PLATFORM=offscreen CloudCompare -SILENT -AUTO_SAVE OFF -C_EXPORT_FMT ASC -PREC 9 "
      "-O cloud.asc -O mesh.ply -C2M_DIST -SAVE_CLOUDS FILE out.asc >said.txt 2>&1";
  ASSERT_EQ(std::system(words.c_str()), 0) << read_text(folder + "/said.txt");

  const Caster caster(mesh);
  const Patches patches(mesh, 0.2, Pose::Identity());
  const Pose here = Pose::Identity();
  const LaidPoints laid = lay(
      points, [&](size_t) -> const Pose& { return here; }, Surface(mesh), patches, nullptr);
  std::istringstream out(read_text(folder + "/out.asc"));
  size_t n = 0, theirs_wrong = 0;
  double x, y, z, theirs;
  while (out >> x >> y >> z >> theirs) {
    ASSERT_LT(n, points.size());
    const double ours = static_cast<double>(laid.error_m[n]);
    ASSERT_NEAR(x, points.p_M[n].x(), 1e-6);
    EXPECT_NEAR(std::abs(ours), std::abs(theirs), 1e-6) << n;
    // Its sign is + out of the enclosed volume, ours + into it. What a ray meets from within says who is right.
    const bool inside = caster.nearest({points.p_M[n], Vec3(0.6, 0, 0.8)}).cosine > 0;
    EXPECT_EQ(ours > 0, inside) << n;
    // Nearest to an edge, it takes any of its faces, which may have the point behind its back.
    theirs_wrong += (theirs < 0) != inside;
    ++n;
  }
  EXPECT_EQ(n, points.size());
  EXPECT_LE(theirs_wrong, points.size() / 5);
}

}  // namespace
}  // namespace adit
