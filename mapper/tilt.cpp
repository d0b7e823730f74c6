// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/tilt.h"

#include "base/error.h"
#include "base/parallel.h"
#include "mapper/sparse_solve.h"
#include "mapper/spline.h"
#include "mapper/tilt_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

/// z, pitch and roll at one instant.
using Tilt = Vec3;

/// The motion as the unknowns say it.
struct Motion {
  PlanarMotion planar;
  KnotClock clock;
  Vec3 p_BH;                  // the horizontal laser, whose place in plan the planar poses fix
  std::vector<Tilt> control;  // (clock.controls())

  Tilt tilt(const SplineWeights& w) const {
    Tilt sum = Tilt::Zero();
    for (int k = 0; k < 4; ++k) sum += w.weight[k] * control[w.first + k];
    return sum;
  }
  Pose at(double t_s) const {
    const Pose2 X = planar.at(t_s);
    const Tilt tilted = tilt(clock.at(t_s));
    Pose X_MB = pose_of({0, 0, tilted[0]}, X.yaw_rad, tilted[1], tilted[2]);
    X_MB.translation().head<2>() = X * Vec2(p_BH.head<2>()) - (X_MB.linear() * p_BH).head<2>();
    return X_MB;
  }
};

/// A point of the body in M, and how it moves with z, pitch and roll.
struct MovedPoint {
  Vec3 p_M;
  Eigen::Matrix3d by_tilt;  // columns: by z, pitch, roll
  Vec3 direction_M;
};

MovedPoint moved_point(const Motion& motion, const TiltBeam& beam, double bias_m, const SplineWeights& w) {
  const Pose2 X = motion.planar.at(beam.at_s);
  const Tilt tilt = motion.tilt(w);
  const Vec3 p = beam.p_B - bias_m * beam.direction_B;
  const Eigen::Matrix3d Rz = rotation_of(X.yaw_rad, 0, 0), Ry = rotation_of(0, tilt[1], 0),
                        Rx = rotation_of(0, 0, tilt[2]);
  // d R(a)/da = [axis]x R(a), with z left to the height alone and x, y relative to the horizontal laser.
  const Vec3 rolled = Rx * p, rolled_H = Rx * motion.p_BH, pitched = Ry * rolled, pitched_H = Ry * rolled_H;
  const auto derivative = [&](const Vec3& dp, const Vec3& dp_H) {
    Vec3 d = Rz * dp;
    d.head<2>() -= (Rz * dp_H).head<2>();
    return d;
  };
  MovedPoint moved;
  moved.p_M = Rz * pitched;
  moved.p_M.head<2>() += X * Vec2(motion.p_BH.head<2>()) - (Rz * pitched_H).head<2>();
  moved.p_M.z() += tilt[0];
  moved.by_tilt.col(0) = Vec3::UnitZ();
  moved.by_tilt.col(1) = derivative(Vec3::UnitY().cross(pitched), Vec3::UnitY().cross(pitched_H));
  moved.by_tilt.col(2) = derivative(Ry * Vec3::UnitX().cross(rolled), Ry * Vec3::UnitX().cross(rolled_H));
  moved.direction_M = Rz * Ry * Rx * beam.direction_B;
  return moved;
}

/// Heights of floor and roof on a lattice in plan; a node exists where a beam came near.
struct Lattice {
  double node_m = 0;
  Vec2 origin = Vec2::Zero();
  int width = 0, height = 0;
  std::vector<int> number;    // (2 x height x width) of the node among the unknowns, -1 where none is
  std::vector<double> value;  // (2 x height x width) heights of the last solution
  int nodes = 0;

  size_t index(bool roof, int i, int j) const { return (static_cast<size_t>(roof) * height + j) * width + i; }
};

/// Where a beam hangs between four nodes.
struct Cell {
  std::array<size_t, 4> node;  // in Lattice, rising
  std::array<double, 4> weight;
  Vec2 slope;  // of the last solution
};

Cell cell_of(const Lattice& lattice, const TiltBeam& beam, const Vec3& p_M) {
  const Vec2 q = (p_M.head<2>() - lattice.origin) / lattice.node_m;
  const int i = std::clamp(static_cast<int>(q.x()), 0, lattice.width - 2);
  const int j = std::clamp(static_cast<int>(q.y()), 0, lattice.height - 2);
  const double u = q.x() - i, v = q.y() - j;
  Cell cell;
  cell.node = {lattice.index(beam.roof, i, j), lattice.index(beam.roof, i + 1, j), lattice.index(beam.roof, i, j + 1),
               lattice.index(beam.roof, i + 1, j + 1)};
  cell.weight = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  double h[4];
  for (int k = 0; k < 4; ++k) h[k] = lattice.value[cell.node[k]];
  cell.slope =
      Vec2((1 - v) * (h[1] - h[0]) + v * (h[3] - h[2]), (1 - u) * (h[2] - h[0]) + u * (h[3] - h[1])) / lattice.node_m;
  if (!cell.slope.allFinite()) cell.slope = Vec2::Zero();  // not all four nodes were there before
  return cell;
}

/// One problem in all: what is measured, and the unknowns that it is solved for.
struct Problem {
  const TiltSettings& settings;
  TiltData data;
  Motion motion;
  Lattice lattice;
  std::vector<double> bias_m;    // (lasers)
  std::vector<int> bias_column;  // (lasers) or -1
  bool sees_pitch = true;        // a forward vertical laser does
  double rms_m = 0;

  int controls() const { return motion.clock.controls(); }
  int first_node() const { return 3 * controls(); }
};

/// Room for all that the beams can meet.
Lattice lattice_around(const Motion& motion, double reach_m, double node_m) {
  Eigen::AlignedBox2d box;
  for (const double t : motion.planar.stamp_s()) box.extend(motion.planar.at(t).position());
  Lattice lattice;
  lattice.node_m = node_m;
  lattice.origin = box.min() - Vec2::Constant(reach_m + 2);
  const Vec2 size = (box.max() - box.min() + Vec2::Constant(2 * reach_m + 4)) / node_m;
  lattice.width = static_cast<int>(size.x()) + 2;
  lattice.height = static_cast<int>(size.y()) + 2;
  const size_t all = 2 * static_cast<size_t>(lattice.width) * lattice.height;
  lattice.number.assign(all, -1);
  lattice.value.assign(all, std::numeric_limits<double>::quiet_NaN());
  return lattice;
}

void add_row(SparseRows& rows, std::initializer_list<std::pair<int, double>> entries, double right, double sigma) {
  for (const auto& [column, value] : entries) {
    rows.column.push_back(column);
    rows.value.push_back(value / sigma);
  }
  rows.offset.push_back(static_cast<int>(rows.column.size()));
  rows.right.push_back(right / sigma);
}

/// Spline: second differences (a shaking of 2 deg at 1.2 Hz has 4 deg in 0.2 s), the gauge at the start, and a level body
/// where nothing sees it pitch: rings across the way lie as well on a floor that it dives into, or slants over.
void add_spline_priors(const Problem& problem, SparseRows& rows) {
  constexpr std::array<double, 3> bend = {0.1, 5 * deg, 5 * deg}, start = {1e-3, 5 * deg, 5 * deg};
  const int n = problem.controls();
  for (int of = 0; of < 3; ++of) {
    for (int k = 0; k < 3; ++k) add_row(rows, {{of * n + k, 1.0}}, 0, start[of]);
    for (int k = 0; k + 2 < n; ++k)
      add_row(rows, {{of * n + k, 1.0}, {of * n + k + 1, -2.0}, {of * n + k + 2, 1.0}}, 0, bend[of]);
  }
  if (!problem.sees_pitch)
    for (int k = n; k < 3 * n; ++k) add_row(rows, {{k, 1.0}}, 0, problem.settings.level_sigma_deg * deg);
}

/// Lattice: second differences, twist, and a weak hold between neighbours.
void add_lattice_priors(const Problem& problem, SparseRows& rows) {
  const Lattice& lattice = problem.lattice;
  const double bend = problem.settings.curvature_m, hold = 10 * bend;
  const int first = problem.first_node();
  for (const bool roof : {false, true})
    for (int j = 0; j < lattice.height; ++j)
      for (int i = 0; i < lattice.width; ++i) {
        const auto node = [&](int di, int dj) {
          if (i + di >= lattice.width || j + dj >= lattice.height) return -1;
          const int number = lattice.number[lattice.index(roof, i + di, j + dj)];
          return number < 0 ? -1 : first + number;
        };
        const int here = node(0, 0);
        if (here < 0) continue;
        const int x = node(1, 0), y = node(0, 1), xx = node(2, 0), yy = node(0, 2), xy = node(1, 1);
        if (x >= 0) add_row(rows, {{here, -1.0}, {x, 1.0}}, 0, hold);
        if (y >= 0) add_row(rows, {{here, -1.0}, {y, 1.0}}, 0, hold);
        if (x >= 0 && xx >= 0) add_row(rows, {{here, 1.0}, {x, -2.0}, {xx, 1.0}}, 0, bend);
        if (y >= 0 && yy >= 0) add_row(rows, {{here, 1.0}, {y, -2.0}, {yy, 1.0}}, 0, bend);
        if (x >= 0 && y >= 0 && xy >= 0) add_row(rows, {{here, 1.0}, {x, -1.0}, {y, -1.0}, {xy, 1.0}}, 0, bend);
      }
}

/// Root of the weight of a residual under the Cauchy kernel.
double kernel_root(double residual_in_sigmas, double width) {
  return 1 / std::sqrt(1 + std::pow(residual_in_sigmas / width, 2));
}

void add_ribs(const Problem& problem, SparseRows& rows) {
  const int n = problem.controls();
  const double sigma = problem.settings.rib_sigma_deg * deg;
  for (const RibTilt& rib : problem.data.ribs) {
    const SplineWeights w = problem.motion.clock.at(rib.at_s);
    const double off = problem.motion.tilt(w)[2] - rib.roll_rad;
    const double root = kernel_root(off / sigma, 1);
    const int c = 2 * n + w.first;
    add_row(rows, {{c, w.weight[0]}, {c + 1, w.weight[1]}, {c + 2, w.weight[2]}, {c + 3, w.weight[3]}}, rib.roll_rad,
            sigma / root);
  }
}

constexpr int beam_entries = 17;  // 3 x 4 controls, 4 nodes, 1 range bias

/// Writes the equation of one beam; returns its squared residual times its weight, and the weight.
std::pair<double, double> write_beam(const Problem& problem, const TiltBeam& beam, const MovedPoint& moved,
                                     const Cell& cell, const SplineWeights& w, int* column, double* value,
                                     double& right) {
  const Lattice& lattice = problem.lattice;
  const Vec3 over(-cell.slope.x(), -cell.slope.y(), 1);  // how the height above the surface changes with the point
  const Vec3 by_tilt = moved.by_tilt.transpose() * over;
  const double by_bias = -moved.direction_M.dot(over);
  double surface = 0;
  for (int k = 0; k < 4; ++k) surface += cell.weight[k] * lattice.value[cell.node[k]];
  const double residual = moved.p_M.z() - surface;
  const double sigma = problem.settings.sigma_m;
  const double root = std::isfinite(residual) ? kernel_root(residual / sigma, problem.settings.kernel) : 1;
  const double scale = root / sigma;
  const Tilt tilt = problem.motion.tilt(w);
  for (int of = 0; of < 3; ++of)
    for (int k = 0; k < 4; ++k) {
      column[4 * of + k] = of * problem.controls() + w.first + k;
      value[4 * of + k] = scale * by_tilt[of] * w.weight[k];
    }
  for (int k = 0; k < 4; ++k) {
    column[12 + k] = problem.first_node() + lattice.number[cell.node[k]];
    value[12 + k] = -scale * cell.weight[k];
  }
  const int bias_column = problem.bias_column[beam.laser];
  column[16] = std::max(bias_column, 0);
  value[16] = bias_column >= 0 ? scale * by_bias : 0;
  right = scale * (by_tilt.dot(tilt) + by_bias * problem.bias_m[beam.laser] - moved.p_M.z());
  return std::isfinite(residual) ? std::pair{root * root * residual * residual, root * root} : std::pair{0.0, 0.0};
}

/// The same heights on nodes node_m apart; where a neighbour of the old nodes has none there is none.
Lattice resampled(const Lattice& from, double node_m) {
  Lattice to = from;
  to.node_m = node_m;
  const double step = node_m / from.node_m;
  to.width = static_cast<int>((from.width - 2) / step) + 2;
  to.height = static_cast<int>((from.height - 2) / step) + 2;
  const size_t all = 2 * static_cast<size_t>(to.width) * to.height;
  to.number.assign(all, -1);
  to.value.assign(all, std::numeric_limits<double>::quiet_NaN());
  for (const bool roof : {false, true})
    for (int j = 0; j < to.height; ++j)
      for (int i = 0; i < to.width; ++i) {
        const int i0 = std::min(static_cast<int>(i * step), from.width - 2),
                  j0 = std::min(static_cast<int>(j * step), from.height - 2);
        const double u = i * step - i0, v = j * step - j0;
        const auto value = [&](int di, int dj) { return from.value[from.index(roof, i0 + di, j0 + dj)]; };
        const auto along = [&](int dj) { return u > 0 ? (1 - u) * value(0, dj) + u * value(1, dj) : value(0, dj); };
        to.value[to.index(roof, i, j)] = v > 0 ? (1 - v) * along(0) + v * along(1) : along(0);
      }
  return to;
}

/// Numbers the nodes that the beams need, and writes all equations at the present solution.
SparseRows linearise(Problem& problem) {
  const auto& beams = problem.data.beams;
  std::vector<SplineWeights> weights(beams.size());
  std::vector<MovedPoint> moved(beams.size());
  std::vector<Cell> cells(beams.size());
  parallel_for(
      beams.size(),
      [&](size_t n) {
        weights[n] = problem.motion.clock.at(beams[n].at_s);
        moved[n] = moved_point(problem.motion, beams[n], problem.bias_m[beams[n].laser], weights[n]);
        cells[n] = cell_of(problem.lattice, beams[n], moved[n].p_M);
      },
      1024);
  Lattice& lattice = problem.lattice;
  std::fill(lattice.number.begin(), lattice.number.end(), -1);
  for (const Cell& cell : cells)
    for (const size_t node : cell.node) lattice.number[node] = 0;
  lattice.nodes = 0;
  for (int& number : lattice.number)
    if (number == 0) number = lattice.nodes++;
  int column = problem.first_node() + lattice.nodes;
  for (int& of_laser : problem.bias_column)
    if (of_laser >= 0) of_laser = column++;

  SparseRows rows;
  rows.unknowns = column;
  rows.offset.assign(beams.size() + 1, 0);
  for (size_t n = 0; n <= beams.size(); ++n) rows.offset[n] = static_cast<int>(n) * beam_entries;
  rows.column.resize(beams.size() * beam_entries);
  rows.value.resize(beams.size() * beam_entries);
  rows.right.resize(beams.size());
  std::vector<std::pair<double, double>> error(beams.size());
  parallel_for(
      beams.size(),
      [&](size_t n) {
        error[n] = write_beam(problem, beams[n], moved[n], cells[n], weights[n], &rows.column[n * beam_entries],
                              &rows.value[n * beam_entries], rows.right[n]);
      },
      1024);
  double squares = 0, weight = 0;
  for (const auto& [square, w] : error) squares += square, weight += w;
  problem.rms_m = weight > 0 ? std::sqrt(squares / weight) : 0;
  add_spline_priors(problem, rows);
  add_lattice_priors(problem, rows);
  add_ribs(problem, rows);
  for (const int bias : problem.bias_column)
    if (bias >= 0) add_row(rows, {{bias, 1.0}}, 0, problem.settings.bias_sigma_m);
  return rows;
}

void take(Problem& problem, const std::vector<double>& x) {
  const int n = problem.controls();
  for (int k = 0; k < n; ++k) problem.motion.control[k] = {x[k], x[n + k], x[2 * n + k]};
  Lattice& lattice = problem.lattice;
  for (size_t c = 0; c < lattice.number.size(); ++c)
    lattice.value[c] =
        lattice.number[c] >= 0 ? x[problem.first_node() + lattice.number[c]] : std::numeric_limits<double>::quiet_NaN();
  for (size_t m = 0; m < problem.bias_m.size(); ++m)
    if (problem.bias_column[m] >= 0) problem.bias_m[m] = x[problem.bias_column[m]];
}

Problem state(const Log& log, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
              const TiltSettings& settings) {
  PlanarMotion flat(stamp_s, planar);
  std::vector<bool> moving;
  for (size_t n = 0; n < stamp_s.size(); ++n) moving.push_back(flat.moves(n));
  KnotClock clock(stamp_s, moving, settings.knot_s, settings.rest_knot_s);
  const int horizontal = find_view(log.rig, View::horizontal);
  const Vec3 p_BH = horizontal >= 0 ? Vec3(log.rig.mounts[horizontal].X_BS.translation()) : Vec3::Zero();
  TiltData data = tilt_data(log, flat, settings);
  const int controls = clock.controls();
  Motion motion{std::move(flat), std::move(clock), p_BH, std::vector<Tilt>(controls, Tilt::Zero())};
  const double reach_m = std::max(settings.forward_m, settings.sideways_m);
  Lattice lattice = lattice_around(motion, reach_m, settings.node_m * settings.coarse);
  const size_t lasers = log.rig.mounts.size();
  Problem problem{settings,
                  std::move(data),
                  std::move(motion),
                  std::move(lattice),
                  std::vector<double>(lasers, 0),
                  std::vector<int>(lasers, -1),
                  find_view(log.rig, View::forward_vertical) >= 0};
  if (settings.bias_sigma_m > 0)
    for (const TiltBeam& beam : problem.data.beams) problem.bias_column[beam.laser] = 0;
  return problem;
}

/// The motion at the stamps, and every 20 ms within them.
std::pair<Trajectory, Trajectory> sampled(const Motion& motion, const std::vector<double>& stamp_s) {
  constexpr double step_s = 0.02;
  Trajectory path, dense;
  path.stamp_s = stamp_s;
  path.X_WB.resize(stamp_s.size());
  parallel_for(
      stamp_s.size(), [&](size_t n) { path.X_WB[n] = motion.at(stamp_s[n]); }, 64);
  const double length_s = stamp_s.back() - stamp_s.front();
  const auto steps = std::max<size_t>(1, static_cast<size_t>(std::ceil(length_s / step_s)));
  dense.stamp_s.resize(steps + 1);
  dense.X_WB.resize(steps + 1);
  parallel_for(
      steps + 1,
      [&](size_t n) {
        const double t = n == steps ? stamp_s.back()
                                    : stamp_s.front() + length_s * static_cast<double>(n) / static_cast<double>(steps);
        dense.stamp_s[n] = t;
        dense.X_WB[n] = motion.at(t);
      },
      64);
  return {std::move(path), std::move(dense)};
}

/// What the sheets alone say of the lasers' constant errors: even within their bands.
Eigen::MatrixXd stated_bias(const Rig& rig) {
  const auto n = static_cast<Eigen::Index>(rig.mounts.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index m = 0; m < n; ++m) covariance(m, m) = std::pow(rig.mounts[m].laser.bias_m, 2) / 3;
  return covariance;
}

/// That with what was estimated put in its place.
Eigen::MatrixXd bias_covariance(const Rig& rig, const Problem& problem, const std::vector<int>& lasers,
                                const Eigen::MatrixXd& formal) {
  Eigen::MatrixXd covariance = stated_bias(rig);
  const double scale = std::pow(problem.settings.bias_doubt * problem.rms_m / problem.settings.sigma_m, 2);
  for (size_t a = 0; a < lasers.size(); ++a)
    for (size_t b = 0; b < lasers.size(); ++b)
      covariance(lasers[a], lasers[b]) = scale * formal(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  return covariance;
}

TiltSolution stays_planar(const Rig& rig, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
                          std::string note) {
  TiltSolution solution;
  solution.path.stamp_s = stamp_s;
  for (const Pose2& X : planar) solution.path.X_WB.push_back(lift(X));
  solution.dense = solution.path;
  solution.note = std::move(note);
  solution.range_bias_m.assign(rig.mounts.size(), 0.0);
  solution.bias_covariance = stated_bias(rig);
  return solution;
}

}  // namespace

Fields fields(TiltSettings& s) {
  return {
      {"knot_s", &s.knot_s, "knots of the spline for z, pitch and roll while the vehicle moves", 0.02, 10},
      {"rest_knot_s", &s.rest_knot_s, "and while it stands", 0.02, 1000},
      {"node_m", &s.node_m, "lattice of the heights of floor and roof", 0.05, 5},
      {"coarse", &s.coarse, "times node_m: the lattice of all iterations but the last", 1, 10},
      {"spacing_m", &s.spacing_m, "beams of a scan are thinned to this distance on the rock", 0, 5},
      {"forward_m", &s.forward_m, "how far ahead the forward vertical laser is used", 0.5, 100},
      {"sideways_m", &s.sideways_m, "how far aside the upward and downward lasers are used", 0.5, 100},
      {"sigma_m", &s.sigma_m, "sd of a beam against the lattice", 1e-4, 1},
      {"kernel", &s.kernel, "width of the robust kernel in sigmas", 0.1, 1000},
      {"curvature_m", &s.curvature_m, "prior sd of the second difference of neighbouring nodes", 1e-4, 10},
      {"rib_sigma_deg", &s.rib_sigma_deg, "trust in a rib being vertical, for one rib in one scan; 0 = none", 0, 90},
      {"level_sigma_deg", &s.level_sigma_deg, "prior sd of pitch and roll where no forward vertical laser sees pitch",
       0.01, 90},
      {"bias_sigma_m", &s.bias_sigma_m, "prior sd of each laser's constant range error; 0 = taken as none", 0, 1},
      {"bias_doubt", &s.bias_doubt, "the formal sd of the range errors is so many times too small", 0, 1000},
      {"iterations", &s.iterations, "of Gauss-Newton", 1, 50}};
}

TiltSolution solve_tilt(const Log& log, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
                        const TiltSettings& settings, const Progress& progress) {
  ADIT_CHECK(stamp_s.size() == planar.size());
  if (find_view(log.rig, View::forward_vertical) < 0 && find_view(log.rig, View::down) < 0)
    return stays_planar(log.rig, stamp_s, planar,
                        "no forward vertical and no downward laser: height, pitch and roll are taken as zero");
  if (stamp_s.size() < 2)
    return stays_planar(log.rig, stamp_s, planar, "fewer than two scans: height, pitch and roll are taken as zero");
  Problem problem = state(log, stamp_s, planar, settings);
  if (problem.data.beams.empty())
    return stays_planar(log.rig, stamp_s, planar,
                        "no beam met floor or roof: height, pitch and roll are taken as zero");
  SparseSolution last;
  TiltSolution solution;
  for (size_t m = 0; m < problem.bias_column.size(); ++m)
    if (problem.bias_column[m] >= 0) solution.biased.push_back(static_cast<int>(m));
  for (int n = 0; n < settings.iterations; ++n) {
    progress("tilt", n, settings.iterations);
    const bool ends = n + 1 == settings.iterations;
    if (ends) problem.lattice = resampled(problem.lattice, settings.node_m);
    const SparseRows rows = linearise(problem);
    std::vector<int> wanted;
    for (const int m : solution.biased)
      if (ends) wanted.push_back(problem.bias_column[m]);
    last = solve_least_squares(rows, wanted);
    take(problem, last.x);
  }
  progress("tilt", settings.iterations, settings.iterations);
  std::tie(solution.path, solution.dense) = sampled(problem.motion, stamp_s);
  solution.range_bias_m = problem.bias_m;
  if (!problem.sees_pitch) solution.note = "no forward vertical laser: pitch is not seen, and taken as level";
  solution.rms_m = problem.rms_m;
  solution.bias_covariance = bias_covariance(log.rig, problem, solution.biased, last.covariance);
  solution.factor_operations = last.factor_operations;
  return solution;
}

Log without_bias(Log log, const std::vector<double>& range_bias_m) {
  ADIT_CHECK(range_bias_m.size() == log.scans.size());
  for (size_t m = 0; m < log.scans.size(); ++m)
    if (range_bias_m[m] != 0)
      for (float& range_m : log.scans[m].range_m)
        if (std::isfinite(range_m)) range_m = std::max(0.0F, range_m - static_cast<float>(range_bias_m[m]));
  return log;
}

Trajectory estimate_tilt(const Log& log, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
                         const TiltSettings& settings, const Progress& progress) {
  return solve_tilt(log, stamp_s, planar, settings, progress).path;
}

}  // namespace adit
