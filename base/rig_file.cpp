// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig_file.h"

#include "base/error.h"

#include <algorithm>

namespace adit {
namespace {

constexpr int version = 1;  // of the layout that docs/files.md describes

struct LaserNumber {
  const char* key;
  double LaserModel::*value;
};
constexpr LaserNumber laser_numbers[] = {
    {"fov_rad", &LaserModel::fov_rad},
    {"turn_s", &LaserModel::turn_s},
    {"interval_s", &LaserModel::interval_s},
    {"range_max_m", &LaserModel::range_max_m},
    {"resolution_m", &LaserModel::resolution_m},
    {"sigma_m", &LaserModel::sigma_m},
    {"bias_m", &LaserModel::bias_m},
    {"spot_m", &LaserModel::spot_m},
    {"divergence_rad", &LaserModel::divergence_rad},
    {"reflectivity_at_4m", &LaserModel::reflectivity_at_4m},
    {"reflectivity_exponent", &LaserModel::reflectivity_exponent},
};

}  // namespace

void begin_file(H5Writer& out, const std::string& format) {
  out.text("/", "format", format);
  out.integer("/", "version", version);
}

void expect_format(const H5Reader& in, const std::string& format) {
  if (!in.has_attribute("/", "format")) throw Error(in.file() + ": is an HDF5 file, but not an " + format);
  const std::string found = in.text("/", "format");
  if (found != format) throw Error(in.file() + ": is an " + found + ", an " + format + " is needed");
  const std::int64_t written = in.integer("/", "version");
  if (written != version)
    throw Error(in.file() + ": has layout version " + std::to_string(written) + ", this program reads version " +
                std::to_string(version));
}

std::vector<double> flat(std::span<const Pose> poses) {
  std::vector<double> numbers;
  numbers.reserve(poses.size() * 12);
  for (const Pose& X : poses)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) numbers.push_back(X.matrix()(row, column));
  return numbers;
}

std::vector<Pose> poses_of(std::span<const double> numbers) {
  std::vector<Pose> poses(numbers.size() / 12, Pose::Identity());
  for (size_t i = 0; i < poses.size(); ++i)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) poses[i].matrix()(row, column) = numbers[12 * i + 4 * row + column];
  return poses;
}

void check_names(const Rig& rig, const std::string& file) {
  for (const Mount& mount : rig.mounts)
    if (mount.name.empty() || mount.name == "." || mount.name.find('/') != std::string::npos)
      throw Error(file + ": a laser named '" + mount.name + "' cannot be kept; a name needs letters and no '/'");
}

void save_rig(H5Writer& out, const Rig& rig) {
  out.group("/rig");
  out.text("/rig", "name", rig.name);
  for (size_t i = 0; i < rig.mounts.size(); ++i) {
    const Mount& mount = rig.mounts[i];
    const std::string at = "/rig/" + mount.name;
    out.group(at);
    out.integer(at, "index", static_cast<std::int64_t>(i));
    out.text(at, "model", mount.laser.name);
    out.integer(at, "beams", mount.laser.beams);
    out.integer(at, "interlace", mount.laser.interlace);
    for (const LaserNumber& number : laser_numbers) out.number(at, number.key, mount.laser.*number.value);
    out.number(at, "phase_s", mount.phase_s);
    out.array<double>(at + "/X_BS", flat({&mount.X_BS, 1}), {3, 4});
    if (mount.tilt.nods()) {
      out.number(at, "tilt_from_rad", mount.tilt.from_rad);
      out.number(at, "tilt_to_rad", mount.tilt.to_rad);
      out.number(at, "tilt_period_s", mount.tilt.period_s);
      out.integer(at, "tilt_standing_only", mount.tilt.standing_only);
    }
    const LaserModel& m = mount.laser;
    if (m.chart_range_m.empty()) continue;
    out.array<double>(at + "/chart_range_m", m.chart_range_m, {m.chart_range_m.size()});
    out.array<double>(at + "/chart_reflectivity", m.chart_reflectivity, {m.chart_reflectivity.size()});
  }
}

bool has_array(const H5Reader& in, const std::string& group, const std::string& name) {
  const std::vector<std::string> there = in.names(group);
  return std::find(there.begin(), there.end(), name) != there.end();
}

Rig load_rig(const H5Reader& in) {
  Rig rig;
  rig.name = in.text("/rig", "name");
  const std::vector<std::string> names = in.names("/rig");
  rig.mounts.resize(names.size());
  std::vector<bool> seen(names.size(), false);
  for (const std::string& name : names) {
    const std::string at = "/rig/" + name;
    const std::int64_t index = in.integer(at, "index");
    if (index < 0 || index >= static_cast<std::int64_t>(names.size()) || seen[index])
      throw Error(in.file() + ": attribute 'index' at " + at + " must number the lasers from 0, each once");
    seen[index] = true;
    Mount& mount = rig.mounts[index];
    mount.name = name;
    mount.laser.name = in.text(at, "model");
    mount.laser.beams = static_cast<int>(in.integer(at, "beams"));
    mount.laser.interlace = static_cast<int>(in.integer(at, "interlace"));
    if (mount.laser.beams < 2 || mount.laser.interlace < 1)
      throw Error(in.file() + ": " + at + " needs beams >= 2 and interlace >= 1");
    for (const LaserNumber& number : laser_numbers) mount.laser.*number.value = in.number(at, number.key);
    mount.phase_s = in.number(at, "phase_s");
    mount.X_BS = poses_of(in.array<double>(at + "/X_BS", {3, 4}))[0];
    if (in.has_attribute(at, "tilt_period_s"))
      mount.tilt = {in.number(at, "tilt_from_rad"), in.number(at, "tilt_to_rad"), in.number(at, "tilt_period_s"),
                    in.integer(at, "tilt_standing_only") != 0};
    if (!has_array(in, at, "chart_range_m")) continue;
    const Shape points = in.shape(at + "/chart_range_m");
    mount.laser.chart_range_m = in.array<double>(at + "/chart_range_m", points);
    mount.laser.chart_reflectivity = in.array<double>(at + "/chart_reflectivity", points);
  }
  return rig;
}

Pieces::Pieces(std::vector<std::string> files) : files_(std::move(files)), open_(files_.size()) {}

const H5Reader& Pieces::at(size_t i) {
  constexpr size_t most_open = 24;  // some 2 MB each
  if (!open_[i]) {
    if (number_open_ == most_open) {
      for (std::unique_ptr<H5Reader>& reader : open_) reader.reset();
      number_open_ = 0;
    }
    open_[i] = std::make_unique<H5Reader>(files_[i]);
    ++number_open_;
  }
  return *open_[i];
}

bool Pieces::has(const std::string& group, const std::string& name) {
  for (size_t i = 0; i < size(); ++i)
    if (has_array(at(i), group, name)) return true;
  return false;
}

// A piece in which a laser was silent lacks the arrays that only some recordings have.
template <class T>
void Pieces::join(H5Writer& out, const std::string& group, const std::string& name) {
  const std::string path = group + "/" + name;
  Shape whole;
  for (size_t i = 0; i < size(); ++i) {
    if (!has_array(at(i), group, name)) {
      if (at(i).shape(group + "/stamp_s")[0] > 0) throw Error(at(i).file() + ": lacks " + path + ", which others have");
      continue;
    }
    const Shape some = at(i).shape(path);
    if (whole.empty())
      whole = some;
    else
      whole[0] += some[0];
  }
  size_t i = 0;
  out.array<T>(path, whole, [&] {
    std::vector<T> rows;
    for (; rows.empty() && i < size(); ++i)
      if (has_array(at(i), group, name)) rows = at(i).array<T>(path, at(i).shape(path));
    return rows;
  });
}

template void Pieces::join<double>(H5Writer&, const std::string&, const std::string&);
template void Pieces::join<float>(H5Writer&, const std::string&, const std::string&);
template void Pieces::join<std::int32_t>(H5Writer&, const std::string&, const std::string&);
template void Pieces::join<std::uint8_t>(H5Writer&, const std::string&, const std::string&);

}  // namespace adit
