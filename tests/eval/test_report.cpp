// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "eval/outline.h"
#include "eval/page.h"
#include "eval/render.h"
#include "tests/eval/synthetic_run.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

struct Folder {
  std::string name = scratch("report");
  ~Folder() { fs::remove_all(name); }
};

ReportSettings small_settings() {
  ReportSettings s;
  s.width_px = 600;
  s.interiors = 1;
  s.places = 2;
  s.frames = 2;
  return s;
}

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

// Without the pictures' bytes and without the page's own script.
std::string without_pictures(std::string html) {
  if (const size_t script = html.rfind("<script>"); script != std::string::npos)
    html.erase(script, html.rfind("</script>") + 9 - script);
  for (size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", at + 7))
    html.erase(at + 7, html.find('"', at) - at - 7);
  return html;
}

TEST(Outline, ARingWorldHasAnOuterRimAndOnePillar) {
  const auto rings = plan_outline(ring_world(30, 4, 2, 1.0).mesh);
  ASSERT_EQ(rings.size(), 2u);
  std::vector<double> areas;
  for (const auto& ring : rings) {
    double twice = 0;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    areas.push_back(std::abs(twice / 2));
  }
  std::sort(areas.begin(), areas.end());
  EXPECT_NEAR(areas[0], 22 * 22, 1e-9);
  EXPECT_NEAR(areas[1], 30 * 30, 1e-9);
}

TEST(Outline, WithoutLabelsTheFloorIsWhatLooksDown) {
  Mesh mesh = ring_world(30, 4, 2, 1.0).mesh;
  mesh.label.clear();
  EXPECT_EQ(plan_outline(mesh).size(), 2u);
}

TEST(Outline, AnUprightSectionOfABoxIsItsFourSides) {
  const Mesh box = box_mesh(Vec3(-2, -3, 0), Vec3(2, 3, 2.5));
  double length = 0;
  for (const auto& [a, b] : upright_section(box, Vec2(0.3, 0.2), Vec2(1, 0), 10)) length += (b - a).norm();
  EXPECT_NEAR(length, 2 * 4 + 2 * 2.5, 1e-9);
}

TEST(Outline, AClippedRingKeepsTheAreaInsideOfTheBox) {
  const std::vector<Vec2> diamond = {{0, -2}, {2, 0}, {0, 2}, {-2, 0}};
  const auto clipped = clipped_ring(diamond, Vec2(-1, -1), Vec2(1, 1));
  double twice = 0;
  for (size_t k = 0; k < clipped.size(); ++k) {
    const Vec2 &a = clipped[k], &b = clipped[(k + 1) % clipped.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  EXPECT_NEAR(twice / 2, 4, 1e-12);  // the box touches the diamond's sides with its corners
  EXPECT_FALSE(clipped_stretch({2, 2}, {3, 1}, Vec2(-1, -1), Vec2(1, 1)));
  const auto inside = clipped_stretch({-3, 0}, {3, 0}, Vec2(-1, -1), Vec2(1, 1));
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->first.x(), -1, 1e-12);
  EXPECT_NEAR(inside->second.x(), 1, 1e-12);
}

TEST(Outline, SimplifiedStaysWithinItsTolerance) {
  std::vector<Vec2> line;
  for (int k = 0; k <= 300; ++k) line.emplace_back(0.1 * k, std::sin(0.3 * k));
  const auto kept = simplified(line, 0.05);
  EXPECT_LT(kept.size(), 150u);
  size_t j = 0;
  for (const Vec2& p : line) {
    while (j + 2 < kept.size() && kept[j + 1].x() < p.x()) ++j;
    const Vec2 d = kept[j + 1] - kept[j];
    const double s = std::clamp((p - kept[j]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    EXPECT_LE((p - kept[j] - s * d).norm(), 0.05 + 1e-12);
  }
}

TEST(Number, IsShortAndNeverMinusZero) {
  EXPECT_EQ(plain_number(12.3456), "12.3");
  EXPECT_EQ(plain_number(0.05), "0.05");
  EXPECT_EQ(plain_number(-0.0), "0");
  EXPECT_EQ(plain_number(-2.5), "−2.5");
  EXPECT_EQ(plain_number(1234.5), "1234");
  EXPECT_EQ(plain_number(NAN), "–");
}

class Report : public ::testing::Test {
 protected:
  static const SyntheticRun& run() {
    static const SyntheticRun one = synthetic_run(0.4, 1.0);
    return one;
  }
  // The page of that run, made once.
  static const std::string& page() {
    static const std::string html = [] {
      const Folder once;
      write_report(once.name, run().input(), small_settings());
      return without_pictures(read_text(once.name + "/index.html"));
    }();
    return html;
  }
  Folder folder;
};

TEST_F(Report, EveryFigureIsThereWithAlternativeTextAndItsPng) {
  write_report(folder.name, run().input(), small_settings());
  const std::string html = without_pictures(read_text(folder.name + "/index.html"));
  for (const std::string name : {"plan", "truth", "raw", "aligned", "rounds", "grid", "closures", "errors", "cutaway",
                                 "chamber", "tilt", "coverage", "interior-1", "spot-1", "spot-2"}) {
    EXPECT_EQ(count(html, "<figure id=\"" + name + "\""), 1u) << name;
    EXPECT_TRUE(fs::exists(folder.name + "/" + name + ".png")) << name;
  }
  EXPECT_TRUE(fs::exists(folder.name + "/along.png"));
  EXPECT_EQ(count(html, "<figure id="), 15u);
  EXPECT_EQ(count(html, "role=\"img\" aria-label=\""), 16u);  // the first one twice, for narrow screens too
  EXPECT_EQ(count(html, "aria-label=\"\""), 0u);
  EXPECT_EQ(count(html, "Not shown:"), 0u);
}

TEST_F(Report, NeedsNoNetwork) {
  const std::string& html = page();
  for (const std::string far : {"http:", "https:", "src=", "@import", "url("}) EXPECT_EQ(count(html, far), 0u) << far;
  EXPECT_EQ(count(html, "href=\""), count(html, "href=\"#") + count(html, "href=\"data:image/png"));
}

TEST_F(Report, EveryLinkLeadsToAPlaceOnThePage) {
  const std::string& html = page();
  for (size_t at = html.find("href=\"#"); at != std::string::npos; at = html.find("href=\"#", at + 1)) {
    const std::string target = html.substr(at + 7, html.find('"', at + 7) - at - 7);
    EXPECT_EQ(count(html, "id=\"" + target + "\""), 1u) << target;
  }
}

TEST_F(Report, NamesAndSettingsAreEscaped) {
  SyntheticRun odd = run();
  odd.score.notes = {"<script>alert(1)</script>"};
  odd.score.meta = {{"<script>a", "<script>b"}};
  odd.score.metrics[0].why = "<script>c";
  odd.score.metrics[0].value = NAN;
  odd.estimate.notes = {"a & b <script>"};
  const ReportInput in{
      odd.world, odd.log, odd.truth, odd.estimate, odd.score, "name = \"<script>alert(2)</script>\"", "<script>\"'&"};
  write_report(folder.name, in, small_settings());
  const std::string html = without_pictures(read_text(folder.name + "/index.html"));
  EXPECT_EQ(count(html, "<script"), 1u);  // the data, which no browser runs
  EXPECT_NE(html.find("<script type=\"application/json\""), std::string::npos);
  EXPECT_GE(count(html, "&lt;script&gt;"), 5u);
}

TEST_F(Report, HasTheSameBytesOnAnyNumberOfThreads) {
  std::string first;
  for (const int n : {1, 7}) {
    set_threads(n);
    write_report(folder.name, run().input(), small_settings());
    std::string all;
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder.name)) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    for (const std::string& f : files) all += f + "\n" + read_text(f);
    if (first.empty()) first = all;
    EXPECT_TRUE(all == first) << n << " threads";
  }
  set_threads(0);
}

TEST_F(Report, AnEmptyRunGivesAPageThatSaysWhatIsMissing) {
  const World world;
  const Log log;
  const Truth truth;
  const Estimate estimate;
  const Score score;
  write_report(folder.name, {world, log, truth, estimate, score, "", "nothing"}, small_settings());
  const std::string html = without_pictures(read_text(folder.name + "/index.html"));
  EXPECT_GE(count(html, "Not shown:"), 8u);
  EXPECT_NE(html.find("no map was made"), std::string::npos);
  EXPECT_NE(html.find("The run was not scored"), std::string::npos);
}

TEST_F(Report, WithoutASurfaceTheViewsShowThePoints) {
  SyntheticRun bare = run();
  bare.estimate.surface = {};
  const Picture with = render_view("cutaway", run().input(), small_settings()),
                without = render_view("cutaway", bare.input(), small_settings());
  EXPECT_NE(with.pixel, without.pixel);
  EXPECT_EQ(with.width, without.width);
}

TEST_F(Report, AnUnknownViewIsAnErrorThatListsThoseThereAre) {
  for (const std::string name : {"plam", "interior-0", "spot-999", ""}) {
    try {
      render_view(name, run().input(), small_settings());
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("cutaway"), std::string::npos);
    }
  }
  EXPECT_THROW(render_view("spot-9", run().input(), small_settings()), Error);  // there are two
}

TEST_F(Report, AViewpointIsTakenByPicturesInSpaceAndRefusedByOthers) {
  const auto from = [&](const Vec3& eye, const std::string& view) {
    return render_view(view, run().input(), small_settings(), Viewpoint{eye, Vec3(0, -20, 1), 0.9});
  };
  const Picture near = from(Vec3(2, -20, 1.4), "cutaway"), far = from(Vec3(0, -60, 60), "cutaway");
  EXPECT_EQ(near.width, far.width);
  EXPECT_NE(near.pixel, far.pixel);
  EXPECT_NO_THROW(from(Vec3(2, -20, 1.4), "interior-1"));
  EXPECT_THROW(from(Vec3(2, -20, 1.4), "plan"), Error);
  EXPECT_THROW(from(Vec3(0, -20, 1), "cutaway"), Error);  // the eye where it looks at
}

TEST_F(Report, AMineAloneCanBeLookedInto) {
  const SyntheticRun& whole = run();
  const Log log;
  const Truth truth;
  const Estimate estimate;
  const Score score;
  const ReportInput mine{whole.world, log, truth, estimate, score, "", "mine"};
  const Viewpoint here{Vec3(0, -20, 1.2), Vec3(6, -20, 1), 1};
  const Picture picture = render_view("mine", mine, small_settings(), here);
  EXPECT_EQ(picture.width, 600);
  EXPECT_THROW(render_view("thing-crib", mine, small_settings()), Error);  // there is none
}

TEST_F(Report, WhatTheFolderLacksIsSaidOnTheFirstScreen) {
  ReportInput in = run().input();
  in.missing = {"the <recording>: there is none"};
  write_report(folder.name, in, small_settings());
  const std::string html = read_text(folder.name + "/index.html");
  EXPECT_LT(html.find("the &lt;recording&gt;: there is none"), html.find("<main"));
}

TEST_F(Report, ASignedErrorOfAKnownShiftIsThatShift) {
  // The map is the truth lifted by 0.1 m: its floor stands out into the void, its roof lies in the rock.
  SyntheticRun lifted = run();
  lifted.world = tunnel_world(20, 4, 2, 0.5);
  lifted.estimate.surface = lifted.world.mesh;
  for (Vec3& p : lifted.estimate.surface.vertex) p.z() += 0.1;
  lifted.estimate.points = {};
  lifted.score = {};
  lifted.estimate.path = {};
  const ReportInput in = lifted.input();
  const Exhibit x = make_exhibit(in, small_settings());
  int floor = 0, roof = 0;
  for (size_t v = 0; v < x.surface_W.vertex.size(); ++v) {
    const Vec3& p = lifted.world.mesh.vertex[v];
    if (p.x() < 1 || p.x() > 19 || std::abs(p.y()) > 1.5) continue;  // away from walls and ends
    if (p.z() < 0.01) {
      EXPECT_NEAR(x.surface_error_m[v], 0.1, 1e-5);
      ++floor;
    }
    if (p.z() > 1.99) {
      EXPECT_NEAR(x.surface_error_m[v], -0.1, 1e-5);
      ++roof;
    }
  }
  EXPECT_GT(floor, 50);
  EXPECT_GT(roof, 50);
}

TEST_F(Report, TheVerdictNamesTheWorstAndSaysWhyADriveEnded) {
  SyntheticRun stuck = run();
  EXPECT_NE(verdict(stuck.input()).find("its loop is closed"), std::string::npos);
  EXPECT_NE(verdict(stuck.input()).find("worst at mark 1, off by 31 cm"), std::string::npos);
  stuck.truth.drive.end = DriveEnd::stuck;
  stuck.truth.drive.cause = "The cart stuck at (1, 2)";
  EXPECT_NE(verdict(stuck.input()).find("ended early: The cart stuck at (1, 2)"), std::string::npos);
  EXPECT_EQ(key_numbers(stuck.input()).size(), 6u);
}

}  // namespace
}  // namespace adit
