// SPDX-License-Identifier: BSD-3-Clause
#include "base/carmen.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string_view>

namespace adit {
namespace {

constexpr double lms_none_m = 81.91;  // 8191 cm, the code for no echo
constexpr double lms_max_m = 81.83;
constexpr double degree = std::numbers::pi / 180;

// The words of one line, taken from the front.
class Words {
 public:
  Words(std::string_view line, std::string place) : place_(std::move(place)) {
    for (size_t at = 0; at < line.size();) {
      const size_t from = line.find_first_not_of(" \t\r", at);
      if (from == std::string_view::npos) break;
      at = std::min(line.find_first_of(" \t\r", from), line.size());
      words_.push_back(line.substr(from, at - from));
    }
  }

  size_t left() const { return words_.size() - at_; }
  std::string_view word() {
    if (at_ >= words_.size()) fail("is cut short");
    return words_[at_++];
  }
  double number() {
    const std::string_view w = word();
    double value = 0;
    const auto [end, error] = std::from_chars(w.data() + (w[0] == '+'), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size() || !std::isfinite(value))
      fail("has '" + std::string(w) + "' where a number is needed");
    return value;
  }
  /// A range may be said not to be one.
  float range() {
    const std::string_view w = word();
    if (w == "nan" || w == "-nan") return std::numeric_limits<float>::quiet_NaN();
    if (w == "inf") return std::numeric_limits<float>::infinity();
    --at_;
    return static_cast<float>(number());
  }
  size_t count(size_t most) {
    const double value = number();
    if (!(value >= 0 && value <= static_cast<double>(most)) || value != std::floor(value))
      fail("has a count of " + std::to_string(value) + " that its other words do not bear out");
    return static_cast<size_t>(value);
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(place_ + ": this line " + what); }

 private:
  std::string place_;
  std::vector<std::string_view> words_;
  size_t at_ = 0;
};

struct Raster {
  double start_rad = 0, step_rad = 0, max_m = 0;
  size_t beams = 0;
};

// One laser as its lines come in.
struct Lines {
  Raster shape;
  Scans scans;
  Trajectory odometry;
};

// Of old lines: LMS rasters end at 90 deg only where the number of values is odd.
Raster shape_of(size_t beams, double max_m) {
  const double steps = static_cast<double>(beams % 2 ? beams - 1 : beams);
  return {-std::numbers::pi / 2, std::numbers::pi / steps, max_m, beams};
}

Pose planar(double x_m, double y_m, double yaw_rad) {
  return pose_of({x_m, y_m, 0}, yaw_rad);
}

void append_pose(Trajectory& path, double stamp_s, const Pose& X) {
  if (!path.empty() && stamp_s <= path.stamp_s.back()) return;
  path.stamp_s.push_back(stamp_s);
  path.X_WB.push_back(X);
}

// The words that end every message: the time of the message, the host, the time of the logger.
double stamp_of(Words& words) {
  const double ipc_s = words.number();
  words.word();
  words.number();
  return ipc_s;
}

void add_scan(Lines& device, Words& words, const Raster& shape, std::vector<float> ranges, const Pose& X,
              double stamp_s) {
  if (device.scans.size() == 0) {
    device.shape = shape;
    device.scans.beams = static_cast<int>(shape.beams);
  }
  const Raster& first = device.shape;
  if (shape.beams != first.beams || std::abs(shape.step_rad - first.step_rad) > 1e-6 ||
      std::abs(shape.start_rad - first.start_rad) > 1e-6)
    words.fail("is of another raster than the ones before it; adit needs one raster for each laser");
  if (!device.scans.stamp_s.empty() && stamp_s <= device.scans.stamp_s.back())
    words.fail("has a stamp that does not grow");
  for (float& r : ranges)
    if (r >= static_cast<float>(shape.max_m)) r = std::numeric_limits<float>::infinity();
  device.scans.range_m.insert(device.scans.range_m.end(), ranges.begin(), ranges.end());
  device.scans.stamp_s.push_back(stamp_s);
  append_pose(device.odometry, stamp_s, X);
}

std::vector<float> read_ranges(Words& words, size_t n) {
  std::vector<float> ranges;
  ranges.reserve(n);
  for (size_t k = 0; k < n; ++k) ranges.push_back(words.range());
  return ranges;
}

// FLASER n ranges x y theta odom_x odom_y odom_theta ...
void read_old(Words& words, Lines& device, double max_m) {
  const size_t n = words.count(words.left());
  if (n < 2) words.fail("has fewer than two ranges");
  std::vector<float> ranges = read_ranges(words, n);
  for (int k = 0; k < 3; ++k) words.number();
  const double x = words.number(), y = words.number(), yaw = words.number();
  const double stamp_s = stamp_of(words);
  add_scan(device, words, shape_of(n, max_m), std::move(ranges), planar(x, y, yaw), stamp_s);
}

// ROBOTLASER1 type start fov step max accuracy remission n ranges [m remissions] laser pose, robot pose, tv rv safety
// distances [turn axis] ...; logs before 2005 lack what stands in brackets.
void read_new(Words& words, Lines& device) {
  words.number();
  Raster shape;
  shape.start_rad = words.number();
  const double fov_rad = words.number();
  shape.step_rad = words.number();
  shape.max_m = words.number();
  words.number();
  words.number();
  shape.beams = words.count(words.left());
  if (shape.beams < 2 || !(shape.step_rad > 0)) words.fail("needs two ranges at least and a step greater than 0");
  // The step is rounded as the field of view is, and many steps add that up: where both mean the same raster, the field
  // of view tells it better.
  const auto steps = static_cast<double>(shape.beams - 1);
  if (std::abs(fov_rad - steps * shape.step_rad) < 0.1 * shape.step_rad) shape.step_rad = fov_rad / steps;
  std::vector<float> ranges = read_ranges(words, shape.beams);
  constexpr size_t oldest = 6 + 4 + 3;
  if (words.left() > oldest + 1) {
    const size_t remissions = words.count(words.left());
    for (size_t k = 0; k < remissions; ++k) words.number();
  }
  for (int k = 0; k < 3; ++k) words.number();
  const double x = words.number(), y = words.number(), yaw = words.number();
  while (words.left() > 3) words.number();
  const double stamp_s = stamp_of(words);
  add_scan(device, words, shape, std::move(ranges), planar(x, y, yaw), stamp_s);
}

Mount mount_of(const std::string& name, const Lines& device) {
  Mount mount{.name = name, .laser = load_laser("lms200", 0)};
  LaserModel& m = mount.laser;
  const double steps = static_cast<double>(device.shape.beams - 1);
  m.beams = static_cast<int>(device.shape.beams);
  m.fov_rad = steps * device.shape.step_rad;
  m.interlace = std::clamp(static_cast<int>(std::lround(degree / device.shape.step_rad)), 1, 4);
  m.range_max_m = device.shape.max_m;
  m.interval_s = m.turn_s * m.interlace;
  const std::vector<double>& t = device.scans.stamp_s;
  if (t.size() > 1) m.interval_s = std::max(m.interval_s, (t.back() - t.front()) / static_cast<double>(t.size() - 1));
  const double ahead = name == "rear" ? std::numbers::pi : 0;
  mount.X_BS = pose_of(Vec3::Zero(), ahead + device.shape.start_rad + m.fov_rad / 2);
  return mount;
}

// What a log's lines add up to.
struct Devices {
  Lines front, rear;
  Trajectory true_path;
  double max_m = lms_max_m;
};

void read_line(Words& words, Devices& d) {
  const std::string_view name = words.word();
  if (name == "FLASER") read_old(words, d.front, d.max_m);
  if (name == "RLASER") read_old(words, d.rear, d.max_m);
  if (name == "ROBOTLASER1") read_new(words, d.front);
  if (name == "ROBOTLASER2") read_new(words, d.rear);
  if (name == "PARAM" && words.left() >= 2 && words.word() == "robot_front_laser_max") d.max_m = words.number();
  if (name == "TRUEPOS") {
    const double x = words.number(), y = words.number(), yaw = words.number();
    for (int k = 0; k < 3; ++k) words.number();
    append_pose(d.true_path, stamp_of(words), planar(x, y, yaw));
  }
}

}  // namespace

CarmenLog read_carmen(const std::string& file) {
  const std::string text = read_text(file);
  CarmenLog out;
  Devices devices;
  size_t number = 0, left_out = 0;
  std::string first_fault;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    ++number;
    if (line.empty() || line[0] == '#') continue;
    Words words(line, file + ":" + std::to_string(number));
    if (words.left() == 0) continue;
    try {
      read_line(words, devices);
    } catch (const Error& e) {
      if (left_out++ == 0) first_fault = e.what();
    }
  }
  if (left_out > devices.front.scans.size() + devices.rear.scans.size())
    throw Error(first_fault + "; so are more lines than can be read");
  if (left_out > 0)
    out.notes.push_back(std::to_string(left_out) + (left_out == 1 ? " line is" : " lines are") +
                        " left out, the first: " + first_fault);
  out.true_path = std::move(devices.true_path);
  out.log.rig.name = "CARMEN";
  for (const auto& [name, device] : {std::pair{"front", &devices.front}, {"rear", &devices.rear}}) {
    if (device->scans.size() == 0) continue;
    out.log.rig.mounts.push_back(mount_of(name, *device));
    out.log.scans.push_back(device->scans);
  }
  if (out.log.scans.empty()) throw Error(file + ": has no FLASER, RLASER, ROBOTLASER1 or ROBOTLASER2 line");
  out.odometry = devices.front.scans.size() > 0 ? devices.front.odometry : devices.rear.odometry;
  return out;
}

namespace {

template <class... Values>
void print(std::string& text, const char* format, Values... values) {
  char piece[256];
  const int n = std::snprintf(piece, sizeof piece, format, values...);
  text.append(piece, static_cast<size_t>(std::min<int>(n, sizeof piece - 1)));
}

void print_ranges(std::string& text, std::span<const float> ranges) {
  for (float r : ranges) print(text, " %.3f", std::isfinite(r) ? static_cast<double>(r) : lms_none_m);
}

void print_scan(std::string& text, const Mount& mount, std::span<const float> ranges, double stamp_s,
                CarmenStyle style) {
  const LaserModel& m = mount.laser;
  if (style == CarmenStyle::flaser) {
    print(text, "FLASER %d", m.beams);
    print_ranges(text, ranges);
    text += " 0 0 0 0 0 0";
  } else {
    const double yaw = flatten(mount.X_BS).yaw_rad;
    print(text, "ROBOTLASER1 0 %.9f %.9f %.9f %.3f %.3f 0 %d", yaw - m.fov_rad / 2, m.fov_rad,
          m.fov_rad / (m.beams - 1), m.range_max_m, std::max(m.resolution_m, 0.001), m.beams);
    print_ranges(text, ranges);
    text += " 0 0 0 0 0 0 0 0 0 0 0 0";
  }
  print(text, " %.6f adit %.6f\n", stamp_s, stamp_s);
}

}  // namespace

void write_carmen(const std::string& file, const Log& log, CarmenStyle style, const Truth* truth) {
  const int at = find_view(log.rig, View::horizontal);
  if (at < 0) throw Error(file + ": the rig '" + log.rig.name + "' has no horizontal laser, which CARMEN logs need");
  const Mount& mount = log.rig.mounts[at];
  const Scans& scans = log.scans[at];
  std::string text =
      "# CARMEN Logfile\n# file format is one message per line\n"
      "# message_name [message contents] ipc_timestamp ipc_hostname logger_timestamp\n";
  print(text, "PARAM robot_front_laser_max %.3f 0 adit 0\n", mount.laser.range_max_m);
  for (size_t n = 0; n < scans.size(); ++n) {
    if (!scans.tilt_rad.empty() && scans.tilt_rad[n] != 0) continue;
    if (truth) {
      const Pose2 X = flatten(truth->drive.path.at(truth->scans[at].stamp_s[n]));
      print(text, "TRUEPOS %.6f %.6f %.9f 0 0 0 %.6f adit %.6f\n", X.x_m, X.y_m, X.yaw_rad, scans.stamp_s[n],
            scans.stamp_s[n]);
    }
    print_scan(text, mount, scans[n], scans.stamp_s[n], style);
  }
  write_text(file, text);
}

}  // namespace adit
