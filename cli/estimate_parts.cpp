// SPDX-License-Identifier: BSD-3-Clause
#include "cli/estimate_parts.h"

#include "base/cloud.h"
#include "base/error.h"
#include "base/files.h"
#include "base/path_file.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

// The covariance of B's pose from that of S's: both errors are seen from their own frame.
Eigen::MatrixXd moved(const Eigen::MatrixXd& C, const Pose& X_BS) {
  const Vec3 t = X_BS.translation();
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  A.topLeftCorner<3, 3>() = A.bottomRightCorner<3, 3>() = X_BS.linear();
  A.topRightCorner<3, 3>() = cross * X_BS.linear();
  if (C.rows() == 6) return A * C * A.transpose();
  const int plane[3] = {0, 1, 5};
  Eigen::Matrix3d P;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P(i, j) = A(plane[i], plane[j]);
  return P * C * P.transpose();
}

// The body's path from that of a laser where its nominal mount puts it; M stays the frame that the path is told in.
void lay_on_body(Estimate& e, const Rig& nominal, const std::string& laser) {
  std::string known;
  for (const Mount& mount : nominal.mounts) {
    known += (known.empty() ? "" : ", ") + mount.name;
    if (mount.name != laser) continue;
    const Pose X_SB = mount.X_BS.inverse();
    for (Pose& X : e.path.X_WB) X = X * X_SB;
    for (Eigen::MatrixXd& C : e.covariance) C = moved(C, mount.X_BS);
    return;
  }
  throw Error("laser '" + laser + "': the rig '" + nominal.name + "' has " + known);
}

std::vector<double> scan_stamps(const Log* log) {
  const int laser = log ? find_view(log->rig, View::horizontal) : -1;
  return laser < 0 ? std::vector<double>{} : log->scans[static_cast<size_t>(laser)].stamp_s;
}

Trajectory path_of(const EstimateParts& parts, const Log* log) {
  if (!parts.stamps.empty()) return read_path(parts.trajectory, read_stamps(parts.stamps));
  return is_kitti(parts.trajectory) ? read_path(parts.trajectory, scan_stamps(log)) : read_path(parts.trajectory);
}

}  // namespace

bool EstimateParts::any() const {
  for (const std::string* part : {&trajectory, &stamps, &covariance, &points, &grid, &surface, &laser})
    if (!part->empty()) return true;
  return volume_m3 != -1;
}

EstimateParts parts_in(const std::string& folder) {
  const auto first = [&](std::initializer_list<const char*> names) -> std::string {
    for (const char* name : names)
      if (fs::exists(fs::path(folder) / name)) return (fs::path(folder) / name).string();
    return "";
  };
  EstimateParts parts;
  parts.trajectory = first({"trajectory.tum", "trajectory.kitti"});
  parts.stamps = first({"stamps.txt"});
  parts.covariance = first({"path_covariance.txt"});
  parts.points = first({"points.ply", "points.pcd"});
  parts.grid = first({"grid.yaml"});
  parts.surface = first({"surface.ply", "surface.obj"});
  if (const std::string file = first({"volume.txt"}); !file.empty()) {
    const std::string text = read_text(file);
    char* end = nullptr;
    parts.volume_m3 = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || !(parts.volume_m3 >= 0) || !std::isfinite(parts.volume_m3))
      throw Error(file + ": expected the volume in m3, one number");
  }
  return parts;
}

Estimate load_parts(const EstimateParts& parts, const Log* log) {
  Estimate e;
  e.method = fs::path(parts.trajectory).stem().string();
  e.path = path_of(parts, log);
  if (!parts.covariance.empty()) e.covariance = read_covariances(parts.covariance, e.path);
  if (!parts.laser.empty()) {
    if (!log) throw Error("laser '" + parts.laser + "': no rig is known that would say where it sits");
    lay_on_body(e, log->rig, parts.laser);
  }
  if (!parts.points.empty()) e.points = read_cloud(parts.points);
  if (!parts.grid.empty()) e.grid = read_grid(parts.grid);
  if (!parts.surface.empty()) e.surface = read_mesh(parts.surface);
  if (!std::isfinite(parts.volume_m3)) throw Error("--volume: must be a number of m3");
  if (parts.volume_m3 >= 0) e.volume_m3 = parts.volume_m3;
  return e;
}

}  // namespace adit
