// SPDX-License-Identifier: BSD-3-Clause
#include "base/bag.h"

#include "base/bag_format.h"
#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

namespace adit {
namespace {

constexpr double degree = std::numbers::pi / 180;

// What the types of messages are made of, as their packages define them, without remarks.
const std::string rule = std::string(80, '=') + "\n";
const std::string header_text = rule + "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const std::string vector_text = rule + "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const std::string quaternion_text =
    rule + "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

const std::string scan_type = "sensor_msgs/LaserScan", tf_type = "tf2_msgs/TFMessage",
                  odometry_type = "nav_msgs/Odometry";

const std::string scan_text =
    "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n"
    "float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n" +
    header_text;
const std::string tf_text = "geometry_msgs/TransformStamped[] transforms\n" + rule +
                            "MSG: geometry_msgs/TransformStamped\nHeader header\nstring child_frame_id\n"
                            "Transform transform\n" +
                            header_text + rule +
                            "MSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n" + vector_text +
                            quaternion_text;
const std::string odometry_text =
    "Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
    "geometry_msgs/TwistWithCovariance twist\n" +
    header_text + rule + "MSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n" + rule +
    "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n" + rule +
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + quaternion_text + rule +
    "MSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n" + rule +
    "MSG: geometry_msgs/Twist\nVector3  linear\nVector3  angular\n" + vector_text;

constexpr const char* scan_md5 = "90c7ef2dc6895d81024acba2ac42f369";
constexpr const char* tf_md5 = "94810edda583a504dfda3829e70d7eec";
constexpr const char* odometry_md5 = "cd5e73d190d741a2f92e81eda573aca7";

// A time of a bag is never 0.
BagTime bag_time(double stamp_s) {
  return static_cast<BagTime>(std::max(1.0, std::round(stamp_s * 1e9)));
}

// Writes a message field by field, little endian.
class Letter {
 public:
  template <class T>
  Letter& put(T value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Letter& put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    text_ += text;
    return *this;
  }
  Letter& put_time(BagTime t) {
    return put(static_cast<std::uint32_t>(t / 1000000000)).put(static_cast<std::uint32_t>(t % 1000000000));
  }
  Letter& put_header(std::uint32_t seq, BagTime t, const std::string& frame) { return put(seq).put_time(t).put(frame); }
  Letter& put_pose(const Pose& X) {
    for (int i = 0; i < 3; ++i) put(X.translation()[i]);
    const Eigen::Quaterniond q(X.linear());
    return put(q.x()).put(q.y()).put(q.z()).put(q.w());
  }
  Letter& put_zeros(size_t n) {
    for (size_t i = 0; i < n; ++i) put(0.0);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// Reads one. Bytes that run out are a broken message.
class Opened {
 public:
  explicit Opened(std::string_view text) : text_(text) {}
  template <class T>
  T get() {
    if (text_.size() < sizeof(T)) throw Error("a message of the bag is cut short");
    T value;
    std::memcpy(&value, text_.data(), sizeof value);
    text_.remove_prefix(sizeof value);
    return value;
  }
  std::string get_text() {
    const size_t n = get<std::uint32_t>();
    if (text_.size() < n) throw Error("a message of the bag is cut short");
    std::string text(text_.substr(0, n));
    text_.remove_prefix(n);
    return text;
  }
  double get_stamp_s() {
    const auto seconds = get<std::uint32_t>(), nanoseconds = get<std::uint32_t>();
    return static_cast<double>(seconds) + 1e-9 * static_cast<double>(nanoseconds);
  }
  struct Header {
    double stamp_s;
    std::string frame;
  };
  Header get_header() {
    get<std::uint32_t>();
    const double stamp_s = get_stamp_s();
    return {stamp_s, get_text()};
  }
  Pose get_pose() {
    double v[7];
    for (double& x : v) x = get<double>();
    Pose X = Pose::Identity();
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (!(std::abs(q.norm() - 1) < 0.01)) throw Error("a message of the bag holds a rotation that is none");
    X.linear() = q.normalized().toRotationMatrix();
    X.translation() = Vec3(v[0], v[1], v[2]);
    return X;
  }
  std::vector<float> get_floats() {
    const size_t n = get<std::uint32_t>();
    if (text_.size() < 4 * n) throw Error("a message of the bag is cut short");
    std::vector<float> v(n);
    std::memcpy(v.data(), text_.data(), 4 * n);
    text_.remove_prefix(4 * n);
    return v;
  }

 private:
  std::string_view text_;
};

std::string scan_message(const Mount& mount, const Scans& scans, size_t n, BagTime time) {
  const LaserModel& m = mount.laser;
  const double step_rad = m.fov_rad / (m.beams - 1);
  Letter letter;
  letter.put_header(static_cast<std::uint32_t>(n), time, mount.name);
  for (const double x : {-m.fov_rad / 2, m.fov_rad / 2, step_rad, m.turn_s * step_rad / (2 * std::numbers::pi),
                         m.turn_s * m.interlace, 0.0, m.range_max_m})
    letter.put(static_cast<float>(x));
  letter.put(static_cast<std::uint32_t>(m.beams));
  for (const float r : scans[n]) letter.put(r);
  return letter.put(std::uint32_t{0}).text();
}

std::string tf_message(std::uint32_t seq, BagTime time, const std::string& frame, const std::string& child,
                       const Pose& X) {
  return Letter().put(std::uint32_t{1}).put_header(seq, time, frame).put(child).put_pose(X).text();
}

std::string odometry_message(std::uint32_t seq, BagTime time, const Pose& X) {
  Letter letter;
  letter.put_header(seq, time, "world").put(std::string("base_link")).put_pose(X);
  return letter.put_zeros(36).put_zeros(6).put_zeros(36).text();
}

// One message that waits for its turn.
struct Turn {
  BagTime time;
  size_t laser, scan;  // laser == number of lasers: the path's pose `scan`
};

std::vector<Turn> turns_of(const Log& log, const Truth* truth) {
  std::vector<Turn> turns;
  for (size_t i = 0; i < log.scans.size(); ++i)
    for (size_t n = 0; n < log.scans[i].size(); ++n) turns.push_back({bag_time(log.scans[i].stamp_s[n]), i, n});
  if (truth) {
    constexpr double least_s = 0.99 / 30;
    const std::vector<double>& stamps = truth->drive.path.stamp_s;
    double last_s = -least_s;
    for (size_t n = 0; n < stamps.size(); ++n) {
      if (stamps[n] - last_s < least_s && n + 1 < stamps.size()) continue;
      turns.push_back({bag_time(stamps[n]), log.scans.size(), n});
      last_s = stamps[n];
    }
  }
  std::stable_sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) { return a.time < b.time; });
  return turns;
}

void write_messages(std::ostream& out, const Log& log, const Truth* truth) {
  BagWriter bag(out);
  const std::vector<Turn> turns = turns_of(log, truth);
  if (turns.empty()) throw Error("a recording without a scan makes no bag");
  std::vector<std::uint32_t> scan_topics;
  for (const Mount& mount : log.rig.mounts)
    scan_topics.push_back(bag.connect({"/" + mount.name + "/scan", scan_type, scan_md5, scan_text}));
  const std::uint32_t fixed = bag.connect({"/tf_static", tf_type, tf_md5, tf_text, true});
  const std::uint32_t moving = bag.connect({"/tf", tf_type, tf_md5, tf_text});
  const std::uint32_t odometry = bag.connect({"/truth/odom", odometry_type, odometry_md5, odometry_text});
  Letter mounts;
  const auto still = static_cast<std::uint32_t>(
      std::count_if(log.rig.mounts.begin(), log.rig.mounts.end(), [](const Mount& m) { return !m.tilt.nods(); }));
  mounts.put(still);
  for (const Mount& m : log.rig.mounts)
    if (!m.tilt.nods()) mounts.put_header(0, turns.front().time, "base_link").put(m.name).put_pose(m.X_BS);
  bag.write(fixed, turns.front().time, mounts.text());
  for (const Turn& t : turns) {
    const auto seq = static_cast<std::uint32_t>(t.scan);
    if (t.laser == log.scans.size()) {
      const Pose& X = truth->drive.path.X_WB[t.scan];
      bag.write(odometry, t.time, odometry_message(seq, t.time, X));
      bag.write(moving, t.time, tf_message(seq, t.time, "world", "truth/base_link", X));
      continue;
    }
    const Mount& mount = log.rig.mounts[t.laser];
    const Scans& scans = log.scans[t.laser];
    if (!scans.tilt_rad.empty())
      bag.write(moving, t.time, tf_message(seq, t.time, "base_link", mount.name, scans.X_BS(mount, t.scan)));
    bag.write(scan_topics[t.laser], t.time, scan_message(mount, scans, t.scan, t.time));
  }
  bag.close();
}

}  // namespace

void write_bag(const std::string& file, const Log& log, const Truth* truth) {
  write_whole(file, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    write_messages(out, log, truth);
    out.close();
    if (!out) throw Error(file + ": cannot write: " + std::strerror(errno), Fault::file);
  });
}

namespace {

// One topic of scans as its messages come in.
struct Topic {
  std::string frame;
  float angle_min = 0, step = 0, time_step = 0, scan_s = 0, max_m = 0;
  Scans scans;
  size_t left_out = 0;  // of another raster, or with a stamp that does not grow
};

struct Frame {
  std::string parent;
  Pose X = Pose::Identity();  // in the parent
  bool fixed = true;
};

struct Gathered {
  std::map<std::string, Topic> topics;
  std::map<std::string, Frame> frames;  // by child
  std::map<std::string, Trajectory> paths;
  size_t broken = 0;
};

std::string without_slash(std::string frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

void take_scan(Topic& topic, Opened m) {
  const Opened::Header header = m.get_header();
  const float angle_min = m.get<float>();
  m.get<float>();
  const float step = m.get<float>(), time_step = m.get<float>(), scan_s = m.get<float>(), min_m = m.get<float>(),
              max_m = m.get<float>();
  std::vector<float> ranges = m.get_floats();
  if (topic.scans.size() == 0) {
    if (ranges.size() < 2 || step == 0) throw Error("a scan of the bag has no raster");
    topic.frame = without_slash(header.frame);
    topic.angle_min = angle_min, topic.step = step, topic.time_step = time_step, topic.scan_s = scan_s,
    topic.max_m = max_m;
    topic.scans.beams = static_cast<int>(ranges.size());
  }
  Scans& scans = topic.scans;
  if (ranges.size() != static_cast<size_t>(scans.beams) || std::abs(step - topic.step) > 1e-6F ||
      (scans.size() > 0 && header.stamp_s <= scans.stamp_s.back())) {
    ++topic.left_out;
    return;
  }
  for (float& r : ranges) {
    if (r < min_m) r = std::numeric_limits<float>::quiet_NaN();
    if (r >= max_m) r = std::numeric_limits<float>::infinity();
  }
  // A laser that hangs head down counts the other way round.
  if (step < 0) std::reverse(ranges.begin(), ranges.end());
  scans.range_m.insert(scans.range_m.end(), ranges.begin(), ranges.end());
  scans.stamp_s.push_back(header.stamp_s);
}

void take_tf(std::map<std::string, Frame>& frames, Opened m, bool fixed) {
  for (auto n = m.get<std::uint32_t>(); n > 0; --n) {
    const std::string parent = without_slash(m.get_header().frame), child = without_slash(m.get_text());
    const Pose X = m.get_pose();
    const auto [found, fresh] = frames.try_emplace(child, Frame{parent, X, true});
    // Told again and again by old publishers, which makes it no less fixed.
    if (!fresh && !fixed && !found->second.X.isApprox(X, 1e-6)) found->second.fixed = false;
  }
}

void take_odometry(Trajectory& path, Opened m) {
  const double stamp_s = m.get_header().stamp_s;
  m.get_text();
  const Pose X = m.get_pose();
  if (!path.empty() && stamp_s <= path.stamp_s.back()) return;
  path.stamp_s.push_back(stamp_s);
  path.X_WB.push_back(X);
}

void take(Gathered& all, const BagConnection& c, std::string_view text) {
  try {
    if (c.type == scan_type) take_scan(all.topics[c.topic], Opened(text));
    if (c.type == tf_type || c.type == "tf/tfMessage")
      take_tf(all.frames, Opened(text), c.topic.ends_with("tf_static"));
    if (c.type == odometry_type) take_odometry(all.paths[c.topic], Opened(text));
  } catch (const Error&) {
    ++all.broken;
  }
}

// "/front/scan" becomes "front", "/scan" "scan".
std::string laser_name(const std::string& topic) {
  std::string name = without_slash(topic);
  if (name.ends_with("/scan")) name.resize(name.size() - 5);
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

Mount mount_of(const std::string& topic_name, const Topic& topic, const std::map<std::string, Frame>& frames,
               std::vector<std::string>& notes) {
  Mount mount{.name = laser_name(topic_name), .laser = load_laser("lms200", 0)};
  LaserModel& m = mount.laser;
  const double step_rad = std::abs(static_cast<double>(topic.step));
  m.beams = topic.scans.beams;
  m.fov_rad = step_rad * (m.beams - 1);
  m.range_max_m = static_cast<double>(topic.max_m);
  const double turn_s = static_cast<double>(topic.time_step) * 2 * std::numbers::pi / step_rad;
  if (turn_s > 0) m.turn_s = turn_s;
  m.interlace = turn_s > 0 ? std::clamp(static_cast<int>(std::lround(static_cast<double>(topic.scan_s) / turn_s)), 1, 4)
                           : std::clamp(static_cast<int>(std::lround(degree / step_rad)), 1, 4);
  const std::vector<double>& t = topic.scans.stamp_s;
  m.interval_s = m.turn_s * m.interlace;
  if (t.size() > 1) m.interval_s = std::max(m.interval_s, (t.back() - t.front()) / static_cast<double>(t.size() - 1));
  const double middle_rad = static_cast<double>(topic.angle_min) + static_cast<double>(topic.step) * (m.beams - 1) / 2;
  Pose X = pose_of(Vec3::Zero(), middle_rad);
  bool found = false;
  size_t steps = 0;
  for (auto f = frames.find(topic.frame); f != frames.end() && steps < 100;
       f = frames.find(f->second.parent), ++steps) {
    if (!f->second.fixed && found) break;
    if (!f->second.fixed)
      notes.push_back(topic_name + ": its frame '" + topic.frame + "' moves in the bag; its first pose is taken");
    X = f->second.X * X;
    found = true;
  }
  if (!found)
    notes.push_back(topic_name + ": no tf of its frame '" + topic.frame + "'; it is taken for the body's origin");
  mount.X_BS = X;
  return mount;
}

}  // namespace

BagLog read_bag(const std::string& file) {
  Gathered all;
  BagLog out;
  const std::string cut =
      scan_bag(file, [&](const BagConnection& c, BagTime, std::string_view text) { take(all, c, text); });
  if (!cut.empty()) out.notes.push_back(file + ": " + cut);
  if (all.broken > 0) out.notes.push_back(file + ": " + std::to_string(all.broken) + " broken messages are left out");
  out.log.rig.name = "bag";
  for (const auto& [name, topic] : all.topics) {
    if (topic.scans.size() == 0) continue;
    if (topic.left_out > 0)
      out.notes.push_back(name + ": " + std::to_string(topic.left_out) +
                          " scans of another raster, or with a stamp that does not grow, are left out");
    out.log.rig.mounts.push_back(mount_of(name, topic, all.frames, out.notes));
    out.log.scans.push_back(topic.scans);
  }
  if (out.log.scans.empty())
    throw Error(file + ": has no message of sensor_msgs/LaserScan" + (cut.empty() ? "" : "; it " + cut));
  const auto truth = all.paths.find("/truth/odom");
  const auto path = truth != all.paths.end() ? truth : all.paths.begin();
  if (path != all.paths.end()) out.path = path->second;
  if (path != all.paths.end() && path != truth) out.notes.push_back("the path is that of " + path->first);
  return out;
}

}  // namespace adit
