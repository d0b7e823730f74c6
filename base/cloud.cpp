// SPDX-License-Identifier: BSD-3-Clause
#include "base/cloud.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>

namespace adit {
namespace {

// The points of one scan in W, appended.
void add_scan(LabelledCloud& cloud, const Log& log, const Truth& truth, size_t laser, size_t scan) {
  const Mount& mount = truth.rig.mounts[laser];
  const ScanTruth& so = truth.scans[laser];
  const std::span<const float> ranges = log.scans[laser][scan];
  const Pose X_BS = so.X_BS(mount, scan);
  for (size_t k = 0; k < ranges.size(); ++k) {
    if (!std::isfinite(ranges[k])) continue;
    const double a = mount.laser.beam_angle_rad(static_cast<int>(k)), r = static_cast<double>(ranges[k]);
    const double stamp_s = so.stamp_s[scan] + mount.laser.beam_offset_s(static_cast<int>(k));
    cloud.points.p.push_back(truth.drive.path.at(stamp_s) * X_BS * Vec3(r * std::cos(a), r * std::sin(a), 0));
    cloud.points.stamp_s.push_back(stamp_s);
    cloud.points.laser.push_back(static_cast<std::uint8_t>(laser));
    cloud.label.push_back(so.label[scan * ranges.size() + k]);
    cloud.part.push_back(so.part[scan * ranges.size() + k]);
  }
}

void check_pair(const Log& log, const Truth& truth) {
  bool same = log.scans.size() == truth.scans.size();
  for (size_t i = 0; same && i < log.scans.size(); ++i) same = log.scans[i].size() == truth.scans[i].stamp_s.size();
  if (!same) throw Error("the log and the truth are not of the same recording: their scans differ in number");
}

}  // namespace

LabelledCloud true_cloud(const Log& log, const Truth& truth, size_t every) {
  check_pair(log, truth);
  LabelledCloud cloud;
  for (size_t laser = 0; laser < log.scans.size(); ++laser)
    for (size_t scan = 0; scan < log.scans[laser].size(); scan += every) add_scan(cloud, log, truth, laser, scan);
  return cloud;
}

void write_pcd(const std::string& file, const PointCloud& points) {
  const bool stamps = !points.stamp_s.empty(), lasers = !points.laser.empty(), sigmas = !points.sigma_m.empty();
  const std::string n = std::to_string(points.size());
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z" +
                     std::string(stamps ? " stamp_s" : "") + (lasers ? " laser" : "") + (sigmas ? " sigma_m" : "") +
                     "\nSIZE 4 4 4" + (stamps ? " 8" : "") + (lasers ? " 1" : "") + (sigmas ? " 4" : "") +
                     "\nTYPE F F F" + (stamps ? " F" : "") + (lasers ? " U" : "") + (sigmas ? " F" : "") +
                     "\nCOUNT 1 1 1" + (stamps ? " 1" : "") + (lasers ? " 1" : "") + (sigmas ? " 1" : "") + "\nWIDTH " +
                     n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n";
  const auto put = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(points.p[i][axis]));
    if (stamps) put(points.stamp_s[i]);
    if (lasers) put(points.laser[i]);
    if (sigmas) put(points.sigma_m[i]);
  }
  write_text(file, text);
}

namespace {

struct PcdField {
  std::string name;
  size_t size = 4, count = 1, at = 0;
  char type = 'F';
};

struct PcdHeader {
  std::vector<PcdField> fields;
  size_t points = 0, row = 0, data = 0;  // bytes of a point, and where the points begin
  bool binary = false;

  const PcdField* find(const std::string& name) const {
    const auto f = std::find_if(fields.begin(), fields.end(), [&](const PcdField& x) { return x.name == name; });
    return f == fields.end() ? nullptr : &*f;
  }
};

PcdHeader read_header(const std::string& file, const std::string& text) {
  PcdHeader h;
  const auto fail = [&](const std::string& what) { throw Error(file + ": " + what); };
  std::string storage;
  while (storage.empty()) {
    const size_t end = text.find('\n', h.data);
    if (end == std::string::npos) fail("is not a PCD file: it has no DATA line");
    std::istringstream words(text.substr(h.data, end - h.data));
    h.data = end + 1;
    std::string key;
    words >> key;
    if (key == "FIELDS")
      for (std::string name; words >> name;) h.fields.push_back({.name = name});
    for (PcdField& f : h.fields) {
      if (key == "SIZE") words >> f.size;
      if (key == "TYPE") words >> f.type;
      if (key == "COUNT") words >> f.count;
    }
    if (key == "POINTS") words >> h.points;
    if (key == "DATA") words >> storage;
    if (!words && key != "FIELDS" && !key.empty()) fail("the header's line " + key + " is cut short");
  }
  if (storage != "binary" && storage != "ascii") fail("DATA " + storage + " is not read; write it as binary or ascii");
  h.binary = storage == "binary";
  for (PcdField& f : h.fields) {
    f.at = h.row;
    if (f.size > 8 || f.count > 1000000) fail("the field " + f.name + " is too large");
    h.row += f.size * f.count;
  }
  for (const char* axis : {"x", "y", "z"}) {
    const PcdField* f = h.find(axis);
    if (!f || f->type != 'F' || f->count != 1 || (f->size != 4 && f->size != 8))
      fail(std::string("needs a field ") + axis + " of type F and 4 or 8 bytes");
  }
  return h;
}

double float_at(const char* bytes, size_t size) {
  float f = 0;
  double d = 0;
  if (size == 4)
    std::memcpy(&f, bytes, 4);
  else
    std::memcpy(&d, bytes, 8);
  return size == 4 ? static_cast<double>(f) : d;
}

PointCloud read_binary(const std::string& file, const std::string& text, const PcdHeader& h) {
  if (h.row == 0 || (text.size() - h.data) / h.row < h.points)
    throw Error(file + ": is cut short: it should hold " + std::to_string(h.points) + " points");
  PointCloud points;
  const PcdField *x = h.find("x"), *y = h.find("y"), *z = h.find("z"), *stamp = h.find("stamp_s"),
                 *laser = h.find("laser"), *sigma = h.find("sigma_m");
  for (size_t i = 0; i < h.points; ++i) {
    const char* row = text.data() + h.data + i * h.row;
    points.p.emplace_back(float_at(row + x->at, x->size), float_at(row + y->at, y->size),
                          float_at(row + z->at, z->size));
    if (stamp && stamp->type == 'F' && stamp->size == 8) points.stamp_s.push_back(float_at(row + stamp->at, 8));
    if (laser && laser->size == 1) points.laser.push_back(static_cast<std::uint8_t>(row[laser->at]));
    if (sigma && sigma->type == 'F')
      points.sigma_m.push_back(static_cast<float>(float_at(row + sigma->at, sigma->size)));
  }
  return points;
}

PointCloud read_ascii(const std::string& file, const std::string& text, const PcdHeader& h) {
  PointCloud points;
  std::istringstream in(text.substr(h.data));
  for (size_t i = 0; i < h.points; ++i) {
    std::map<std::string, double> value;
    for (const PcdField& f : h.fields)
      for (size_t k = 0; k < f.count; ++k) {
        std::string word;  // "nan" is a number here
        if (!(in >> word)) throw Error(file + ": is cut short at point " + std::to_string(i));
        value[f.name] = std::strtod(word.c_str(), nullptr);
      }
    points.p.emplace_back(value["x"], value["y"], value["z"]);
    if (value.contains("stamp_s")) points.stamp_s.push_back(value["stamp_s"]);
    if (value.contains("laser")) points.laser.push_back(static_cast<std::uint8_t>(value["laser"]));
    if (value.contains("sigma_m")) points.sigma_m.push_back(static_cast<float>(value["sigma_m"]));
  }
  return points;
}

}  // namespace

PointCloud read_pcd(const std::string& file) {
  const std::string text = read_text(file);
  const PcdHeader header = read_header(file, text);
  return header.binary ? read_binary(file, text, header) : read_ascii(file, text, header);
}

PointCloud read_cloud(const std::string& file) {
  PointCloud points = file.ends_with(".pcd") ? read_pcd(file) : read_points(file);
  if (points.size() == 0) throw Error(file + ": no point in it");
  return points;
}

namespace {

std::string frame_name(size_t n) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu", n);
  return name;
}

void write_frame(const std::string& dir, size_t n, const LabelledCloud& cloud, const Pose& X_WB) {
  std::string points, labels;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3 p_B = X_WB.inverse() * cloud.points.p[i];
    for (const double v : {p_B.x(), p_B.y(), p_B.z(), 0.0}) {
      const auto f = static_cast<float>(v);
      points.append(reinterpret_cast<const char*>(&f), sizeof f);
    }
    const std::uint32_t label = cloud.label[i] | (static_cast<std::uint32_t>(cloud.part[i] + 1) << 16);
    labels.append(reinterpret_cast<const char*>(&label), sizeof label);
  }
  write_text(dir + "/velodyne/" + frame_name(n) + ".bin", points);
  write_text(dir + "/labels/" + frame_name(n) + ".label", labels);
}

}  // namespace

size_t write_kitti(const std::string& dir, const Log& log, const Truth& truth) {
  check_pair(log, truth);
  const int main = find_view(log.rig, View::horizontal);
  if (main < 0) throw Error(dir + ": the rig '" + log.rig.name + "' has no horizontal laser to count frames by");
  const std::vector<double>& begin_s = truth.scans[main].stamp_s;
  std::vector<size_t> next(log.scans.size(), 0);
  std::string poses, times;
  for (size_t n = 0; n < begin_s.size(); ++n) {
    LabelledCloud cloud;
    const double end_s = n + 1 < begin_s.size() ? begin_s[n + 1] : begin_s[n] + truth.rig.mounts[main].laser.interval_s;
    for (size_t laser = 0; laser < log.scans.size(); ++laser)
      for (size_t& scan = next[laser];
           scan < truth.scans[laser].stamp_s.size() && truth.scans[laser].stamp_s[scan] < end_s; ++scan)
        add_scan(cloud, log, truth, laser, scan);
    const Pose X_WB = truth.drive.path.at(begin_s[n]);
    write_frame(dir, n, cloud, X_WB);
    char line[64];
    for (int k = 0; k < 12; ++k) {
      std::snprintf(line, sizeof line, "%.9e%c", X_WB.matrix()(k / 4, k % 4), k == 11 ? '\n' : ' ');
      poses += line;
    }
    std::snprintf(line, sizeof line, "%.6e\n", begin_s[n]);
    times += line;
  }
  write_text(dir + "/poses.txt", poses);
  write_text(dir + "/times.txt", times);
  write_text(dir + "/calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  return begin_s.size();
}

}  // namespace adit
