// SPDX-License-Identifier: BSD-3-Clause
// What mines measure, against the distributions that their settings state.
#include "tests/support/shapes.h"
#include "worlds/stats.h"
#include "worlds/terrain.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

// Power of a series of even steps in bands of its wave number: band b reaches from edges[b] to edges[b + 1], rad/m.
std::vector<double> band_power(const std::vector<double>& f, double step_m, bool ring,
                               const std::vector<double>& edges) {
  const size_t n = f.size();
  std::vector<double> power(edges.size() - 1, 0.0);
  for (size_t k = 1; k <= n / 2; ++k) {
    const double wave = 2 * pi * static_cast<double>(k) / (static_cast<double>(n) * step_m);
    const auto above = std::upper_bound(edges.begin(), edges.end(), wave);
    if (above == edges.begin() || above == edges.end()) continue;
    std::complex<double> sum = 0;
    for (size_t i = 0; i < n; ++i) {
      const double turn = 2 * pi * static_cast<double>(k * i % n) / static_cast<double>(n);
      // A line's ends are faded out (Hann), a ring has none; either way white noise keeps its power.
      const double weight = ring ? 1 : std::sqrt(2.0 / 3) * (1 - std::cos(2 * pi * (i + 0.5) / static_cast<double>(n)));
      sum += weight * f[i] * std::polar(1.0, turn);
    }
    power[above - edges.begin() - 1] += (2 * k == n ? 1 : 2) * std::norm(sum) / static_cast<double>(n * n);
  }
  return power;
}

// What a line through the field shows of it: von Karman's spectrum up to the shortest wave, seen along the line.
// share(a, k): of the waves of length k those whose part along the line is below a.
std::vector<double> expected_power(double rms, double correlation_m, double shortest_m,
                                   const std::vector<double>& edges, const std::function<double(double)>& share) {
  std::vector<double> power(edges.size() - 1, 0.0);
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double k = std::sqrt(std::pow(1 - (i + 0.5) / n, -1 / 0.7) - 1) / correlation_m;
    if (k > 2 * pi / shortest_m) break;
    for (size_t b = 0; b + 1 < edges.size(); ++b)
      power[b] += rms * rms / n * (share(std::min(1.0, edges[b + 1] / k)) - share(std::min(1.0, edges[b] / k)));
  }
  return power;
}

WorldSettings panel(double edge_m) {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = edge_m;
  return s;
}

// Octaves from 6.4 m down to twice an edge of 0.2 m.
const std::vector<double> octaves{2 * pi / 6.4, 2 * pi / 3.2, 2 * pi / 1.6, 2 * pi / 0.8, 2 * pi / 0.4};

// From the finished mesh: the ribs at mid height against those of the same mine without roughness, column by column.
TEST(Statistics, RibsHaveTheSpectrumThatIsStatedDownToTwiceTheEdge) {
  WorldSettings s = panel(0.2);
  s.panel.crosscuts = 3;
  s.panel.stub_share = 0;
  std::vector<double> found(octaves.size() - 1, 0.0);
  double rings = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const World rough = make_world(s, seed);
    WorldSettings even = s;
    even.rib.rms_m = 0;
    const World smooth = make_world(even, seed);
    for (size_t p = 0; p < rough.pillars.size(); ++p) {
      const auto &r = rough.pillars[p].outline, &q = smooth.pillars[p].outline;
      ASSERT_EQ(r.size(), q.size());
      const size_t n = r.size();
      std::vector<double> offset;
      double length = 0;
      for (size_t i = 0; i < n; ++i) {
        const Vec2 along = q[(i + 1) % n] - q[(i + n - 1) % n];
        offset.push_back((r[i] - q[i]).dot(Vec2(along.y(), -along.x()).normalized()));
        length += (q[(i + 1) % n] - q[i]).norm();
      }
      const auto power = band_power(offset, length / static_cast<double>(n), true, octaves);
      for (size_t b = 0; b < power.size(); ++b) found[b] += power[b];
      ++rings;
    }
  }
  // In space the part of a wave along a line is evenly spread.
  const auto expected = expected_power(0.055, 0.55, 0.4, octaves, [](double x) { return x; });
  // Each octave has some 10 to 20 of a field's 96 waves: five fields, some 15 % one sigma; corners bend the lines.
  for (size_t b = 0; b < found.size(); ++b) EXPECT_NEAR(found[b] / rings / expected[b], 1, 0.4) << "octave " << b;
}

TEST(Statistics, FloorAndRoofHaveTheSpectrumThatIsStatedAndNothingBeyondTwiceTheEdge) {
  WorldSettings s = panel(0.2);
  s.grade_percent = s.roll_m = s.height_sd_m = 0;
  const Lattice none{1, {-1e3, -1e3}, 2, 2, {0, 0, 0, 0}};
  std::vector<double> edges = octaves;
  edges.push_back(2 * pi / 0.2);
  std::vector<double> floor(edges.size() - 1, 0.0), roof = floor;
  double lines = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Terrain terrain(s, Vec2::Zero(), none, seed);
    for (int line = 0; line < 5; ++line, ++lines) {
      const double angle = pi * line / 5;
      std::vector<double> f, r;
      for (int i = 0; i < 800; ++i) {
        const Vec2 p = Vec2(40 * line, 7) + 0.1 * i * Vec2(std::cos(angle), std::sin(angle));
        f.push_back(terrain.floor_z(p));
        r.push_back(terrain.roof_z(p) - s.height_m);
      }
      const auto pf = band_power(f, 0.1, false, edges), pr = band_power(r, 0.1, false, edges);
      for (size_t b = 0; b < pf.size(); ++b) floor[b] += pf[b], roof[b] += pr[b];
    }
  }
  // In the plane the part of a wave along a line is its cosine.
  const auto share = [](double x) { return 1 - std::acos(x) * 2 / pi; };
  const auto of_floor = expected_power(0.02, 0.5, 0.4, edges, share),
             of_roof = expected_power(0.02, 1.0, 0.4, edges, share);
  for (size_t b = 0; b + 1 < octaves.size(); ++b) {
    EXPECT_NEAR(floor[b] / lines / of_floor[b], 1, 0.4) << "octave " << b;  // six fields of 96 waves, as above
    EXPECT_NEAR(roof[b] / lines / of_roof[b], 1, 0.5) << "octave " << b;    // fewer of them are short
  }
  EXPECT_LT(floor.back() / floor[3], 0.02);
  EXPECT_LT(roof.back() / roof[3], 0.02);
}

TEST(Statistics, TheMeshsFloorAndRoofLieOnTheirSurfacesExactly) {
  WorldSettings s = panel(0.4);
  s.grade_percent = s.roll_m = s.height_sd_m = 0;
  s.panel.crosscuts = 2;
  const World world = make_world(s, 3);
  const Lattice none{1, {-1e3, -1e3}, 2, 2, {0, 0, 0, 0}};
  const Terrain terrain(s, Vec2::Zero(), none, 3);
  for (size_t f = 0; f < world.mesh.face.size(); ++f) {
    if (world.mesh.label[f] != Label::floor && world.mesh.label[f] != Label::roof) continue;
    const bool floor = world.mesh.label[f] == Label::floor;
    const Vec3 v = world.mesh.corner(f, 0);
    ASSERT_NEAR(v.z(), floor ? terrain.floor_z(v.head<2>()) : terrain.roof_z(v.head<2>()), 1e-12);
  }
}

TEST(Statistics, WidthsHeightsAndGradesMeasureAsStated) {
  WorldSettings s = panel(0.5);
  s.panel.entries = 3;
  s.roll_m = 0;
  MineSamples samples;
  const int mines = 10;
  for (std::uint64_t seed = 0; seed < mines; ++seed) measure(make_world(s, seed), samples);
  const Spread width = spread_of(samples.width_m), height = spread_of(samples.height_m),
               grade = spread_of(samples.grade_percent);
  ASSERT_GT(width.n, 100u);
  // Widths vary by 0.1 m from passage to passage, and by what the wander of two ribs (0.12 m over 8 m) leaves over a
  // passage's length, some 0.1 m.
  EXPECT_NEAR(width.mean, 3.7,
              5 * 0.15 / std::sqrt(static_cast<double>(width.n)) + 0.02);  // 2 cm: roughness in the way
  EXPECT_GT(width.sd, 0.1);
  EXPECT_LT(width.sd, 0.2);
  // Heights vary by 0.1 m over 50 m: two or three places in a mine of 100 m by 50 m are apart.
  EXPECT_NEAR(height.mean, 1.9, 5 * 0.1 / std::sqrt(2.5 * mines));
  EXPECT_GT(height.sd, 0.06);
  EXPECT_LT(height.sd, 0.14);
  // A plane of 0.8 % in a direction that is drawn: along a passage 0.8 % times a cosine, of mean 2 / pi and sd 0.31;
  // the ends' roughness adds 0.1 %. Directions of a mine are two: ten drawn ones.
  EXPECT_NEAR(grade.mean, 0.8 * 2 / pi, 5 * 0.8 * 0.31 / std::sqrt(mines));
  EXPECT_LT(grade.p95, 0.8 + 0.35);
}

TEST(Statistics, RollsMakeLocalGradesOfSomePercent) {
  MineSamples samples;
  for (std::uint64_t seed = 0; seed < 4; ++seed) measure(make_world(panel(0.6), seed), samples);
  const Spread grade = spread_of(samples.grade_percent);
  EXPECT_GT(grade.p50, 0.5);
  EXPECT_LT(grade.p95, 8);  // steeper ones are not known from seams that lie level
}

TEST(Statistics, ThreeWayJunctionsAreCommonerThanFourWayOnes) {
  WorldSettings wide = panel(0.6), rooms, district, bruceton;
  wide.panel.entries = 5;
  rooms.kind = "rooms";
  rooms.rooms.rooms = 4;
  district.kind = "district";
  district.district.length_m = 600;
  bruceton.x_max = -45;
  bruceton.y_max = 182;
  for (WorldSettings* s : {&wide, &rooms, &district, &bruceton}) {
    s->mesh_edge_m = 0.6;
    const World world = make_world(*s, 5);
    std::map<int, int> degrees;
    for (const Junction& j : world.junctions) ++degrees[j.degree()];
    EXPECT_GT(degrees[3], 2 * degrees[4]) << s->kind;  // 2.5 times as many at Bruceton
  }
}

TEST(Statistics, SpreadIsThatOfASmallSample) {
  const Spread s = spread_of({4, 1, 3, 2, 5});
  EXPECT_EQ(s.n, 5u);
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(2.5));
  EXPECT_EQ(s.p50, 3);
  EXPECT_EQ(s.p95, 5);
}

TEST(Statistics, ARipplesRoughnessIsItsHeightOverRootTwo) {
  // Ripples of 1 m in height, of another size on each side; stretches of 4 m hold whole ones.
  World tunnel = tunnel_world(20, 4, 2, 0.1);
  for (Vec3& p : tunnel.mesh.vertex) {
    const double wave = std::sin(2 * pi * p.x());
    if (p.z() < 1e-6) p.z() += 0.03 * wave;
    if (p.z() > 2 - 1e-6) p.z() += 0.05 * wave;
    if (p.x() > 1e-6 && p.x() < 20 - 1e-6) p.y() += std::abs(p.y()) > 2 - 1e-6 ? 0.08 * wave : 0;
  }
  MineSamples samples;
  measure(tunnel, samples);
  ASSERT_EQ(samples.floor_rough_m.size(), 1u);
  // Straight faces of 0.1 m cut a ripple of 1 m by up to 1 - cos(0.1 pi) = 5 % between its vertices.
  EXPECT_NEAR(samples.floor_rough_m[0], 0.03 / std::sqrt(2), 0.05 * 0.03);
  EXPECT_NEAR(samples.roof_rough_m[0], 0.05 / std::sqrt(2), 0.05 * 0.05);
  EXPECT_NEAR(samples.rib_rough_m[0], 0.08 / std::sqrt(2), 0.05 * 0.08);
}

}  // namespace
}  // namespace adit
