// SPDX-License-Identifier: BSD-3-Clause
#include "base/path_file.h"

#include "base/error.h"
#include "base/files.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <sstream>

namespace adit {
namespace {

// Calls `row` with the numbers of each line that holds any; '#' begins a comment.
void for_rows(const std::string& file, const std::function<void(int line, const std::vector<double>&)>& row) {
  std::istringstream in(read_text(file));
  std::string line;
  std::vector<double> values;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    values.clear();
    for (const char* at = line.c_str();;) {
      at += std::strspn(at, " \t\r,");
      if (*at == '\0') break;
      char* end = nullptr;
      values.push_back(std::strtod(at, &end));
      const std::string place = file + ":" + std::to_string(number) + ": ";
      if (end == at) throw Error(place + "'" + at + "' is no number");
      if (!std::isfinite(values.back())) throw Error(place + "not a finite number");
      at = end;
    }
    if (!values.empty()) row(number, values);
  }
}

[[noreturn]] void fail(const std::string& file, int line, const std::string& what) {
  throw Error(file + ":" + std::to_string(line) + ": " + what);
}

Pose pose_of_rows(const std::string& file, int line, const std::vector<double>& v) {
  Pose X = Pose::Identity();
  for (int k = 0; k < 12; ++k) X.matrix()(k / 4, k % 4) = v[static_cast<size_t>(k)];
  const Eigen::Matrix3d R = X.linear();
  if (!(R * R.transpose()).isIdentity(0.01) || R.determinant() < 0)
    fail(file, line, "the first three columns are no rotation");
  X.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return X;
}

}  // namespace

bool is_kitti(const std::string& file) {
  std::istringstream in(read_text(file));
  for (std::string line; std::getline(in, line);) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    int count = 0;
    for (std::string word; words >> word;) ++count;
    if (count > 0) return count == 12;
  }
  return false;
}

Trajectory read_path(const std::string& file, const std::vector<double>& stamp_s) {
  if (!is_kitti(file)) {
    if (!stamp_s.empty())
      throw Error(file +
                  ": its lines have stamps of their own; only the poses of KITTI (twelve numbers a line) need others");
    return read_tum(file);
  }
  if (stamp_s.empty()) throw Error(file + ": the poses of KITTI have no stamps; give them (--stamps FILE, one a line)");
  Trajectory path;
  for_rows(file, [&](int line, const std::vector<double>& v) {
    if (v.size() != 12) fail(file, line, "expected twelve numbers, as the lines before have");
    path.X_WB.push_back(pose_of_rows(file, line, v));
  });
  if (path.X_WB.size() != stamp_s.size())
    throw Error(file + ": has " + std::to_string(path.X_WB.size()) + " poses, but there are " +
                std::to_string(stamp_s.size()) + " stamps; each pose needs its own");
  path.stamp_s = stamp_s;
  return path;
}

std::vector<double> read_stamps(const std::string& file) {
  std::vector<double> stamps;
  for_rows(file, [&](int line, const std::vector<double>& v) {
    if (v.size() != 1) fail(file, line, "expected one stamp");
    if (!stamps.empty() && v[0] <= stamps.back()) fail(file, line, "the stamp does not grow");
    stamps.push_back(v[0]);
  });
  if (stamps.empty()) throw Error(file + ": no stamp in it");
  return stamps;
}

void write_kitti_path(const std::string& file, const Trajectory& path) {
  std::string text;
  char word[40];
  for (const Pose& X : path.X_WB)
    for (int k = 0; k < 12; ++k) {
      std::snprintf(word, sizeof word, "%.17g%c", X.matrix()(k / 4, k % 4), k == 11 ? '\n' : ' ');
      text += word;
    }
  write_text(file, text);
}

std::vector<Eigen::MatrixXd> read_covariances(const std::string& file, const Trajectory& path) {
  std::vector<Eigen::MatrixXd> all;
  for_rows(file, [&](int line, const std::vector<double>& v) {
    if (v.size() != 7 && v.size() != 22)
      fail(file, line, "expected a stamp and 6 numbers (of x, y, yaw) or 21 (of x, y, z and three angles)");
    const Eigen::Index n = v.size() == 7 ? 3 : 6;
    if (!all.empty() && all.back().rows() != n) fail(file, line, "the lines before have another number of columns");
    if (all.size() >= path.size() || std::abs(v[0] - path.stamp_s[all.size()]) > 1e-6)
      fail(file, line, "the stamp is not that of the path's pose " + std::to_string(all.size()));
    Eigen::MatrixXd C(n, n);
    size_t k = 1;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = i; j < n; ++j) C(i, j) = C(j, i) = v[k++];
    all.push_back(C);
  });
  if (all.size() != path.size())
    throw Error(file + ": has " + std::to_string(all.size()) + " covariances, the path " + std::to_string(path.size()) +
                " poses");
  return all;
}

void write_covariances(const std::string& file, const Trajectory& path,
                       const std::vector<Eigen::MatrixXd>& covariance) {
  ADIT_CHECK(covariance.size() == path.size());
  std::string text;
  char word[40];
  for (size_t p = 0; p < path.size(); ++p) {
    std::snprintf(word, sizeof word, "%.9f", path.stamp_s[p]);
    text += word;
    for (Eigen::Index i = 0; i < covariance[p].rows(); ++i)
      for (Eigen::Index j = i; j < covariance[p].cols(); ++j) {
        std::snprintf(word, sizeof word, " %.17g", covariance[p](i, j));
        text += word;
      }
    text += "\n";
  }
  write_text(file, text);
}

}  // namespace adit
