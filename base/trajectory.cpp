// SPDX-License-Identifier: BSD-3-Clause
#include "base/trajectory.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace adit {

Pose Trajectory::at(double t_s) const {
  ADIT_CHECK(!empty());
  const auto next = std::upper_bound(stamp_s.begin(), stamp_s.end(), t_s);
  if (next == stamp_s.begin()) return X_WB.front();
  if (next == stamp_s.end()) return X_WB.back();
  const size_t k = static_cast<size_t>(next - stamp_s.begin());
  const double s = (t_s - stamp_s[k - 1]) / (stamp_s[k] - stamp_s[k - 1]);
  return interpolate(X_WB[k - 1], X_WB[k], s);
}

std::vector<double> distance_along(const Trajectory& path) {
  std::vector<double> d(path.size(), 0.0);
  for (size_t i = 1; i < path.size(); ++i)
    d[i] = d[i - 1] + (path.X_WB[i].translation() - path.X_WB[i - 1].translation()).norm();
  return d;
}

double Trajectory::length_m() const {
  const std::vector<double> d = distance_along(*this);
  return d.empty() ? 0 : d.back();
}

namespace {

// The finite numbers of a line, at most one more than a pose may have; `fail` says what is wrong with it.
template <typename Fail>
std::vector<double> numbers_of(const std::string& line, const Fail& fail) {
  std::vector<double> v;
  for (const char* at = line.c_str(); v.size() < 9;) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) {
      if (at[std::strspn(at, " \t\r,")] != '\0') fail("'" + std::string(at) + "' is no number");
      break;
    }
    if (!std::isfinite(value)) fail("not a finite number");
    v.push_back(value);
    at = end;
  }
  return v;
}

}  // namespace

Trajectory read_tum(const std::string& file) {
  std::istringstream in(read_text(file));
  Trajectory path;
  size_t columns = 0;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const size_t first = line.find_first_not_of(" \t\r,");
    if (first == std::string::npos || line[first] == '#') continue;
    const auto fail = [&](const std::string& why) { throw Error(file + ":" + std::to_string(number) + ": " + why); };
    const std::vector<double> v = numbers_of(line, fail);
    if (v.size() != 8 && v.size() != 4)
      fail("expected 't x y z qx qy qz qw' (TUM format), or 't x y yaw' of a path in the plane");
    if (columns != 0 && v.size() != columns) fail("the lines before have " + std::to_string(columns) + " numbers");
    columns = v.size();
    if (!path.empty() && v[0] <= path.stamp_s.back()) fail("the stamp does not grow");
    Pose X = Pose::Identity();
    if (columns == 8) {
      const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
      if (std::abs(q.norm() - 1) > 0.01) fail("the quaternion's norm is " + std::to_string(q.norm()) + ", must be 1");
      X.linear() = q.normalized().toRotationMatrix();
      X.translation() = Vec3(v[1], v[2], v[3]);
    } else {
      X.linear() = Eigen::AngleAxisd(v[3], Vec3::UnitZ()).toRotationMatrix();
      X.translation() = Vec3(v[1], v[2], 0);
    }
    path.stamp_s.push_back(v[0]);
    path.X_WB.push_back(X);
  }
  if (path.empty()) throw Error(file + ": no pose in it");
  return path;
}

void write_tum(const std::string& file, const Trajectory& path) {
  std::string text;
  char line[256];
  for (size_t i = 0; i < path.size(); ++i) {
    Eigen::Quaterniond q(path.X_WB[i].linear());
    if (q.w() < 0) q.coeffs() *= -1;
    const Vec3& p = path.X_WB[i].translation();
    const int n = std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f %.12f %.12f %.12f %.12f\n", path.stamp_s[i],
                                p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line, static_cast<size_t>(n));
  }
  write_text(file, text);
}

}  // namespace adit
