// SPDX-License-Identifier: BSD-3-Clause
// The command as its users call it: the built program, its files, its exit codes, its words.
#include "base/files.h"
#include "tests/support/folder.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string tiny = ADIT_SOURCE_DIR "/tests/cli/tiny.toml";

struct Answer {
  int exit_code;
  std::string out, err;
};

Answer adit_says(const std::string& words) {
  const std::string at = scratch("says");
  const int status =
      std::system((std::string(ADIT_BINARY) + " " + words + " >" + at + ".out 2>" + at + ".err").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(at + ".out"), read_text(at + ".err")};
}

std::string fresh_folder(const std::string& name) {
  const std::string dir = scratch("cli_") + name;
  fs::remove_all(dir);
  return dir;
}

// One run of the tiny mine serves all tests that only look at it.
class TinyRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    out_ = fresh_folder("tiny");
    answer_ = adit_says("run " + tiny + " --threads 1 --json -o " + out_);
  }
  static void TearDownTestSuite() { fs::remove_all(out_); }
  static std::string out_;
  static Answer answer_;
};
std::string TinyRun::out_;
Answer TinyRun::answer_;

TEST_F(TinyRun, DoesTheWholeJobAndLeavesEveryFileOfTheContract) {
  ASSERT_EQ(answer_.exit_code, 0) << answer_.err;
  for (const char* file :
       {"scenario.toml", "timing.json", "world/mine.ply", "world/mine.glb", "world/truth.json", "recording/log.h5",
        "recording/truth.h5", "map/trajectory.tum", "map/grid.pgm", "map/grid.yaml", "map/points.ply",
        "map/surface.ply", "map/map.json", "score.json", "report/index.html"})
    EXPECT_TRUE(fs::exists(out_ + "/" + file)) << file;
}

TEST_F(TinyRun, JsonPutsOneObjectOnStdoutAndNothingElse) {
  const nlohmann::json said = nlohmann::json::parse(answer_.out);
  EXPECT_EQ(said["out"], out_);
  EXPECT_TRUE(said["score"]["trajectory"]["se3"]["ate_xy_rmse_m"]["value"].is_number());
}

TEST_F(TinyRun, TheMapIsRightToTheBarsOfASmallMine) {
  const nlohmann::json score = nlohmann::json::parse(read_text(out_ + "/score.json"));
  EXPECT_LT(score["trajectory"]["se3"]["ate_xy_rmse_m"]["value"], 0.2);
  EXPECT_LT(score["map"]["se3"]["mae_m"]["value"], 0.1);
  EXPECT_LT(std::abs(score["volume"]["error_percent"]["value"].get<double>()), 5);
  EXPECT_EQ(score["closures"]["wrong"]["value"], 0);
}

TEST_F(TinyRun, TwoAndSevenThreadsMakeTheSameBytes) {
  const auto one = bytes_of(out_);
  for (const char* threads : {"2", "7"}) {
    const std::string other = fresh_folder(std::string("threads") + threads);
    const Answer said = adit_says("run " + tiny + " --threads " + threads + " --quiet -o " + other);
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const auto same = bytes_of(other);
    EXPECT_EQ(same.size(), one.size());
    for (const auto& [file, bytes] : one) {
      ASSERT_TRUE(same.contains(file)) << file;
      EXPECT_TRUE(same.at(file) == bytes) << file << " differs on " << threads << " threads";
    }
    fs::remove_all(other);
  }
}

TEST_F(TinyRun, MappingNeedsNoTruth) {
  const std::string dir = fresh_folder("no_truth");
  fs::create_directories(dir);
  fs::copy(out_ + "/recording/log.h5", dir + "/log.h5");  // alone: no truth, no world, no scenario beside it
  const Answer said = adit_says("map " + dir + "/log.h5 --quiet -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  for (const char* file : {"trajectory.tum", "grid.pgm", "points.ply", "surface.ply", "map.json"})
    EXPECT_TRUE(read_text(dir + "/map/" + file) == read_text(out_ + "/map/" + file)) << file;
  fs::remove_all(dir);
}

TEST_F(TinyRun, ItsRecordingGoesOutInEveryFormatAndCarmenComesBack) {
  const std::string dir = fresh_folder("formats"), log = out_ + "/recording/log.h5";
  for (const char* to : {"flaser.log", "robot.clf", "path.tum", "cloud.ply", "cloud.pcd", "kitti"}) {
    const Answer said = adit_says("convert " + log + " " + dir + "/" + to + " --every 20");
    ASSERT_EQ(said.exit_code, 0) << to << said.err;
    EXPECT_TRUE(fs::exists(dir + "/" + to)) << to;
  }
  EXPECT_TRUE(fs::exists(dir + "/kitti/labels/000000.label"));
  ASSERT_EQ(adit_says("convert " + dir + "/robot.clf " + dir + "/back.h5").exit_code, 0);
  ASSERT_EQ(adit_says("convert " + dir + "/back.h5 " + dir + "/again.clf").exit_code, 0);
  // TRUEPOS lines are gone with the truth; the scans are the same.
  std::string without;
  std::istringstream lines(read_text(dir + "/robot.clf"));
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("TRUEPOS")) without += line + "\n";
  EXPECT_TRUE(without == read_text(dir + "/again.clf"));
  EXPECT_THAT(adit_says("convert " + dir + "/robot.clf " + dir + "/no.ply").err, HasSubstr("needs the truth"));
  EXPECT_THAT(adit_says("convert " + log + " " + dir + "/no.xyz").err, HasSubstr("'.xyz' is no format"));
  fs::remove_all(dir);
}

TEST(Pictures, ARigIsDrawnFromFourSides) {
  const std::string dir = fresh_folder("rig");
  const Answer said = adit_says("rig cart4 -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  for (const char* view : {"corner", "side", "front", "above"})
    EXPECT_GT(fs::file_size(dir + "/" + view + ".png"), 20000u) << view;
  fs::remove_all(dir);
}

TEST_F(TinyRun, AResolvedScenarioMakesTheSameMine) {
  const std::string dir = fresh_folder("again");
  const Answer said = adit_says("world " + out_ + "/scenario.toml --quiet -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_TRUE(read_text(dir + "/world/mine.ply") == read_text(out_ + "/world/mine.ply"));
  EXPECT_TRUE(read_text(dir + "/scenario.toml") == read_text(out_ + "/scenario.toml"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, ScoringAndReportingAgainGivesTheSameBytes) {
  const auto before = bytes_of(out_);
  const Answer scored = adit_says("score --quiet --world " + out_ + "/world --truth " + out_ +
                                  "/recording/truth.h5 --map " + out_ + "/map");
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const Answer reported = adit_says("report --quiet " + out_);
  ASSERT_EQ(reported.exit_code, 0) << reported.err;
  for (const auto& [file, bytes] : bytes_of(out_)) EXPECT_TRUE(before.at(file) == bytes) << file;
}

TEST_F(TinyRun, AFolderWithPartsMissingGivesAPageThatSaysWhich) {
  for (const std::string part : {"world", "recording", "map", "score.json"}) {
    const std::string dir = fresh_folder("lacking");
    fs::copy(out_, dir, fs::copy_options::recursive);
    fs::remove_all(dir + "/" + part);
    const Answer said = adit_says("report --json " + dir + " --set report.places=1 --set report.frames=0");
    EXPECT_EQ(said.exit_code, 0) << part << said.err;
    const nlohmann::json json = nlohmann::json::parse(said.out);
    EXPECT_EQ(json["missing"].empty(), part == "score.json") << part;  // which is computed again
    const std::string html = read_text(dir + "/report/index.html");
    EXPECT_EQ(html.find("Not all of the run is there") == std::string::npos, part == "score.json") << part;
    fs::remove_all(dir);
  }
  const std::string dir = fresh_folder("cut");
  fs::copy(out_, dir, fs::copy_options::recursive);
  fs::resize_file(dir + "/map/points.ply", 1000);
  const Answer said = adit_says("report --json " + dir + " --set report.frames=0");
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(nlohmann::json::parse(said.out)["missing"][0], HasSubstr("points.ply"));
  EXPECT_THAT(read_text(dir + "/report/index.html"), HasSubstr("the map lies"));  // by its score.json
  fs::remove_all(dir);
}

TEST_F(TinyRun, TwoFoldersStandSideBySideOnOnePage) {
  const std::string dir = fresh_folder("beside");
  const Answer said = adit_says("report --quiet " + out_ + " " + out_ + " -o " + dir);
  EXPECT_EQ(said.exit_code, 2);  // one seed twice in one group
  fs::create_directories(dir);
  fs::copy(out_, dir + "/b", fs::copy_options::recursive);
  std::string toml = read_text(out_ + "/scenario.toml");
  toml.replace(toml.find("interiors = "), 12, "interiors = 1");
  write_text(dir + "/b/scenario.toml", toml);
  const Answer two = adit_says("report --quiet " + out_ + " " + dir + "/b -o " + dir + "/page");
  EXPECT_EQ(two.exit_code, 0) << two.err;
  const std::string html = read_text(dir + "/page/index.html");
  EXPECT_THAT(html, HasSubstr("2 runs side by side"));
  EXPECT_THAT(html, HasSubstr("href=\"../b/report/index.html\""));
  EXPECT_THAT(html, HasSubstr("aria-label=\"Plan of the mine"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, SomebodysPartsScoreAsTheWholeMapDoes) {
  const std::string dir = fresh_folder("parts");
  const std::string truth = " --world " + out_ + "/world --truth " + out_ + "/recording/truth.h5 --quiet -o " + dir;
  const Answer said =
      adit_says("score --trajectory " + out_ + "/map/trajectory.tum --points " + out_ + "/map/points.ply --grid " +
                out_ + "/map/grid.yaml --surface " + out_ + "/map/surface.ply --volume 500" + truth);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const nlohmann::json whole = nlohmann::json::parse(read_text(out_ + "/score.json")),
                       parts = nlohmann::json::parse(read_text(dir + "/score.json"));
  for (const char* block : {"map", "grid"}) EXPECT_EQ(parts[block], whole[block]) << block;
  EXPECT_EQ(parts["trajectory"]["se3"], whole["trajectory"]["se3"]);
  EXPECT_EQ(parts["volume"]["error_percent"], whole["volume"]["error_percent"]);
  EXPECT_EQ(parts["volume"]["claimed_m3"]["value"], 500);
  // A path alone is scored as a path; what was not given is null and says so.
  ASSERT_EQ(adit_says("score --trajectory " + out_ + "/map/trajectory.tum" + truth).exit_code, 0);
  const nlohmann::json path = nlohmann::json::parse(read_text(dir + "/score.json"));
  EXPECT_EQ(path["trajectory"]["se3"], whole["trajectory"]["se3"]);
  EXPECT_EQ(path["map"]["se3"]["mae_m"]["why"], "the map has no points");
  fs::remove_all(dir);
}

TEST_F(TinyRun, ThePathOfALaserIsLaidOnTheBodyWhereItIsSaidSo) {
  const std::string dir = fresh_folder("laser");
  // A CARMEN log knows no mounts: its map is in the frame of the laser, half a metre ahead of the body.
  ASSERT_EQ(adit_says("convert " + out_ + "/recording/log.h5 " + dir + "/robot.log").exit_code, 0);
  ASSERT_EQ(adit_says("map " + dir + "/robot.log --quiet -o " + dir).exit_code, 0);
  const std::string words = "score --world " + out_ + "/world --truth " + out_ + "/recording/truth.h5 --quiet -o " +
                            dir + " --trajectory " + dir + "/map/trajectory.tum";
  const auto ate_m = [&](const std::string& more) {
    const Answer said = adit_says(words + more);
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return nlohmann::json::parse(read_text(dir + "/score.json"))["trajectory"]["se3"]["ate_xy_rmse_m"]["value"]
        .get<double>();
  };
  const double right_m = ate_m(" --laser front");
  EXPECT_LT(right_m, 0.2);              // the bar of the whole map
  EXPECT_GT(ate_m(""), right_m + 0.1);  // the lever of 0.5 m turns with the cart, less what a rigid fit takes of it
  const Answer unknown = adit_says(words + " --laser rear");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("front"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, APathIsScoredAgainstAPathAndItsErrorsGoToEvo) {
  const std::string dir = fresh_folder("paths"), est = out_ + "/map/trajectory.tum";
  ASSERT_EQ(adit_says("convert " + out_ + "/recording/truth.h5 " + dir + "/truth.tum").exit_code, 0);
  const Answer said = adit_says("score --truth " + dir + "/truth.tum --trajectory " + est + " --evo " + dir +
                                "/evo.zip --quiet -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const nlohmann::json alone = nlohmann::json::parse(read_text(dir + "/score.json")),
                       whole = nlohmann::json::parse(read_text(out_ + "/score.json"));
  // But for the mount's unknown error, which a path alone cannot take out: degrees of it, over centimetres.
  EXPECT_NEAR(alone["trajectory"]["se3"]["ate_xy_rmse_m"]["value"].get<double>(),
              whole["trajectory"]["se3"]["ate_xy_rmse_m"]["value"].get<double>(), 0.02);
  EXPECT_GT(fs::file_size(dir + "/evo.zip"), 1000u);
  const Answer points = adit_says("score --truth " + dir + "/truth.tum --trajectory " + est + " --points " + out_ +
                                  "/map/points.ply -o " + dir);
  EXPECT_EQ(points.exit_code, 2);
  EXPECT_THAT(points.err, HasSubstr("--world"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, AMapperOfOthersIsScoredBesideOursAndItsFailureCounts) {
  const std::string dir = fresh_folder("others"), copied = dir + "/copied", failed = dir + "/failed";
  const std::string recording = "map " + out_ + "/recording/log.h5 --quiet -o ";
  // It "maps" by handing in our own path.
  const Answer said = adit_says(recording + copied + " --set 'map.external.command=[\"cp\", \"" + out_ +
                                "/map/trajectory.tum\", \"{out}/trajectory.tum\"]'");
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const std::string theirs = read_text(copied + "/map/trajectory.tum"), ours = read_text(out_ + "/map/trajectory.tum");
  EXPECT_EQ(std::count(theirs.begin(), theirs.end(), '\n'), std::count(ours.begin(), ours.end(), '\n'));
  const Answer no = adit_says(recording + failed + " --set 'map.external.command=[\"false\"]'");
  EXPECT_EQ(no.exit_code, 1);
  EXPECT_FALSE(fs::exists(failed + "/map"));
  EXPECT_TRUE(fs::exists(failed + "/external/log.txt"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, RunsAreComparedBySeedAndAFailedOneCounts) {
  const std::string dir = fresh_folder("compare"), failed = dir + "/failed";
  write_text(failed + "/scenario.toml", read_text(out_ + "/scenario.toml") + "\n");
  const Answer twice = adit_says("compare " + out_ + " " + out_ + " -o " + dir);
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("each may be given once"));
  std::string text = read_text(failed + "/scenario.toml");
  const size_t at = text.find("seed = ");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, text.find('\n', at) - at, "seed = 99");
  write_text(failed + "/scenario.toml", text);
  const Answer said = adit_says("compare " + out_ + " " + failed + " -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("2 runs, 1 failed (seed 99)"));
  const nlohmann::json j = nlohmann::json::parse(read_text(dir + "/comparison.json"));
  EXPECT_EQ(j["groups"][0]["failed"][0], 99);
  EXPECT_EQ(j["metrics"]["map.se3.mae_m"]["groups"][0]["n"], 1);
  fs::remove_all(dir);
}

TEST_F(TinyRun, TheTruthOfAnotherMineIsNotComparable) {
  const std::string dir = fresh_folder("other_mine");
  ASSERT_EQ(adit_says("world " + tiny + " --seed 77 --quiet -o " + dir).exit_code, 0);
  const Answer said = adit_says("score --world " + dir + "/world --truth " + out_ + "/recording/truth.h5 --map " +
                                out_ + "/map -o " + dir);
  EXPECT_EQ(said.exit_code, 3) << said.err;
  EXPECT_FALSE(fs::exists(dir + "/score.json"));
  fs::remove_all(dir);
}

// Round in a bend until a rib is in the way.
TEST_F(TinyRun, ADriveThatEndsEarlyIsAnsweredNoWithPlaceAndPictureAndItsRecordingIsKept) {
  const std::string dir = fresh_folder("early");
  write_text(dir + "/joystick.csv", "time_s,speed_mps,turn_rate_rad_s\n0.5,0.5,0.25\n60,0,0\n");
  const Answer said = adit_says("drive " + tiny + " --threads 1 --set drive.commands=" + dir +
                                "/joystick.csv --world " + out_ + "/world -o " + dir);
  EXPECT_EQ(said.exit_code, 1) << said.err;
  EXPECT_THAT(said.err, HasSubstr("the drive ended early (blocked): cart is blocked at ("));
  EXPECT_THAT(said.err, HasSubstr("against the rib"));
  EXPECT_GT(fs::file_size(dir + "/recording/trouble.png"), 10000u);  // a picture with a mine in it
  const Answer cloud = adit_says("convert " + dir + "/recording/log.h5 " + dir + "/cloud.ply --every 20 --quiet");
  EXPECT_EQ(cloud.exit_code, 0) << cloud.err;
  EXPECT_TRUE(fs::exists(dir + "/recording/truth.h5"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, ATruncatedRecordingIsRefusedAndLeavesNothing) {
  const std::string dir = fresh_folder("truncated");
  const std::string log = read_text(out_ + "/recording/log.h5");
  write_text(dir + "/log.h5", log.substr(0, log.size() / 2));
  const Answer said = adit_says("map " + dir + "/log.h5 -o " + dir + "/m");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr("log.h5"));
  EXPECT_FALSE(fs::exists(dir + "/m"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, WhatMinesMeasureIsATableAndPlots) {
  const std::string dir = fresh_folder("stats");
  const Answer said = adit_says("world --json --stats " + out_ + " -o " + dir);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const nlohmann::json json = nlohmann::json::parse(said.out);
  EXPECT_EQ(json["mines"], 1);
  for (const std::string key : {"floor_rough_m", "roof_rough_m", "rib_rough_m", "junction_degree"})
    EXPECT_TRUE(json.contains(key)) << key;
  const std::string svg = read_text(dir + "/stats.svg");
  EXPECT_THAT(svg, HasSubstr("height_m"));
  EXPECT_TRUE(fs::exists(dir + "/stats.png"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, AMeshIsCheckedAndABrokenOneIsAnsweredNo) {
  EXPECT_EQ(adit_says("world --check " + out_ + "/world/mine.ply").exit_code, 0);
  EXPECT_EQ(adit_says("world --check " + out_ + "/scenario.toml").exit_code, 2);
}

TEST(Words, ABadKeyNamesFileLineAndRemedyAndWritesNothing) {
  const std::string dir = fresh_folder("bad_key");
  write_text(dir + "/s.toml", "name = 'x'\n[world]\nkinds = 'panel'\n");
  const Answer said = adit_says("run " + dir + "/s.toml -o " + dir + "/o");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_THAT(said.err, HasSubstr("s.toml:3: unknown key 'world.kinds' (did you mean 'world.kind'?)"));
  EXPECT_FALSE(fs::exists(dir + "/o"));
  fs::remove_all(dir);
}

TEST_F(TinyRun, ItsGraphIsCertifiedAndASolutionOfItself) {
  const auto map = nlohmann::json::parse(read_text(out_ + "/map/map.json"));
  EXPECT_TRUE(map["graph"]["certificate"]["certified"].get<bool>());
  const std::string again = fresh_folder("graph");
  const Answer said = adit_says("map " + out_ + "/map/graph.g2o --json -o " + again);
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const auto graph = nlohmann::json::parse(said.out)["map"]["graph"];
  EXPECT_TRUE(graph["certificate"]["certified"].get<bool>());
  for (const char* count : {"nodes", "edges"}) EXPECT_EQ(graph[count], map["graph"][count]) << count;
  EXPECT_TRUE(fs::exists(again + "/map/covariance.txt"));
  fs::remove_all(again);
}

TEST(Words, BadInputHasExitCodeTwoAndOneClearLine) {
  for (const auto& [words, part] :
       std::map<std::string, std::string>{{"run no-such-scenario", "there are:"},
                                          {"run /no/such/file.toml", "no such file"},
                                          {"run mini --set world.kind=cave", "must be one of"},
                                          {"run mini --set nonsense", "key=value"},
                                          {"run mini --set vehicle=tank", "tank"},
                                          {"run mini --set sensors.rig=none", "none"},
                                          {"run mini --set sensors.baud=1200", "1200"},
                                          {"map /no/such/log.h5", "no such file"},
                                          {"map /no/such/graph.g2o", "graph.g2o"},
                                          {"score --world /none --truth /none --map /none", "/none"},
                                          {"report /none", "no such folder"},
                                          {"list nonsense", "there are"},
                                          {"frobnicate", ""},
                                          {"", ""}}) {
    const std::string out = fresh_folder("bad_input");
    const Answer said = adit_says(words + (words.starts_with("run") || words.starts_with("map") ? " -o " + out : ""));
    EXPECT_EQ(said.exit_code, 2) << words << "\n" << said.err;
    EXPECT_THAT(said.err + said.out, HasSubstr(part)) << words;
    EXPECT_FALSE(fs::exists(out)) << words;
  }
}

TEST(Words, AFolderThatCannotBeWrittenIsExitCode74) {
  const std::string dir = fresh_folder("unwritable");
  write_text(dir + "/file", "a file where a folder is wanted");
  EXPECT_EQ(adit_says("world " + tiny + " --quiet -o " + dir + "/file/out").exit_code, 74);
  fs::remove_all(dir);
}

TEST(Words, ListNamesWhatIsBundledAndHelpTheKeys) {
  const Answer list = adit_says("list");
  EXPECT_EQ(list.exit_code, 0);
  for (const char* name : {"bruceton", "mini", "cart4", "lms200", "cart"}) EXPECT_THAT(list.out, HasSubstr(name));
  EXPECT_THAT(adit_says("help scenario").out, HasSubstr("world.kind"));
  EXPECT_THAT(adit_says("--help").out, HasSubstr("run"));
}

// A drive that makes several parts, each of which takes a while: slow pushing, many rays a beam.
const std::string long_drive =
    "drive " + tiny + " --quiet --set drive.speed_mps=0.25 --set sensors.sub_rays=37 --threads 1 -o ";

TEST(Streaming, OfADriveThatIsKilledTheClosedPartsAreJoined) {
  const std::string dir = fresh_folder("killed"), parts = dir + "/recording/parts";
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", ("exec " ADIT_BINARY " " + long_drive + dir).c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  while (!fs::exists(parts + "/log-0001.h5") && ::waitpid(child, &status, WNOHANG) == 0) ::usleep(20000);
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  EXPECT_FALSE(fs::exists(dir + "/recording/log.h5"));
  const Answer said = adit_says("convert " + parts + " " + dir + "/saved/log.h5 --json");
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const nlohmann::json answer = nlohmann::json::parse(said.out);
  EXPECT_GE(answer["parts"], 2);
  EXPECT_EQ(answer["notes"].size(), 0u);
  // What was saved is a recording like another: log and truth fit each other.
  const Answer cloud = adit_says("convert " + dir + "/saved/log.h5 " + dir + "/cloud.ply --every 50 --quiet");
  EXPECT_EQ(cloud.exit_code, 0) << cloud.err;
  fs::remove_all(dir);
}

TEST_F(TinyRun, AFullDiskIsReportedByFileAndNoHalfFileIsLeft) {
  const std::string dir = fresh_folder("full");
  const std::string at = scratch("full");
  // No file may grow beyond 2 MB, which a part of the truth does.
  const int status = std::system(("sh -c 'ulimit -f 4000; exec " ADIT_BINARY " drive " + tiny + " --quiet --world " +
                                  out_ + "/world -o " + dir + "' 2>" + at)
                                     .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 74);
  EXPECT_THAT(read_text(at), HasSubstr("truth-0000.h5: cannot write"));
  for (const fs::directory_entry& entry : fs::directory_iterator(dir + "/recording/parts"))
    ADD_FAILURE() << entry.path() << " is left";
  fs::remove_all(dir);
}

}  // namespace
}  // namespace adit
