// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/odometry.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>

namespace adit {
namespace {

using Mat3 = Eigen::Matrix3d;
constexpr double degree = std::numbers::pi / 180;

struct KeyScan {
  ScanPoints points;
  Pose2 X_MB;
};

LocalMap map_of(const std::deque<KeyScan>& keys) {
  std::vector<const ScanPoints*> scans;
  std::vector<Pose2> poses;
  for (const KeyScan& k : keys) scans.push_back(&k.points), poses.push_back(k.X_MB);
  return LocalMap(scans, poses);
}

// Pairs are sought as far off as the ribs may be.
MatchSettings with_sigma(const MatchSettings& s, double rib_sigma_m) {
  MatchSettings out = s;
  out.map_sigma_m = rib_sigma_m;
  out.gate_end_m = std::max(s.gate_end_m, std::min(0.5, 4 * rib_sigma_m));
  return out;
}

// Ribs that are off by a decimetre anyway are no worse where floor and roof may be met.
OdometrySettings seeing_far(const OdometrySettings& s) {
  OdometrySettings out = s;
  out.points.range_max_m = std::max(s.points.range_max_m, s.uneven_range_m);
  return out;
}

Mat3 prediction_information(double dt_s, const OdometrySettings& s) {
  const double m = s.speed_change_m_s2 * dt_s * dt_s + 1e-4, rad = s.turn_change_deg_s2 * degree * dt_s * dt_s + 1e-5;
  return Vec3(1 / (m * m), 1 / (m * m), 1 / (rad * rad)).asDiagonal();
}

// How far a stretch in which one direction is only predicted can have gone astray: the error of a speed that wanders up
// to its spread.
class Drift {
 public:
  Drift(double speed_sigma_m_s, const OdometrySettings& s)
      : v_(speed_sigma_m_s * speed_sigma_m_s), most_v_(std::max(v_, s.speed_spread_m_s * s.speed_spread_m_s)) {}
  void step(double dt_s) {
    constexpr double wander_s = 5;  // a pusher's speed has forgotten itself after some seconds
    p_ += 2 * pv_ * dt_s + v_ * dt_s * dt_s;
    pv_ += v_ * dt_s;
    v_ = std::min(most_v_, v_ + most_v_ * dt_s / wander_s);
  }
  double sigma_m() const { return std::sqrt(p_); }

 private:
  double p_ = 0, pv_ = 0, v_, most_v_;
};

// What one step came to.
struct Step {
  Pose2 X_MB, X_step;
  Mat3 information, jitter = Mat3::Zero();
  bool placed = false, degenerate = false, breaks = false;
  double known_share = 0, rib_sigma_m = 0;
  Vec2 weak_direction = Vec2::UnitX();
  ScanPoints points;
};

/// The state that goes from scan to scan.
class Tracker {
 public:
  /// @param learns  takes ribs for as uneven as the scans before have shown them to be
  Tracker(const Scans& scans, const Mount& mount, const OdometrySettings& s, bool learns,
          const std::vector<Stance>& stances)
      : scans_(scans),
        stances_(stances),
        fan_(fan_of(mount)),
        s_(s),
        match_(s.match),
        learns_(learns),
        scan_s_(fan_.scan_s()),
        nods_at_stands_(mount.tilt.nods() && mount.tilt.standing_only) {}

  /// With scan i at a pose, moving as told.
  void begin(size_t i, const Pose2& X_MB, const Twist2& twist) {
    twist_ = twist;
    add_key({points_of(i, twist), X_MB});
  }

  Step advance(size_t i, const Pose2& X_before, double dt_s) {
    const bool gap = dt_s > max_gap_s;
    if (gap) twist_ = {};
    const Pose2 predicted = X_before * pose_after(twist_, dt_s);
    const PosePrior prior{predicted, prediction_information(dt_s, s_)};
    Step out;
    out.X_MB = predicted;
    out.information = prior.information;
    out.points = points_of(i, twist_);
    std::optional<Match> match = gap ? std::nullopt : place(out.points, predicted, prior, X_before, dt_s);
    if (match && worth_a_second_look(X_before, match->X_AB, dt_s)) {
      const Twist2 better = twist_of(X_before.inverse() * match->X_AB, dt_s);
      out.points = points_of(i, better);
      match = place(out.points, match->X_AB, prior, X_before, dt_s);
    }
    if (!match) match = search(out.points, predicted, X_before, dt_s);
    if (gap && !nods_at_stands_ && !(match && match->known_share >= sure_share && !match->degenerate)) {
      out.breaks = true;
      begin_at(out);
      return out;
    }
    if (match) {
      out.X_MB = match->X_AB;
      out.placed = true;
      out.degenerate = match->degenerate;
      out.known_share = match->known_share;
      learn(uneven_m(out.points, map_, match->X_AB, s_.match));
      out.rib_sigma_m = std::hypot(s_.match.map_sigma_m, std::sqrt(uneven_m2_));
      out.weak_direction = match->weak_direction;
      out.information = match->information + (match->degenerate ? prior.information : Mat3::Zero());
      out.jitter = out.information.inverse();
      if (!gap) twist_ = twist_of(X_before.inverse() * out.X_MB, dt_s);
    }
    keep(out);
    return out;
  }

 private:
  static constexpr double max_gap_s = 1.5;
  static constexpr double sure_share = 0.7;  // of a scan's points on the map, to know where one is after a gap
  static constexpr int lost_for_good = 5;    // scans in a row; then the map begins anew where the prediction ended

  ScanPoints points_of(size_t i, const Twist2& twist) const {
    return scan_points(scans_[i], fan_, twist, s_.points, stances_.empty() ? nullptr : &stances_[i]);
  }

  bool plausible(const Match& m, const Pose2& X_before, double dt_s) const {
    const Pose2 step = X_before.inverse() * m.X_AB;
    return m.converged && step.position().norm() < s_.most_speed_m_s * std::max(dt_s, 0.05) + 0.1;
  }

  std::optional<Match> place(const ScanPoints& points, const Pose2& guess, const PosePrior& prior,
                             const Pose2& X_before, double dt_s) const {
    const Match m = match_scan(points, map_, guess, match_, prior);
    return plausible(m, X_before, dt_s) ? std::optional(m) : std::nullopt;
  }

  std::optional<Match> search(const ScanPoints& points, const Pose2& predicted, const Pose2& X_before,
                              double dt_s) const {
    const SearchWindow window{s_.search_m, s_.search_deg * degree};
    const WideMatch wide = search_scan(points, map_, predicted, window, match_);
    return plausible(wide.best, X_before, dt_s) ? std::optional(wide.best) : std::nullopt;
  }

  // How even ribs are is learnt over some ten scans.
  void learn(double uneven_m) {
    uneven_m2_ += 0.1 * (uneven_m * uneven_m - uneven_m2_);
    if (learns_) match_ = with_sigma(s_.match, std::sqrt(s_.match.map_sigma_m * s_.match.map_sigma_m + uneven_m2_));
  }

  // The beams were taken back by the predicted motion: again, if the motion was another by what one sees.
  bool worth_a_second_look(const Pose2& X_before, const Pose2& X_MB, double dt_s) const {
    const Twist2 t = twist_of(X_before.inverse() * X_MB, dt_s);
    const double moved = std::hypot(t.x_m_s - twist_.x_m_s, t.y_m_s - twist_.y_m_s) * scan_s_;
    return moved > 1e-3 || std::abs(t.yaw_rad_s - twist_.yaw_rad_s) * scan_s_ > 3e-4;
  }

  void keep(const Step& step) {
    lost_ = step.placed ? 0 : lost_ + 1;
    if (lost_ >= lost_for_good && step.points.size() >= 30) return begin_at(step);
    if (!step.placed) return;
    const Pose2 off = keys_.back().X_MB.inverse() * step.X_MB;
    // What the map does not know must enter it, even if the cart seems to stand: where the way along a smooth passage
    // is open, only what comes into view tells that it rolls.
    const bool moved = off.position().norm() >= s_.key_step_m || std::abs(off.yaw_rad) >= s_.key_step_deg * degree;
    if (!moved && step.known_share > 1 - s_.new_share) return;
    add_key({step.points, step.X_MB});
  }

  // The map begins anew with this scan.
  void begin_at(const Step& step) {
    keys_.clear();
    add_key({step.points, step.X_MB});
    lost_ = 0;
  }

  void add_key(KeyScan key) {
    keys_.push_back(std::move(key));
    if (keys_.size() > static_cast<size_t>(s_.key_scans)) keys_.pop_front();
    map_ = map_of(keys_);
  }

  const Scans& scans_;
  const std::vector<Stance>& stances_;
  const BeamFan fan_;
  const OdometrySettings& s_;
  MatchSettings match_;  // as the ribs of the last seconds are
  const bool learns_;
  const double scan_s_;
  const bool nods_at_stands_;  // its level scans are far apart only where the vehicle stands
  double uneven_m2_ = 0;
  Twist2 twist_;
  std::deque<KeyScan> keys_;
  LocalMap map_;
  int lost_ = 0;
};

// A direction in which a step was only predicted.
struct Weak {
  bool is = false;
  Vec2 direction = Vec2::UnitX();  // in B
};

// Runs of steps whose motion was only predicted in some direction, with the sigma to which each has grown.
std::vector<DegenerateStretch> stretches_of(const std::vector<double>& stamp_s, const std::vector<Weak>& weak,
                                            const OdometrySettings& s) {
  constexpr double bridge_s = 1.0;  // a single good scan between two weak ones does not tell the length
  std::vector<DegenerateStretch> out;
  std::optional<Drift> drift;
  for (size_t i = 1; i < weak.size(); ++i) {
    if (!weak[i].is) continue;
    if (out.empty() || stamp_s[i - 1] - out.back().to_s > bridge_s) {
      out.push_back({stamp_s[i - 1], stamp_s[i], 0});
      // The speed is known from the scans before; at the very start nothing is.
      drift.emplace(i == 1 ? s.most_speed_m_s / 3 : 0.1 * s.speed_spread_m_s, s);
    }
    drift->step(stamp_s[i] - stamp_s[i - 1]);
    out.back().to_s = stamp_s[i];
    out.back().sigma_m = drift->sigma_m();
  }
  return out;
}

// The errors of a predicted stretch hang together, those of a chain of steps are taken for independent: each weak step
// is told so much less certain that the chain ends at the sigma of the stretch.
void weaken(const std::vector<double>& stamp_s, const std::vector<Weak>& weak,
            const std::vector<DegenerateStretch>& stretches, std::vector<Mat3>& information) {
  for (const DegenerateStretch& d : stretches) {
    std::vector<size_t> steps;
    for (size_t i = std::upper_bound(stamp_s.begin(), stamp_s.end(), d.from_s) - stamp_s.begin();
         i < stamp_s.size() && stamp_s[i] <= d.to_s; ++i)
      if (weak[i].is) steps.push_back(i);
    const double least = static_cast<double>(steps.size()) / (d.sigma_m * d.sigma_m);
    for (const size_t i : steps) {
      const Vec3 v(weak[i].direction.x(), weak[i].direction.y(), 0);
      const double over = 1 - least / v.dot(information[i] * v);
      if (over <= 0) continue;
      const Mat3 scale = Mat3::Identity() - (1 - std::sqrt(1 - over)) * v * v.transpose();
      information[i] = scale * information[i] * scale;
    }
  }
}

/// Scans that are matched one after the other, by one tracker.
struct Run {
  size_t warm, begin, end;  // from `warm` on its map grows; steps to the scans from `begin` on are its own
};

/// One run, or many that can be made at the same time where a first path tells how each begins. Their number is the log's,
/// not the machine's.
std::vector<Run> runs_of(size_t scans, const Odometry* first) {
  constexpr size_t length = 600;
  constexpr double warm_m = 8;  // as far as the local map reaches back
  if (!first) return {{0, 1, scans}};
  std::vector<Run> runs;
  for (size_t begin = 1; begin < scans; begin += length) {
    size_t warm = begin - 1;
    for (double way_m = 0; warm > 0 && way_m < warm_m; --warm) way_m += first->X_step[warm].position().norm();
    runs.push_back({warm, begin, std::min(begin + length, scans)});
  }
  return runs;
}

/// @param first  an earlier path of the same scans, or none
Odometry track(const Scans& scans, const Mount& horizontal, const OdometrySettings& settings, bool learns,
               const std::vector<Stance>& stances, const Odometry* first, const Progress& progress) {
  const size_t n = scans.size();
  std::vector<Step> steps(n);
  const std::vector<Run> runs = runs_of(n, first);
  parallel_for(runs.size(), [&](size_t r) {
    const Run& run = runs[r];
    Tracker tracker(scans, horizontal, settings, learns, stances);
    Pose2 X = first ? first->X_MB[run.warm] : Pose2{};
    const auto dt_s = [&](size_t i) { return scans.stamp_s[i] - scans.stamp_s[i - 1]; };
    tracker.begin(run.warm, X, run.warm > 0 ? twist_of(first->X_step[run.warm], dt_s(run.warm)) : Twist2{});
    for (size_t i = run.warm + 1; i < run.end; ++i) {
      Step step = tracker.advance(i, X, dt_s(i));
      step.points = {};
      step.X_step = X.inverse() * step.X_MB;
      X = X * step.X_step;
      if (i >= run.begin) steps[i] = step;
      if (r == 0 && (i % 50 == 0 || i + 1 == run.end))
        progress("match scans", static_cast<double>(i + 1), static_cast<double>(run.end));
    }
  });
  Odometry out;
  out.stamp_s = scans.stamp_s;
  out.X_MB.assign(n, Pose2{});
  out.X_step.assign(n, Pose2{});
  out.information.assign(n, Mat3::Identity());
  out.jitter.assign(n, Mat3::Zero());
  std::vector<Weak> weak(n);
  std::vector<double> rib_sigma_m{settings.match.map_sigma_m};
  for (size_t i = 1; i < n; ++i) {
    const Step& step = steps[i];
    out.X_step[i] = step.X_step;
    out.X_MB[i] = out.X_MB[i - 1] * out.X_step[i];
    out.information[i] = settings.information_scale * step.information;
    out.jitter[i] = step.jitter;
    weak[i] = {step.degenerate || !step.placed, step.weak_direction};
    out.lost += !step.placed;
    if (step.placed) rib_sigma_m.push_back(step.rib_sigma_m);
    if (step.breaks) out.breaks.push_back(i);
  }
  const auto middle = rib_sigma_m.begin() + static_cast<std::ptrdiff_t>(rib_sigma_m.size() / 2);
  std::nth_element(rib_sigma_m.begin(), middle, rib_sigma_m.end());
  out.rib_sigma_m = *middle;
  out.steadiness = learns ? 1 : settings.steadiness;
  out.degenerate = stretches_of(scans.stamp_s, weak, settings);
  weaken(scans.stamp_s, weak, out.degenerate, out.information);
  return out;
}

}  // namespace

Fields fields(OdometrySettings& s) {
  Fields all = fields(s.points);
  append(all, "match", fields(s.match));
  const Fields own{
      {"key_scans", &s.key_scans, "past key scans that make the map which a scan is matched to", 1, 1000},
      {"key_step_m", &s.key_step_m, "way between key scans", 0.01, 10},
      {"key_step_deg", &s.key_step_deg, "turn between key scans", 0.1, 180},
      {"speed_change_m_s2", &s.speed_change_m_s2, "change of speed, 1 sd, for the prediction", 0.001, 100},
      {"turn_change_deg_s2", &s.turn_change_deg_s2, "change of turning, 1 sd, for the prediction", 0.1, 10000},
      {"speed_spread_m_s", &s.speed_spread_m_s, "of the speed about its mean, 1 sd", 0.001, 10},
      {"new_share", &s.new_share, "of a scan's points not on the map, to make it a key scan", 0, 1},
      {"search_m", &s.search_m, "half width of the search where matching fails", 0.1, 10},
      {"search_deg", &s.search_deg, "half width of the search where matching fails", 1, 180},
      {"most_speed_m_s", &s.most_speed_m_s, "a faster match is a wrong one", 0.1, 100},
      {"uneven_from", &s.uneven_from, "ribs are uneven beyond so many times match.map_sigma_m", 1, 1000},
      {"uneven_range_m", &s.uneven_range_m, "range_max_m where ribs are uneven, if that is less", 1, 1000},
      {"steadiness", &s.steadiness, "how many times less than its scans' errors the map of even ribs drifts, variances",
       1, 1000},
      {"information_scale", &s.information_scale, "of a step against that of its match, by trial", 1e-6, 1e6}};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

Fields fields(SpaceSettings& s) {
  return {{"use", &s.use, "match a second time, in space, where the rig sees height, pitch and roll"},
          {"range_max_m", &s.range_max_m, "then longer ranges are not taken for ribs", 1, 1000},
          {"key_step_m", &s.key_step_m, "then: way between key scans", 0.01, 10},
          {"key_scans", &s.key_scans, "then: past key scans that make the map", 1, 1000},
          {"steadiness", &s.steadiness, "then: odometry.steadiness", 1, 1000}};
}

OdometrySettings in_space(const OdometrySettings& settings, const SpaceSettings& space, const Odometry& first) {
  OdometrySettings out = settings;
  out.points.range_max_m = std::max(settings.points.range_max_m, space.range_max_m);
  out.key_step_m = space.key_step_m;
  out.key_scans = space.key_scans;
  out.steadiness = first.uneven ? 1 : space.steadiness;
  return out;
}

OdometrySettings at_ribs(const OdometrySettings& settings, const Odometry& odometry) {
  if (!odometry.uneven) return settings;
  OdometrySettings out = seeing_far(settings);
  out.match = with_sigma(settings.match, odometry.rib_sigma_m);
  return out;
}

Odometry estimate_motion(const Scans& scans, const Mount& horizontal, const OdometrySettings& settings,
                         const Progress& progress, const std::vector<Stance>& stances, const Odometry* first) {
  const size_t n = scans.size();
  ADIT_CHECK(stances.empty() || stances.size() == n);
  ADIT_CHECK(!first || first->X_MB.size() == n);
  if (n == 0) throw Error("laser '" + horizontal.name + "': no scan; a map needs at least one");
  for (size_t i = 1; i < n; ++i)
    if (!(scans.stamp_s[i] > scans.stamp_s[i - 1]))
      throw Error("laser '" + horizontal.name + "': scan " + std::to_string(i) + ": its stamp, " +
                  std::to_string(scans.stamp_s[i]) + " s, is not after that of the scan before; stamps must grow");
  Odometry even = track(scans, horizontal, settings, false, stances, first, progress);
  if (even.rib_sigma_m <= settings.uneven_from * settings.match.map_sigma_m) return even;
  OdometrySettings patient = seeing_far(settings);
  patient.match.iterations *= 3;  // pairs flip to and fro between the layers of the map
  Odometry uneven = track(scans, horizontal, patient, true, stances, first, progress);
  uneven.uneven = true;
  return uneven;
}

}  // namespace adit
