// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/rng.h"
#include "eval/evo_archive.h"
#include "eval/path_error.h"
#include "eval/score.h"
#include "tests/support/scratch.h"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

const std::string folder = scratch("evo");

// A winding path with a pose each 0.1 s, and an estimate that drifts, is turned, and has stamps of its own.
struct Pair {
  Trajectory truth, estimate;
};
Pair winding(std::uint64_t seed) {
  Pair p;
  const Pose X_MW = pose_of({3, -7, 2}, 1.1, 0.2, -0.1);
  for (int i = 0; i < 400; ++i) {
    const double t = 0.1 * i;
    const Pose X =
        pose_of({5 * std::sin(0.3 * t), 4 * std::cos(0.2 * t), 0.3 * std::sin(t)}, 0.3 * t, 0.05 * std::sin(t));
    const auto z = [&](std::uint64_t k) { return normal(seed, Draw::test, static_cast<std::uint64_t>(i), k); };
    p.truth.stamp_s.push_back(t);
    p.truth.X_WB.push_back(X);
    p.estimate.stamp_s.push_back(t + 0.002 * uniform(seed, Draw::test, static_cast<std::uint64_t>(i), 9));
    p.estimate.X_WB.push_back(X_MW * X * pose_of({0.05 * z(0), 0.05 * z(1), 0.02 * z(2) + 0.001 * i}, 0.01 * z(3)));
  }
  return p;
}

ScoreSettings like_evo() {
  ScoreSettings s;
  s.association = "nearest";
  s.max_diff_s = 0.01;
  s.rpe_m = {2};
  return s;
}

Score scored(const Pair& p) {
  Estimate e;
  e.method = "winding";
  e.path = p.estimate;
  return score_path(p.truth, e, like_evo());
}

// The rotation by Horn's quaternions (J. Opt. Soc. Am. A 4(4), 1987): another way to the optimum than ours.
double ate_by_quaternions(const Trajectory& truth, const Trajectory& estimate) {
  const auto n = static_cast<double>(truth.size());
  Vec3 w = Vec3::Zero(), m = Vec3::Zero();
  for (size_t i = 0; i < truth.size(); ++i)
    w += truth.X_WB[i].translation() / n, m += estimate.X_WB[i].translation() / n;
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < truth.size(); ++i)
    S += (estimate.X_WB[i].translation() - m) * (truth.X_WB[i].translation() - w).transpose();
  Eigen::Matrix4d N;
  N << S.trace(), S(1, 2) - S(2, 1), S(2, 0) - S(0, 2), S(0, 1) - S(1, 0),                    //
      S(1, 2) - S(2, 1), S(0, 0) - S(1, 1) - S(2, 2), S(0, 1) + S(1, 0), S(2, 0) + S(0, 2),   //
      S(2, 0) - S(0, 2), S(0, 1) + S(1, 0), -S(0, 0) + S(1, 1) - S(2, 2), S(1, 2) + S(2, 1),  //
      S(0, 1) - S(1, 0), S(2, 0) + S(0, 2), S(1, 2) + S(2, 1), -S(0, 0) - S(1, 1) + S(2, 2);
  const Eigen::Vector4d q = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(N).eigenvectors().col(3);
  const Eigen::Quaterniond R(q[0], q[1], q[2], q[3]);
  double squares = 0;
  for (size_t i = 0; i < truth.size(); ++i)
    squares += (R * (estimate.X_WB[i].translation() - m) + w - truth.X_WB[i].translation()).squaredNorm();
  return std::sqrt(squares / n);
}

struct Said {
  int exit_code;
  std::string text;
};
Said shell(const std::string& words) {
  std::filesystem::create_directories(folder);
  const std::string at = folder + "/said.txt";
  const int status = std::system((words + " >" + at + " 2>&1").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(at)};
}

TEST(Evo, TheRmseIsThatOfHornsQuaternions) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pair p = winding(seed);
    EXPECT_NEAR(scored(p).find("trajectory.se3.ate_rmse_m")->value, ate_by_quaternions(p.truth, p.estimate), 1e-9)
        << "seed " << seed;
  }
}

TEST(Evo, NearestStampsAreTakenOneToOneAndFarOnesNot) {
  const auto path = [](const std::vector<double>& stamps) {
    Trajectory t;
    for (const double s : stamps) t.stamp_s.push_back(s), t.X_WB.push_back(pose_of({s, 0, 0}, 0));
    return t;
  };
  // 1.02 and 0.99 both want 1; the nearer one has it. 3.2 is too far from any.
  const PathMatch m = associate_nearest(path({0, 1, 2, 3}), path({0.05, 0.99, 1.02, 1.97, 3.2}), 0.1);
  EXPECT_EQ(m.index, (std::vector<size_t>{0, 1, 3}));
  EXPECT_DOUBLE_EQ(m.share(), 0.75);
  EXPECT_NEAR(m.widest_s, 0.05, 1e-12);
  // A sparse truth is asked for no more than it has.
  EXPECT_DOUBLE_EQ(associate_nearest(path({1, 3}), path({0, 1, 2, 3, 4}), 0.1).share(), 1);
}

TEST(Evo, ADriftOverTenMetresIsWhatItIs) {
  // 1 cm up each metre: relative errors over 2 m are 2 cm, whatever the alignment.
  Trajectory truth, estimate;
  for (int i = 0; i <= 80; ++i) {
    truth.stamp_s.push_back(i);
    truth.X_WB.push_back(pose_of({0.25 * i, 0, 0}, 0));
    estimate.stamp_s.push_back(i);
    estimate.X_WB.push_back(pose_of({0.25 * i, 0, 0.0025 * i}, 0));
  }
  const Score s = scored({truth, estimate});
  EXPECT_NEAR(s.find("trajectory.rpe_2m_m")->value, 0.02, 1e-12);
  EXPECT_EQ(s.find("trajectory.rpe_2m_m")->n, 73);
  EXPECT_NEAR(s.find("trajectory.rpe_2m_percent")->value, 1, 1e-9);
}

TEST(Evo, TheArchiveIsAZipThatPythonReads) {
  if (shell("python3 -c 'import zipfile'").exit_code != 0) GTEST_SKIP() << "python3 is not installed";
  const Score s = scored(winding(1));
  write_evo_archive(folder + "/a.zip", s);
  write_text(folder + "/look.py", R"(
import json, struct, sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as z:
    assert z.testzip() is None
    info, stats = json.loads(z.read("info.json")), json.loads(z.read("stats.json"))
    raw = z.read("error_array.npy")
    assert raw[:8] == b"\x93NUMPY\x01\x00" and (10 + struct.unpack("<H", raw[8:10])[0]) % 64 == 0
    head = eval(raw[10:10 + struct.unpack("<H", raw[8:10])[0]])
    body = raw[10 + struct.unpack("<H", raw[8:10])[0]:]
    error = struct.unpack("<%dd" % head["shape"][0], body)
    assert head["descr"] == "<f8" and not head["fortran_order"]
    print(json.dumps({"names": z.namelist(), "info": info, "stats": stats, "n": len(error), "max": max(error)}))
)");
  const Said said = shell("python3 " + folder + "/look.py " + folder + "/a.zip");
  ASSERT_EQ(said.exit_code, 0) << said.text;
  const auto j = nlohmann::json::parse(said.text);
  EXPECT_EQ(j["n"], 400);
  EXPECT_EQ(j["info"]["est_name"], "winding");
  EXPECT_EQ(j["stats"]["rmse"], s.find("trajectory.se3.ate_rmse_m")->value);
  EXPECT_EQ(j["stats"]["median"], s.find("trajectory.se3.ate_median_m")->value);
  EXPECT_EQ(j["max"], j["stats"]["max"]);
  for (const char* name : {"info.json", "stats.json", "error_array.npy", "seconds_from_start.npy", "timestamps.npy"})
    EXPECT_THAT(j["names"].get<std::vector<std::string>>(), ::testing::Contains(name));
}

TEST(Evo, AScoreWithoutAPathHasNoArchive) {
  EXPECT_THROW(write_evo_archive(folder + "/none.zip", Score{}), Error);
}

TEST(Evo, ItsOwnCommandsGiveTheSameNumbersAndOpenOurArchive) {
  if (shell("command -v evo_ape").exit_code != 0) GTEST_SKIP() << "evo_ape is not on the PATH";
  const Pair p = winding(3);
  write_tum(folder + "/truth.tum", p.truth);
  write_tum(folder + "/estimate.tum", p.estimate);
  // As the files have them: nine digits.
  const Score s = scored({read_tum(folder + "/truth.tum"), read_tum(folder + "/estimate.tum")});
  const auto stats = [&](const std::string& words) {
    std::filesystem::remove(folder + "/evo.zip");
    const Said said =
        shell("cd " + folder + " && " + words + " --save_results evo.zip && python3 -m zipfile -e evo.zip evo");
    EXPECT_EQ(said.exit_code, 0) << said.text;
    return nlohmann::json::parse(read_text(folder + "/evo/stats.json"));
  };
  const auto ape = stats("evo_ape tum truth.tum estimate.tum -a --t_max_diff 0.01");
  EXPECT_NEAR(ape["rmse"], s.find("trajectory.se3.ate_rmse_m")->value, 1e-9);
  EXPECT_NEAR(ape["mean"], s.find("trajectory.se3.ate_mean_m")->value, 1e-9);
  EXPECT_NEAR(ape["median"], s.find("trajectory.se3.ate_median_m")->value, 1e-9);
  EXPECT_NEAR(ape["max"], s.find("trajectory.se3.ate_max_m")->value, 1e-9);
  // Poses a quarter of a metre apart: "nearest to 2 m" and "first at least 2 m on" are the same pairs.
  Pair straight = p;
  for (size_t i = 0; i < p.truth.size(); ++i) {
    straight.truth.X_WB[i] = pose_of({0.25 * static_cast<double>(i), 0, 0}, 0);
    straight.estimate.X_WB[i].translation() += straight.truth.X_WB[i].translation();
  }
  write_tum(folder + "/truth.tum", straight.truth);
  write_tum(folder + "/estimate.tum", straight.estimate);
  const Score r = scored({read_tum(folder + "/truth.tum"), read_tum(folder + "/estimate.tum")});
  const auto rpe =
      stats("evo_rpe tum truth.tum estimate.tum -d 2 -u m --all_pairs --pairs_from_reference --t_max_diff 0.01");
  EXPECT_NEAR(rpe["rmse"], r.find("trajectory.rpe_2m_m")->value, 1e-9);
  write_evo_archive(folder + "/ours.zip", s);
  const Said opened = shell("evo_res " + folder + "/ours.zip");
  EXPECT_EQ(opened.exit_code, 0) << opened.text;
}

}  // namespace
}  // namespace adit
