// SPDX-License-Identifier: BSD-3-Clause
#include "eval/scene.h"

#include <cmath>
#include <numbers>

namespace adit {

std::optional<Vec3> project(const Camera& camera, int width, int height, const Vec3& p_W) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), above = right.cross(forward);
  const Vec3 d = p_W - camera.eye;
  const double depth = forward.dot(d);
  if (camera.fov_rad > 0 && depth < camera.near_m) return {};
  const double half = camera.fov_rad > 0 ? depth * std::tan(camera.fov_rad / 2) : camera.height_m / 2;
  const double px_per_m = height / 2.0 / half;
  return Vec3(width / 2.0 + right.dot(d) * px_per_m, height / 2.0 - above.dot(d) * px_per_m, depth);
}

namespace {

// Bodies have sharp edges, and what fell lies in pieces.
bool creased(Label label) {
  return is_numbered(label) || label == Label::talus;
}
bool round(Label label) {
  return label == Label::post || label == Label::pipe || label == Label::cable || label == Label::water;
}

}  // namespace

Skin skin_of(const Mesh& mesh, const std::function<Colour(std::uint32_t, Label)>& colour_of,
             const std::function<bool(size_t)>& keep) {
  constexpr int labels = 8;
  constexpr std::uint32_t none = ~0u;
  std::vector<std::array<std::uint32_t, labels>> copy(mesh.vertex.size());
  for (auto& copies : copy) copies.fill(none);
  Skin skin;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    if (keep && !keep(f)) continue;
    const Label label = mesh.label.empty() ? Label::none : mesh.label[f];
    const Vec3 normal = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
    std::array<std::uint32_t, 3> face;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.face[f][k];
      std::uint32_t own = none;
      std::uint32_t& index = creased(label) && !round(label) ? own : copy[v][static_cast<int>(label) % labels];
      if (index == none) {
        index = static_cast<std::uint32_t>(skin.p.size());
        skin.p.push_back(mesh.vertex[v].cast<float>());
        skin.normal.push_back(Eigen::Vector3f::Zero());
        skin.colour.push_back(colour_of(v, label));
      }
      face[k] = index;
      skin.normal[index] += normal.cast<float>();
    }
    skin.face.push_back(face);
  }
  for (auto& n : skin.normal) n.normalize();
  return skin;
}

Colour thing_colour(Label label) {
  switch (label) {
    case Label::post:
    case Label::crossbar:
    case Label::crib:
    case Label::beam:
      return rgb(0xb98a4e);
    case Label::tie:
      return rgb(0x6e5236);
    case Label::bolt:
    case Label::rail:
      return rgb(0x8e5a44);
    case Label::pipe:
      return rgb(0x7d8f9c);
    case Label::car:
      return rgb(0xa0522d);
    case Label::belt:
      return rgb(0x3a3f45);
    case Label::cable:
      return rgb(0x23252a);
    case Label::stopping:
      return rgb(0xc9c6bd);
    case Label::door:
      return rgb(0xb03a2e);
    case Label::water:
      return rgb(0x2f5d73);
    case Label::sludge:
      return rgb(0xc98a2b);
    case Label::talus:
      return rgb(0x4d4a49);
    case Label::cavity:
    case Label::scar:
      return rgb(0x5c534e);  // fresh rock, no dust
    case Label::rubble:
      return rgb(0x6d6863);
    default:
      return rgb(0x837c76);  // block
  }
}

Skin tube(const std::vector<Vec3>& line, double radius_m, Colour colour) {
  constexpr int sides = 8;
  Skin skin;
  if (line.size() < 2) return skin;
  for (size_t k = 0; k < line.size(); ++k) {
    const Vec3 along = line[std::min(k + 1, line.size() - 1)] - line[k > 0 ? k - 1 : 0];
    const Vec3 t = along.norm() > 1e-9 ? Vec3(along.normalized()) : Vec3::UnitX();
    const Vec3 side = t.cross(std::abs(t.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized(), top = side.cross(t);
    for (int s = 0; s < sides; ++s) {
      const double a = 2 * std::numbers::pi * s / sides;
      const Vec3 n = std::cos(a) * side + std::sin(a) * top;
      skin.p.push_back((line[k] + radius_m * n).cast<float>());
      skin.normal.push_back(n.cast<float>());
      skin.colour.push_back(colour);
    }
    if (k == 0) continue;
    const auto b = static_cast<std::uint32_t>(k * sides), a = b - sides;
    for (std::uint32_t s = 0; s < sides; ++s) {
      const std::uint32_t next = (s + 1) % sides;
      skin.face.push_back({a + s, a + next, b + s});
      skin.face.push_back({a + next, b + next, b + s});
    }
  }
  return skin;
}

void append(Skin& skin, const Skin& more) {
  const auto base = static_cast<std::uint32_t>(skin.p.size());
  skin.p.insert(skin.p.end(), more.p.begin(), more.p.end());
  skin.normal.insert(skin.normal.end(), more.normal.begin(), more.normal.end());
  skin.colour.insert(skin.colour.end(), more.colour.begin(), more.colour.end());
  for (const auto& f : more.face) skin.face.push_back({f[0] + base, f[1] + base, f[2] + base});
}

void add_ball(Skin& skin, const Vec3& centre, double radius_m, Colour colour) {
  constexpr int rings = 10, sectors = 20;
  const auto base = static_cast<std::uint32_t>(skin.p.size());
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double polar = std::numbers::pi * i / rings, turn = 2 * std::numbers::pi * j / sectors;
      const Vec3 n(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      skin.p.push_back((centre + radius_m * n).cast<float>());
      skin.normal.push_back(n.cast<float>());
      skin.colour.push_back(colour);
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < sectors; ++j) {
      const std::uint32_t a = base + i * sectors + j, b = base + i * sectors + (j + 1) % sectors;
      skin.face.push_back({a, a + sectors, b});
      skin.face.push_back({b, a + sectors, b + sectors});
    }
}

void add_box(Skin& skin, const Vec3& low, const Vec3& high, const Pose& X_WB, Colour colour) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      const auto first = static_cast<std::uint32_t>(skin.p.size());
      Vec3 normal = Vec3::Zero();
      normal[axis] = side ? 1 : -1;
      for (int k = 0; k < 4; ++k) {
        Vec3 p;
        p[axis] = side ? high[axis] : low[axis];
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        p[u] = (k == 1 || k == 2) ? high[u] : low[u];
        p[v] = k >= 2 ? high[v] : low[v];
        skin.p.push_back((X_WB * p).cast<float>());
        skin.normal.push_back((X_WB.linear() * normal).cast<float>());
        skin.colour.push_back(colour);
      }
      if (side) {
        skin.face.push_back({first, first + 1, first + 2});
        skin.face.push_back({first, first + 2, first + 3});
      } else {
        skin.face.push_back({first, first + 2, first + 1});
        skin.face.push_back({first, first + 3, first + 2});
      }
    }
}

}  // namespace adit
