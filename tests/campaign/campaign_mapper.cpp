// SPDX-License-Identifier: BSD-3-Clause
// The planar part of the mapper on recordings that are there already, held against their truth: a line a recording.
//   campaign_mapper [KEY=VALUE...] DIR...   DIR/recording/{log,truth}.h5 as `adit drive` writes them; keys are those below
//                                           [map]; campaign.detail=FILE writes a line a step and a closure of the last one
// A .clf in place of DIR is a real log without truth: its path goes to campaign.detail as TUM.
// Errors are those of the mapping laser's pose in the plane: what scan matching fixes is the place of the laser, not that
// of the body below it.
#include "base/carmen.h"
#include "base/config.h"
#include "base/error.h"
#include "base/parallel.h"
#include "mapper/mapper.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numbers>

namespace {

using namespace adit;
using Mat3 = Eigen::Matrix3d;

constexpr double degree = std::numbers::pi / 180;

struct Case {
  Log log;
  Truth truth;
  int laser;
};

/// True poses of the laser in the plane, seen as poses of a body on which it is mounted as the rig says.
std::vector<Pose2> true_poses(const Case& c) {
  const Pose2 X_SB = flatten(c.log.rig.mounts[c.laser].X_BS).inverse();
  std::vector<Pose2> X;
  for (const double t : c.truth.scans[c.laser].stamp_s)
    X.push_back(flatten(c.truth.drive.path.at(t) * c.truth.rig.mounts[c.laser].X_BS) * X_SB);
  const Pose2 first = X.front().inverse();
  for (Pose2& x : X) x = first * x;
  return X;
}

Vec3 error_of(const Pose2& X, const Pose2& X_true) {
  const Pose2 e = X.inverse() * X_true;
  return {e.x_m, e.y_m, e.yaw_rad};
}

double ate_m(const std::vector<Pose2>& X, const std::vector<Pose2>& T) {
  Vec2 mx = Vec2::Zero(), mt = Vec2::Zero();
  for (size_t i = 0; i < X.size(); ++i) mx += X[i].position(), mt += T[i].position();
  mx /= X.size(), mt /= X.size();
  double c = 0, s = 0;
  for (size_t i = 0; i < X.size(); ++i) {
    const Vec2 a = X[i].position() - mx, b = T[i].position() - mt;
    c += a.dot(b), s += a.x() * b.y() - a.y() * b.x();
  }
  const double yaw = std::atan2(s, c);
  const Pose2 R{0, 0, yaw};
  double sum = 0;
  for (size_t i = 0; i < X.size(); ++i) sum += (R * Vec2(X[i].position() - mx) - (T[i].position() - mt)).squaredNorm();
  return std::sqrt(sum / X.size());
}

/// Errors over stretches of the way, and how well their covariance foretells them.
struct Relatives {
  double percent = 0, deg = 0, anees = 0, inside = 0;
  Vec3 axes = Vec3::Zero();  // mean of e^2 / C of x, y, yaw each
  int n = 0;
};

Relatives relatives(const Odometry& o, const std::vector<Pose2>& T, double way_m) {
  const Chain chain = chain_of(o, way_m);
  Relatives r;
  for (size_t k = 0; k + 1 < chain.scan.size(); ++k) {
    const int a = chain.scan[k], b = chain.scan[k + 1];
    const double length = chain.along_m[b] - chain.along_m[a];
    if (length < 0.5 * way_m) continue;
    const Vec3 e = error_of(chain.step[k].X_ij, T[a].inverse() * T[b]);
    const double chi2 = e.dot(chain.step[k].information * e);
    r.percent += e.head<2>().norm() / length * 100, r.deg += std::abs(e.z()) / degree, r.anees += chi2 / 3;
    r.inside += chi2 < 7.815;
    r.axes += e.cwiseAbs2().cwiseQuotient(chain.step[k].information.inverse().diagonal());
    ++r.n;
  }
  const double n = std::max(1, r.n);
  r.percent /= n, r.deg /= n, r.anees /= n, r.inside /= n, r.axes /= n;
  return r;
}

struct Spread {
  std::vector<double> x;
  void add(double v) { x.push_back(std::abs(v)); }
  double at(double share) {
    if (x.empty()) return 0;
    std::sort(x.begin(), x.end());
    return x[std::min(x.size() - 1, static_cast<size_t>(share * x.size()))];
  }
};

std::string line_of(const std::string& name, const Case& c, const MapSettings& s, const std::string& detail) {
  const Mount& mount = c.log.rig.mounts[c.laser];
  const Scans& scans = c.log.scans[c.laser];
  const std::vector<Pose2> T = true_poses(c);
  const auto begin = std::chrono::steady_clock::now();
  const Odometry o = estimate_motion(scans, mount, s.odometry);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  Spread ex, ey, eyaw;
  double anees = 0, worst = 0;
  int jumps = 0, last = 0;
  std::ofstream out(detail.empty() ? "/dev/null" : detail);
  for (size_t i = 1; i < T.size(); ++i) {
    const Pose2 step = T[i - 1].inverse() * T[i];
    const Vec3 e = error_of(o.X_step[i], step);
    const double chi2 = e.dot(o.information[i] * e);
    if (!detail.empty()) {
      const Mat3 C = o.information[i].inverse();
      out << i << ' ' << scans.stamp_s[i] << ' ' << e.transpose() << ' ' << std::sqrt(C(0, 0)) << ' '
          << std::sqrt(C(1, 1)) << ' ' << std::sqrt(C(2, 2)) << ' ' << chi2 << ' ' << step.position().norm() << ' '
          << step.yaw_rad << '\n';
    }
    if (step.position().norm() < 0.02 && std::abs(step.yaw_rad) < 0.2 * degree) continue;
    ex.add(e.x()), ey.add(e.y()), eyaw.add(e.z() / degree);
    anees += chi2 / 3;
    if (e.head<2>().norm() > 0.1 || std::abs(e.z()) > degree) ++jumps, last = static_cast<int>(i);
    worst = std::max(worst, e.head<2>().norm());
  }
  const Relatives r1 = relatives(o, T, 1), r5 = relatives(o, T, 5), r20 = relatives(o, T, 20),
                  r100 = relatives(o, T, 100);
  double aligned_m = 0, rematched_m = 0, coverage = 0, pose_anees = 0;
  int accepted = 0, wrong = 0, ambiguous = 0;
  if (s.method == "robust") {
    const OdometrySettings found = at_ribs(s.odometry, o);
    const std::vector<ScanPoints> points = scan_points(scans, mount, o.X_MB, found.points);
    const Chain chain = chain_of(o, s.robust.node_m);
    const Aligned a = align_robust(o, match_by_scans(points, chain, o, s.places, found.match), s.robust);
    aligned_m = ate_m(a.X_MB, T);
    rematched_m = ate_m(rematch(points, a.X_MB, s.rematch, found.match), T);
    for (const Closure& l : a.closures) {
      accepted += l.accepted, ambiguous += l.ambiguous;
      const Vec3 e = error_of(l.X_ij, T[l.i].inverse() * T[l.j]);
      wrong += l.accepted && (e.head<2>().norm() > 0.5 || std::abs(e.z()) > 3 * degree);  // as the score has it
      if (!detail.empty())
        out << "closure " << l.i << ' ' << l.j << ' ' << l.accepted << ' ' << l.ambiguous << ' ' << l.X_ij.x_m << ' '
            << l.X_ij.y_m << ' ' << l.X_ij.yaw_rad << ' ' << e.transpose() << ' '
            << error_of(l.X_ij, a.X_MB[l.i].inverse() * a.X_MB[l.j]).transpose() << '\n';
    }
    for (size_t i = 1; i < a.covariance.size(); ++i) {
      const Vec3 e = error_of(a.X_MB[i], T[i]);
      const double chi2 = e.dot(a.covariance[i].ldlt().solve(e));
      coverage += chi2 < 7.815, pose_anees += chi2 / 3;
    }
    coverage /= std::max<size_t>(1, a.covariance.size() - 1),
        pose_anees /= std::max<size_t>(1, a.covariance.size() - 1);
  }
  char text[1200];
  std::snprintf(
      text, sizeof text,
      "%-14s n %zu lost %d deg %zu jumps %d (last %d) worst %.3f | step mm %.2f %.2f yaw %.3f p95 %.1f %.1f %.3f anees "
      "%.2f | "
      "1m %.2f%% %.2f/%.2f 5m %.3f%% %.2f/%.2f 20m %.3f%% %.2f/%.2f 100m %.3f%% %.2fdeg | sig %.3f axes1 %.2f %.2f "
      "%.2f axes5 %.2f %.2f %.2f axes20 %.2f %.2f %.2f axes100 %.2f %.2f %.2f | open %.3f aligned %.3f rematch %.3f "
      "closures %d wrong %d amb %d cover %.2f anees %.2f | %.0f/s",
      name.c_str(), T.size(), o.lost, o.degenerate.size(), jumps, last, worst, 1e3 * ex.at(.5), 1e3 * ey.at(.5),
      eyaw.at(.5), 1e3 * ex.at(.95), 1e3 * ey.at(.95), eyaw.at(.95), anees / std::max<size_t>(1, ex.x.size()),
      r1.percent, r1.anees, r1.inside, r5.percent, r5.anees, r5.inside, r20.percent, r20.anees, r20.inside,
      r100.percent, r100.deg, o.rib_sigma_m, r1.axes[0], r1.axes[1], r1.axes[2], r5.axes[0], r5.axes[1], r5.axes[2],
      r20.axes[0], r20.axes[1], r20.axes[2], r100.axes[0], r100.axes[1], r100.axes[2], ate_m(o.X_MB, T), aligned_m,
      rematched_m, accepted, wrong, ambiguous, coverage, pose_anees, T.size() / seconds);
  return text;
}

/// A log without truth: its planar path as TUM.
void map_log(const std::string& file, const MapSettings& s, const std::string& out) {
  const Log log = read_carmen(file).log;
  const int laser = find_view(log.rig, View::horizontal);
  const Odometry o = estimate_motion(log.scans[laser], log.rig.mounts[laser], s.odometry);
  const OdometrySettings found = at_ribs(s.odometry, o);
  const std::vector<ScanPoints> points = scan_points(log.scans[laser], log.rig.mounts[laser], o.X_MB, found.points);
  const Chain chain = chain_of(o, s.robust.node_m);
  const Aligned a = align_robust(o, match_by_scans(points, chain, o, s.places, found.match), s.robust);
  const std::vector<Pose2> X = rematch(points, a.X_MB, s.rematch, found.match);
  Trajectory path{o.stamp_s, {}};
  for (const Pose2& x : X) path.X_WB.push_back(lift(x));
  write_tum(out, path);
  std::printf("%s: %zu scans, lost %d, ribs %.3f m, closures %zu\n", file.c_str(), X.size(), o.lost, o.rib_sigma_m,
              a.closures.size());
}

}  // namespace

int main(int argc, char** argv) {
  MapSettings settings;
  std::string detail;
  Fields all = fields(settings);
  all.emplace_back("campaign.detail", &detail, "file");
  set_threads(1);
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      if (word.find('=') != std::string::npos) {
        set_field(all, word);
        continue;
      }
      if (word.ends_with(".clf")) {
        map_log(word, settings, detail);
        continue;
      }
      Case c{load_log(word + "/recording/log.h5"), load_truth(word + "/recording/truth.h5"), 0};
      c.laser = find_view(c.log.rig, View::horizontal);
      const std::string name = word.substr(word.rfind('/', word.rfind('/') - 1) + 1);
      std::cout << line_of(name, c, settings, detail) << std::endl;
    }
  } catch (const std::exception& e) {
    std::cerr << "campaign_mapper: " << e.what() << '\n';
    return 2;
  }
}
