// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int roll_count = 12;

constexpr double cleat_length_m = 4;                           // over which a rib keeps to one joint
constexpr std::uint64_t cleat_joint = std::uint64_t{7} << 32;  // beyond the addresses of the fields
constexpr double told_m = 0.04;   // what fell, or fell from, is told by its label from this height on
constexpr double full_sag_m = 1;  // from the ribs: where sag and heave reach their full height

// A field of unit variance whose values are all but normal.
Waves unit(double length_m, std::uint64_t seed, Draw draw, std::uint64_t which, bool flat) {
  return {{1, length_m / 4, 1.5, 0, 48, 3}, seed, draw, which, flat};
}

// The value below which a share of a normal distribution lies.
double quantile(double share) {
  double low = -4, high = 4;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? low : high) = middle;
  }
  return low;
}

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

// 1 where a field is below the value that a share of it is below, 0 above, a soft rim between.
double cover(double field, double below, double softness) {
  return smooth_step(0.5 + (below - field) / softness);
}

Waves rough(const RoughnessSettings& r, double edge_m, std::uint64_t seed, std::uint64_t which, bool flat) {
  return {{r.rms_m, r.correlation_m, 0.7, 2 * edge_m}, seed, Draw::world_roughness, which, flat};
}

}  // namespace

Terrain::Terrain(const WorldSettings& s, const Vec2& middle, const Lattice& depth, std::uint64_t seed,
                 std::vector<NumberedFall> falls)
    : mean_height_(s.height_m),
      roll_amplitude_(s.roll_m * std::sqrt(2.0 / roll_count)),
      mean_reflectivity_(s.reflectivity),
      wear_(s.wear),
      rock_settings_(s.rock),
      slough_below_(quantile(s.wear.slough_share)),
      dust_below_(quantile(s.rock.dust_share)),
      wet_below_{quantile(std::pow(s.rock.wet_share, 0.6)), quantile(s.rock.wet_share),
                 quantile(std::pow(s.rock.wet_share, 1.6))},
      depth_(depth),
      middle_(middle),
      height_({s.height_sd_m, s.height_length_m / 4, 1.5, 5, 48, 2.5}, seed, Draw::world_height, 0, true),
      floor_(rough(s.floor, s.mesh_edge_m, seed, 0, true)),
      roof_(rough(s.roof, s.mesh_edge_m, seed, 1, true)),
      rib_(rough(s.rib, s.mesh_edge_m, seed, 2, false)),
      patches_({s.reflectivity_sd, 1.5, 0.7, 0.4, 48, 2.5}, seed, Draw::world_material, 0, false),
      slough_(unit(s.wear.slough_length_m, seed, Draw::world_roughness, 3, true)),
      sag_(unit(25, seed, Draw::world_roughness, 4, true)),
      bedding_(unit(8, seed, Draw::world_roughness, 5, true)),
      dust_(unit(s.rock.patch_m, seed, Draw::world_material, 1, false)),
      water_(unit(2 * s.rock.patch_m, seed, Draw::world_material, 2, false)),
      cleat_(unit(cleat_length_m, seed, Draw::world_roughness, 6, true)),
      sludge_(unit(8, seed, Draw::world_decay, 0, true)),
      talus_most_m_(std::max(0.0, s.decay.talus_m)),
      sludge_share_(std::max(0.0, s.furniture.sludge_share)),
      sludge_below_(quantile(sludge_share_)),
      falls_(std::move(falls)),
      seed_(seed) {
  const double dip = 2 * pi * uniform(seed, Draw::world_roll, 0);
  grade_ = 0.01 * s.grade_percent * Vec2(std::cos(dip), std::sin(dip));
  const double shortest = std::min(s.roll_min_m, s.roll_max_m), longest = std::max(s.roll_min_m, s.roll_max_m);
  for (int i = 0; i < roll_count; ++i) {
    const double share = (i + uniform(seed, Draw::world_roll, 1, i)) / roll_count;
    const double k = 2 * pi / (shortest * std::pow(longest / shortest, share));
    const double angle = 2 * pi * uniform(seed, Draw::world_roll, 2, i);
    rolls_.push_back({k * Vec2(std::cos(angle), std::sin(angle)), 2 * pi * uniform(seed, Draw::world_roll, 3, i)});
  }
}

double Terrain::seam_z(const Vec2& p) const {
  const Vec2 q = p - middle_;
  double z = grade_.dot(q);
  for (const Roll& r : rolls_) z += roll_amplitude_ * std::cos(r.k.dot(q) + r.phase);
  return z;
}

double Terrain::height_m(const Vec2& p) const {
  return mean_height_ + height_(p);
}
double Terrain::across(const Vec2& p) const {
  const double s = std::clamp(-depth_.at(p) / full_sag_m, 0.0, 1.0);
  return s * (2 - s);
}
// Cavities of falls that meet are one.
double Terrain::hollow_m(const Vec2& p, int* number, Label* label) const {
  double height = 0;
  for (const auto& [f, rubble, hollow] : falls_) {
    if ((p - f.middle).squaredNorm() >= f.half_along_m * f.half_along_m + f.half_across_m * f.half_across_m) continue;
    const double here = f.cavity_m(p, depth_.at(p));
    if (here <= height) continue;
    height = here;
    if (number) *number = hollow;
    if (label) *label = f.hollow();
  }
  return height;
}
double Terrain::rubble_m(const Vec2& p, int* number) const {
  double height = 0;
  for (const auto& [f, rubble, hollow] : falls_) {
    const double reach = f.reach_m();
    if (f.heap_m <= 0 || (p - f.middle).squaredNorm() > reach * reach) continue;
    const double here = f.rubble_m(p);
    if (here <= height) continue;
    height = here;
    if (number) *number = rubble;
  }
  if (height <= 0) return 0;
  return std::max(0.0, height + std::min(1.0, height / 0.4) * stones_m(p, seed_));
}
// A wedge at the rib's foot where it has spalled.
double Terrain::talus_m(const Vec2& p) const {
  if (talus_most_m_ <= 0) return 0;
  constexpr double repose = 0.75;  // 37 degrees
  const double behind = std::max(0.0, -depth_.at(p));
  if (behind * repose >= talus_most_m_) return 0;
  return std::max(0.0, talus_most_m_ * cover(slough_(p), slough_below_, 0.8) - repose * behind);
}
std::pair<Label, int> Terrain::ground(const Vec2& p) const {
  int number = -1;
  if (!falls_.empty() && rubble_m(p, &number) > told_m) return {Label::rubble, number};
  if (talus_m(p) > told_m) return {Label::talus, -1};
  if (sludge_share_ > 0 && sludge_(p) < sludge_below_) return {Label::sludge, -1};
  return {Label::floor, -1};
}

std::pair<Label, int> Terrain::ceiling(const Vec2& p) const {
  int number = -1;
  Label label = Label::roof;
  if (falls_.empty() || hollow_m(p, &number, &label) <= told_m) return {Label::roof, -1};
  return {label, number};
}

double Terrain::floor_z(const Vec2& p) const {
  double z = seam_z(p) + floor_(p);
  if (wear_.heave_m > 0) z += wear_.heave_m * across(p) * smooth_step(0.5 - 0.5 * sag_(p));
  z += talus_m(p);
  const double rubble = falls_.empty() ? 0 : rubble_m(p);
  if (rubble > 0) z = std::min(z + rubble, std::max(z, roof_z(p) - 0.25));  // the void is one, however full
  return z;
}
double Terrain::roof_z(const Vec2& p) const {
  double z = seam_z(p) + height_m(p) + roof_(p);
  if (wear_.sag_m > 0) z -= wear_.sag_m * across(p) * smooth_step(0.5 + 0.5 * sag_(p));
  // Steps that are as steep as two edges of the mesh.
  if (wear_.bedding_m > 0) z += wear_.bedding_m * smooth_step(0.5 + 4 * (bedding_(p) - 0.7));
  if (!falls_.empty()) z += hollow_m(p);
  return z;
}

// The rock has broken back or stands out to a joint of that set which the rib faces most. Joints are cleat_m apart on the
// average; which of them it is changes along the rib, in steps.
double Terrain::cleat_offset_m(const Vec2& p, const Vec2& normal) const {
  const double bearing = wear_.cleat_deg * pi / 180, d = wear_.cleat_m;
  const Vec2 first(std::cos(bearing), std::sin(bearing)), second(-first.y(), first.x());
  const bool faces_first = std::abs(normal.dot(first)) > std::abs(normal.dot(second));
  const Vec2 across = faces_first ? first : second;
  const double at = across.dot(p - middle_), joint = std::floor(at / d + 0.8 * cleat_(p));
  const auto address = static_cast<std::uint64_t>(static_cast<std::int64_t>(joint) + (std::int64_t{1} << 40));
  const double off = uniform(seed_, Draw::world_roughness, cleat_joint + faces_first, address) - 0.5;
  const double plane = d * (joint + 0.5 + 0.6 * off);
  return std::clamp((plane - at) / normal.dot(across), -1.2 * d, 1.2 * d);
}

double Terrain::rib_offset_m(const Vec3& p, const Vec2& normal) const {
  double offset = rib_(p);
  if (wear_.cleat_m > 0) offset += cleat_offset_m(p.head<2>(), normal);
  if (wear_.scallop_m > 0)
    offset += wear_.scallop_m * (0.5 - std::abs(std::sin(pi * (p.z() - seam_z(p.head<2>())) / wear_.scallop_pitch_m)));
  return offset;
}

double Terrain::slough_m(const Vec2& p) const {
  if (wear_.slough_m <= 0) return 0;
  return wear_.slough_m * cover(slough_(p), slough_below_, 0.8);
}

Rock Terrain::rock(const Vec3& p, Label label) const {
  const double patch = patches_(p);
  const bool bare = rock_settings_.dust_share < 1;
  const double dust = bare ? cover(dust_(p), dust_below_, 0.6) : 1;
  if (label == Label::sludge)
    return {Material::mud, static_cast<float>(std::clamp(0.25 * (1 + patch / mean_reflectivity_), 0.02, 1.0)), 0.8f};
  const bool broken = label != Label::roof && (is_roof(label) || label == Label::rubble || label == Label::talus);
  const bool floor = label == Label::floor, roof = is_roof(label) || label == Label::rubble;
  const Material under = floor                 ? Material::fireclay
                         : roof                ? Material::shale
                         : label == Label::cap ? Material::block
                                               : Material::coal;
  const double own = floor ? rock_settings_.fireclay : roof ? rock_settings_.shale : rock_settings_.coal;
  double wet = 0;
  if (rock_settings_.wet_share > 0) {
    // Water runs down: of the floor more is wet than of the ribs, of those more than of the roof.
    wet = cover(water_(p), wet_below_[floor ? 0 : roof ? 2 : 1], 0.8);
  }
  if (broken) {  // after the dust was laid
    const double seen = own * (1 + patch / mean_reflectivity_) * (1 - 0.5 * wet);
    return {under, static_cast<float>(std::clamp(seen, 0.02, 1.0)), static_cast<float>(wet)};
  }
  const double dry = dust * (mean_reflectivity_ + patch) + (1 - dust) * own * (1 + patch / mean_reflectivity_);
  const double seen = dry * (1 - 0.5 * wet);  // wet rock reflects about half as much as dry
  return {dust > 0.5 ? Material::rock_dust : under, static_cast<float>(std::clamp(seen, 0.02, 1.0)),
          static_cast<float>(wet)};
}

}  // namespace adit
