// SPDX-License-Identifier: BSD-3-Clause
#include "base/bag.h"
#include "base/carmen.h"
#include "base/cloud.h"
#include "base/error.h"
#include "base/files.h"
#include "base/pose_graph.h"
#include "base/recording.h"
#include "base/rng.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace adit {
namespace {

/// A file that is written well, and who reads it.
struct Sample {
  std::string name;
  std::function<void(const std::string&file)> write, read;
};

Log short_log() {
  Log log{load_rig("groundhog2", 38400), {}};
  for (const Mount& mount : log.rig.mounts) {
    Scans s;
    s.beams = mount.laser.beams;
    for (int i = 0; i < 2; ++i) {
      s.stamp_s.push_back(0.24 * i);
      for (int k = 0; k < s.beams; ++k) s.range_m.push_back(k % 9 == 0 ? INFINITY : 1.0f + 0.01f * k);
    }
    log.scans.push_back(s);
  }
  return log;
}

Truth still_truth(const Log& log) {
  Truth truth{.world = {}, .drive = {}, .rig = log.rig, .scans = {}};
  truth.drive.path = {{-1, 1}, {Pose::Identity(), Pose::Identity()}};
  return truth;
}

std::vector<Sample> samples() {
  const Mesh box = box_mesh({0, 0, 0}, {3, 2, 1});
  const PointCloud points{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {0.1, 0.2, 0.3}, {0, 1, 0}, {0.01f, 0.02f, 0.03f}};
  const Trajectory path{{0, 1, 2}, {Pose::Identity(), pose_of({1, 0, 0}, 0.1), pose_of({2, 0, 0}, 0.2)}};
  const PoseGraph graph{
      {{0, 0, 0}, {1, 0, 0.1}, {2, 0, 0.2}},
      {{0, 1, {1, 0, 0.1}, Eigen::Matrix3d::Identity()}, {1, 2, {1, 0, 0.1}, Eigen::Matrix3d::Identity()}},
      {0, 0}};
  const Log log = short_log();
  return {
      {"mesh.ply", [=](auto& f) { write_mesh(f, box); }, [](auto& f) { read_mesh(f); }},
      {"points.ply", [=](auto& f) { write_points(f, points); }, [](auto& f) { read_points(f); }},
      {"points.pcd", [=](auto& f) { write_pcd(f, points); }, [](auto& f) { read_pcd(f); }},
      {"path.tum", [=](auto& f) { write_tum(f, path); }, [](auto& f) { read_tum(f); }},
      {"graph.g2o", [=](auto& f) { write_g2o(f, graph); }, [](auto& f) { read_g2o(f); }},
      {"a.log", [=](auto& f) { write_carmen(f, log, CarmenStyle::flaser); }, [](auto& f) { read_carmen(f); }},
      {"a.bag",
       [=](auto& f) {
         const Truth t = still_truth(log);
         write_bag(f, log, &t);
       },
       [](auto& f) { read_bag(f); }},
      {"log.h5", [=](auto& f) { save_log(f, log); }, [](auto& f) { load_log(f); }},
      {"rig.toml",
       [](auto& f) {
         write_text(f,
                    "name = \"one\"\n[[laser]]\nname = \"front\"\nmodel = \"lms200\"\nposition_m = [0.5, 0.0, "
                    "0.6]\npitch_deg = -90.0\n");
       },
       [](auto& f) { load_rig(f, 38400); }},
  };
}

/// The text with one thing wrong with it: bytes turned or overwritten with what breaks counts and numbers, a piece cut,
/// doubled or moved, the end missing.
std::string damaged(const std::string& whole, std::uint64_t seed) {
  std::uint64_t n = 0;
  const auto below = [&](size_t most) {
    return static_cast<size_t>(uniform(seed, Draw::test, n++) * static_cast<double>(most));
  };
  std::string s = whole;
  const size_t head = std::min<size_t>(s.size(), 400);  // where counts and types stand
  const size_t at = below(below(2) == 0 ? head : s.size()), length = std::min(s.size() - at, 1 + below(24));
  static const std::vector<std::string> odd = {
      "-1",  "nan",  "1e999", "4294967295", "99999999999999999999", "",
      " ",   "\n",   "\"",    "[[",         std::string(4, '\xff'), std::string(8, '\0'),
      "0x7", "1e-9", "\xc3"};
  switch (below(6)) {
    case 0:
      s[at] = static_cast<char>(s[at] ^ (1 << below(8)));
      break;
    case 1:
      s.resize(at);
      break;
    case 2:
      s.erase(at, length);
      break;
    case 3:
      s.insert(below(s.size()), s.substr(at, length));
      break;
    case 4:
      s.replace(at, length, odd[below(odd.size())]);
      break;
    default:
      s.replace(at, std::min<size_t>(4, s.size() - at), std::string(4, '\xff'));
      break;
  }
  return s;
}

class DamagedFiles : public testing::TestWithParam<size_t> {};

TEST_P(DamagedFiles, AreReadOrRefusedByAnErrorThatNamesThem) {
  const Sample sample = samples()[GetParam()];
  const std::string file = scratch("damaged_" + sample.name);
  sample.write(file);
  const std::string whole = read_text(file);
  ASSERT_NO_THROW(sample.read(file)) << sample.name;
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    write_text(file, damaged(whole, seed));
    try {
      sample.read(file);
    } catch (const Error& e) {
      ++refused;
      const std::string what = e.what();  // a rig's lasers are asked for by the name that it gives itself
      EXPECT_TRUE(what.find("damaged_") != std::string::npos || what.starts_with("rig '"))
          << sample.name << " seed " << seed << ": " << what;
    } catch (const std::exception& e) {
      ADD_FAILURE() << sample.name << " seed " << seed << ": not an Error of ours: " << e.what();
    }
  }
  EXPECT_GT(refused, 15) << sample.name;  // a cut file is one of six
}

INSTANTIATE_TEST_SUITE_P(Readers, DamagedFiles, testing::Range<size_t>(0, samples().size()), [](const auto& info) {
  std::string name = samples()[info.param].name;
  for (char& c : name)
    if (c == '.') c = '_';
  return name;
});

}  // namespace
}  // namespace adit
