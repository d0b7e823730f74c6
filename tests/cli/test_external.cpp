// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "cli/external.h"
#include "tests/support/plan_log.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const Log& short_log() {
  static const Log log = [] {
    const PlanLog tour = drive_plan(plan_along(panel_lines(2, 2, 12), {}, 3), {{0, 0}, {12, 0}}, {}, 3);
    Log l;
    l.rig.name = "plan";
    l.rig.mounts = {tour.mount};
    l.scans = {tour.scans};
    return l;
  }();
  return log;
}

ExternalSettings python(const std::string& program, const std::vector<std::string>& more = {}) {
  ExternalSettings s;
  s.command = {"python3", "-c", program};
  s.command.insert(s.command.end(), more.begin(), more.end());
  return s;
}

ExternalRun outcome(const ExternalSettings& s) {
  return run_external(s, short_log(), 42, scratch("external"));
}

std::string log_text() {
  return read_text(scratch("external") + "/log.txt");
}

const std::string writes_a_path =
    "import sys; open(sys.argv[1] + '/trajectory.tum', 'w').write('0 0 0 0\\n1 2 3 0\\n')";

TEST(External, AMapperIsGivenTheLogAndItsResultIsRead) {
  ExternalSettings s = python(writes_a_path +
                                  "; lines = [w for w in open(sys.argv[2]) if w.startswith('ROBOTLASER1 ')]"
                                  "; print(len(lines), sys.argv[3])",
                              {"{out}", "{log.clf}", "seed={seed}"});
  s.name = "mine";
  const ExternalRun run = outcome(s);
  ASSERT_TRUE(run.estimate) << run.failure;
  EXPECT_EQ(run.estimate->method, "mine");
  ASSERT_EQ(run.estimate->path.size(), 2u);
  EXPECT_EQ(run.estimate->path.X_WB[1].translation(), Vec3(2, 3, 0));
  EXPECT_EQ(log_text(), std::to_string(short_log().scans[0].size()) + " seed=42\n");
}

TEST(External, ThePathOfALaserIsLaidOnTheBody) {
  ExternalSettings s = python(writes_a_path, {"{out}"});
  s.laser = short_log().rig.mounts[0].name;
  const ExternalRun run = outcome(s);
  ASSERT_TRUE(run.estimate) << run.failure;
  const Pose X_SB = short_log().rig.mounts[0].X_BS.inverse();
  EXPECT_TRUE(run.estimate->path.X_WB[0].isApprox(X_SB, 1e-12));
}

TEST(External, ItsWordsReachItAsTheyAreForThereIsNoShell) {
  const std::string odd = "$(touch x); * \"' `ls`";
  outcome(python("import sys; sys.stdout.write(sys.argv[1])", {odd}));
  EXPECT_EQ(log_text(), odd);
}

TEST(External, AnExitStatusIsToldWithItsLastWords) {
  const ExternalRun run = outcome(python("import sys; print('begun'); print('no scans'); sys.exit(3)"));
  EXPECT_FALSE(run.estimate);
  EXPECT_THAT(run.failure, HasSubstr("exit status 3"));
  EXPECT_THAT(run.failure, HasSubstr("its last words: no scans"));
}

TEST(External, ASignalIsTold) {
  const ExternalRun run = outcome(python("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"));
  EXPECT_THAT(run.failure, HasSubstr("signal 11"));
}

TEST(External, WhatTakesTooLongIsEndedWithAllThatItStarted) {
  ExternalSettings s =
      python("import subprocess, sys; c = subprocess.Popen(['sleep', '600']); print(c.pid, flush=True); c.wait()");
  s.limit_s = 5;  // time enough for python to say the pid on a busy machine
  const ExternalRun run = outcome(s);
  EXPECT_THAT(run.failure, HasSubstr("limit of 5 s (map.external.limit_s)"));
  const std::string child = log_text().substr(0, log_text().find('\n'));
  ASSERT_FALSE(child.empty());
  // The grandchild is gone, or dead and waiting to be collected.
  std::string stat;
  std::ifstream file("/proc/" + child + "/stat");
  std::getline(file, stat, '\0');
  const std::string state = stat.empty() ? "gone" : stat.substr(stat.rfind(')') + 2, 1);
  EXPECT_THAT(state, ::testing::AnyOf("gone", "Z", "X"));
}

TEST(External, WhatTakesTooMuchMemoryIsEnded) {
  ExternalSettings s = python("import time; x = bytearray(300 << 20); time.sleep(60)");
  s.limit_gib = 0.1;
  EXPECT_THAT(outcome(s).failure, HasSubstr("limit of 0.1 GiB of memory"));
}

TEST(External, WhatFillsTheDiskIsEnded) {
  ExternalSettings s =
      python("import sys, time; open(sys.argv[1] + '/x', 'wb').write(bytes(30 << 20)); time.sleep(60)", {"{out}"});
  s.limit_out_gib = 0.01;
  EXPECT_THAT(outcome(s).failure, HasSubstr("limit of 0.01 GiB of files"));
}

TEST(External, NoPathOrABadOneIsAFailureAndSaysSo) {
  EXPECT_THAT(outcome(python("print('done')")).failure, HasSubstr("it left no "));
  const ExternalRun bad =
      outcome(python("import sys; open(sys.argv[1] + '/trajectory.tum', 'w').write('0 0 0 nan\\n')", {"{out}"}));
  EXPECT_THAT(bad.failure, HasSubstr("trajectory.tum:1: not a finite number"));
}

TEST(External, WhatCannotBeStartedAndUnknownPlaceholdersAreBadInput) {
  for (const auto& [command, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"no-such-mapper-at-all"}, "cannot be started"},
           {{"python3", "{outt}"}, "'{outt}' is no placeholder"},
           {{"python3", "{log.xyz}"}, "no format"},
           {{"python3", "{out"}, "is no placeholder"}}) {
    ExternalSettings s;
    s.command = command;
    try {
      outcome(s);
      FAIL() << part;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(part));
    }
  }
}

TEST(External, MrptsIcpSlamMapsAnExampleToADecimetre) {
  if (std::system("command -v icp-slam carmen2rawlog >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "icp-slam is not installed (Debian: mrpt-apps)";
  ExternalSettings s;
  s.command = {"python3", ADIT_SOURCE_DIR "/examples/mrpt-icp-slam/map.py", "{log.clf}", "{out}"};
  s.laser = short_log().rig.mounts[0].name;
  const ExternalRun run = outcome(s);
  ASSERT_TRUE(run.estimate) << run.failure;
  ASSERT_EQ(run.estimate->path.size(), short_log().scans[0].size());
  EXPECT_GT(run.estimate->points.size(), 100u);
  EXPECT_GT(run.estimate->grid.width, 10);
  // 12 m along a passage: what it drove it maps to a few centimetres a metre, its front end being plain ICP.
  const Pose way = run.estimate->path.X_WB.front().inverse() * run.estimate->path.X_WB.back();
  EXPECT_NEAR(way.translation().norm(), 12, 1);
}

}  // namespace
}  // namespace adit
