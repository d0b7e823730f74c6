// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/hull.h"
#include "base/rig.h"
#include "base/trajectory.h"
#include "rays/caster.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace adit {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// How lasers are judged without a mapper. Keys below [fast].
struct FastSettings {
  double step_m = 2;         // between two stations of the path
  double beam_step_deg = 2;  // of the beams that are cast; the others count as they do
  double sector_deg = 10;    // of the section about the path: the patches of rock that are counted
  double section_max_m = 5;  // rock farther from the path does not count
  double slope = 0.25;       // of rock against the body's axes: less of it is roughness, which tells a mapper nothing
  double again_m = 0.25;     // rock this near to the fan at the next station is seen again: a mapper knows it then
  double unknown_m = 0.3;    // deviation of rock that is not: what the beams of a fan share of its unevenness
  bool one_a_view = true;    // as adit's mapper: of each view the first laser counts, no void without one that looks up
  double prior_m = 1, prior_deg = 5;                // of a pose before a scan: what stays at it is not seen at all
  double information = 1, surface = 1, volume = 1;  // weights of the value
  double hull = 3;                                  // and what beams that end on the vehicle cost
};
Fields fields(FastSettings& settings);

/// What one laser tells at each station of a course.
struct Sight {
  View view = View::other;
  std::vector<Mat6> information;    // (stations) of the body's pose: x, y, z m, roll, pitch, yaw rad, all in B
  std::vector<std::uint64_t> seen;  // bits of the patches of rock
  double blocked = 0;               // share of its beams that end on the vehicle
};

/// How well lasers together see, from the true geometry alone.
struct FastScore {
  double value = 0;           // weighted sum of the three below, less what `hull` costs
  double information = 0;     // share of 60 dB: mean over stations and directions of what a scan adds to the prior
  double surface = 0;         // share of the rock about the path that some beam meets
  double volume = 0;          // share of the void about the path that lies before such rock
  double hull = 0;            // sum over the lasers of the share of their beams that end on the vehicle
  Vec6 sigma = Vec6::Zero();  // median over the stations: m, m, m, deg, deg, deg
  Vec6 left = Vec6::Ones();   // the same as shares of the prior's deviation: 1 = nothing is seen
  double blind_left = 1;      // the same in the direction of least information, whichever it is
};
/// The directions in which more than half of the prior's deviation is left, as "up, roll and pitch"; the one with most where
/// there is none.
std::string blind_words(const FastScore& score);

/// A path through a mine on which lasers are judged: stations, the rock about them, rays. Safe to ask from many threads.
///   I = sum over the beams of g g^T / sigma^2,   g = -(n, (p - o) x n) / (n . d)
/// with p where the beam d ends, n the normal there, o the body's origin, in B; sigma as in eval/bound.h. In the plane it
/// is that bound's. A mapper does not know the rock beforehand: n is the mean over the patch of rock, and components of
/// it below `slope` count as none; rock that the laser does not see again from the next station or the one before tells
/// as much as its unevenness lets it, sigma^2 + unknown_m^2. Source: Censi, On achievable accuracy for range-finder localization, ICRA 2007, Eq. (6).
class Course {
 public:
  /// Mesh and caster must outlive it. Error for a path shorter than two steps.
  Course(const Caster& caster, const Trajectory& path, const FastSettings& settings);

  /// Boxes of the hull stand in the rays, but for those around the mirror.
  Sight sight(const Mount& mount, const Hull& hull) const;
  /// Of lasers together, in the order of the rig. Each of the three parts is monotone and submodular over sets of lasers
  /// where every laser counts (one_a_view = false); what is taken off for the hull is additive.
  FastScore score(std::span<const Sight* const> lasers, bool with_directions = true) const;
  size_t stations() const { return X_WB_.size(); }
  /// Whether the value is monotone and submodular over all sets of lasers.
  bool every_laser_counts() const { return !settings_.one_a_view && settings_.hull == 0; }

 private:
  const Caster& caster_;
  FastSettings settings_;
  std::vector<Pose> X_WB_;
  std::vector<Vec3> middle_W_;  // of the section at each station
  size_t sectors_ = 0;
  std::vector<double> surface_m2_, volume_m3_;  // (stations x sectors)
  double surface_all_ = 0, volume_all_ = 0;
  Vec2 low_W_ = Vec2::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<Vec3> patch_normal_W_;   // (patches x 3: floor, roof, ribs) zero where no face has its middle there
  std::vector<std::int32_t> nearest_;  // station of each cell in plan, -1: far from the path

  std::int32_t station_at(const Vec3& p_W) const;
  std::int64_t patch_of(const Vec3& p_W) const;
  void lay_cells();
  void weigh();
  void level_roughness();
  Vec3 normal_W(std::int32_t face, std::int64_t patch) const;
  bool seen_again(const Mount& mount, size_t station, const Vec3& p_W) const;
  std::vector<const Sight*> that_count(std::span<const Sight* const> lasers) const;
};

}  // namespace adit
