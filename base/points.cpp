// SPDX-License-Identifier: BSD-3-Clause
#include "base/points.h"

#include "base/error.h"
#include "base/ply.h"

namespace adit {

void write_points(const std::string& file, const PointCloud& points) {
  PlyElement e{"vertex", points.size(), {}};
  for (int axis = 0; axis < 3; ++axis) {
    PlyColumn c{std::string(1, "xyz"[axis]), PlyType::float32, false, {}, {}};
    c.value.reserve(points.size());
    for (const Vec3& p : points.p) c.value.push_back(p[axis]);
    e.columns.push_back(std::move(c));
  }
  if (!points.stamp_s.empty()) e.columns.push_back({"stamp_s", PlyType::float64, false, points.stamp_s, {}});
  if (!points.laser.empty())
    e.columns.push_back({"laser", PlyType::uint8, false, {points.laser.begin(), points.laser.end()}, {}});
  if (!points.sigma_m.empty())
    e.columns.push_back({"sigma_m", PlyType::float32, false, {points.sigma_m.begin(), points.sigma_m.end()}, {}});
  write_ply(file, {{std::move(e)}});
}

PointCloud read_points(const std::string& file) {
  const Ply ply = read_ply(file);
  const PlyElement* e = ply.find("vertex");
  if (!e) throw Error(file + ": has no element 'vertex'; a point cloud is needed");
  const PlyColumn* xyz[3] = {e->find("x"), e->find("y"), e->find("z")};
  for (const PlyColumn* c : xyz)
    if (!c || c->list) throw Error(file + ": element 'vertex' lacks x, y or z");
  PointCloud points;
  points.p.resize(e->rows);
  for (size_t i = 0; i < e->rows; ++i) points.p[i] = Vec3(xyz[0]->value[i], xyz[1]->value[i], xyz[2]->value[i]);
  if (const PlyColumn* c = e->find("stamp_s"); c && !c->list) points.stamp_s = c->value;
  if (const PlyColumn* c = e->find("laser"); c && !c->list)
    for (double v : c->value) points.laser.push_back(static_cast<std::uint8_t>(v));
  if (const PlyColumn* c = e->find("sigma_m"); c && !c->list) points.sigma_m.assign(c->value.begin(), c->value.end());
  return points;
}

}  // namespace adit
