// SPDX-License-Identifier: BSD-3-Clause
#include "rays/caster.h"

#include "base/error.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace adit {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// One instruction set everywhere: other ones change the last bits of the ranges.
RTCDevice make_device() {
  if (!__builtin_cpu_supports("avx2"))
    throw Error("this processor has no AVX2, which adit needs so that ranges have the same bits everywhere",
                Fault::not_comparable);
  RTCDevice device = rtcNewDevice("isa=avx2,threads=0,set_affinity=0");
  if (!device) throw Error("Embree cannot start: error " + std::to_string(rtcGetDeviceError(nullptr)), Fault::file);
  return device;
}

// Ericson, Real-Time Collision Detection, 5.1.5.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double w = 1 / (va + vb + vc);
  return a + vb * w * ab + vc * w * ac;
}

}  // namespace

struct Caster::Impl {
  const Mesh* mesh = nullptr;
  Vec3 middle = Vec3::Zero();  // Embree works in floats about this point
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  // The exact range along the ray to the plane of the face that Embree found.
  Hit refined(const Ray& ray, unsigned face, float range) const {
    const Vec3 a = mesh->corner(face, 0);
    const Vec3 n = (mesh->corner(face, 1) - a).cross(mesh->corner(face, 2) - a);
    const double slope = n.dot(ray.direction);
    const double exact = n.dot(a - ray.origin) / slope;
    // Seen edge-on the plane says nothing; then the float stands.
    const bool sound = std::isfinite(exact) && std::abs(exact - range) < 1e-3 * (1 + range);
    return {sound ? exact : range, static_cast<std::int32_t>(face), slope / n.norm()};
  }

  // What up to 16 rays meet; the lanes beyond them stay empty.
  void intersect(std::span<const Ray> rays, RTCRayHit16& packet) const {
    alignas(64) int valid[16];
    for (size_t k = 0; k < 16; ++k) {
      const Ray& ray = rays[std::min(k, rays.size() - 1)];
      const Vec3 o = ray.origin - middle;
      valid[k] = k < rays.size() ? -1 : 0;
      packet.ray.org_x[k] = static_cast<float>(o.x());
      packet.ray.org_y[k] = static_cast<float>(o.y());
      packet.ray.org_z[k] = static_cast<float>(o.z());
      packet.ray.dir_x[k] = static_cast<float>(ray.direction.x());
      packet.ray.dir_y[k] = static_cast<float>(ray.direction.y());
      packet.ray.dir_z[k] = static_cast<float>(ray.direction.z());
      packet.ray.tnear[k] = 0;
      packet.ray.tfar[k] = static_cast<float>(ray.far_m);
      packet.ray.time[k] = 0;
      packet.ray.mask[k] = ~0u;
      packet.ray.id[k] = 0;
      packet.ray.flags[k] = 0;
      packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, &packet);
  }
};

Caster::Caster(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.mesh = &mesh;
  if (mesh.face.empty()) throw Error("a mesh without faces cannot be ray-cast");
  Vec3 low = mesh.vertex[0], high = low;
  for (const Vec3& v : mesh.vertex) low = low.cwiseMin(v), high = high.cwiseMax(v);
  m.middle = (low + high) / 2;
  m.device = make_device();
  m.scene = rtcNewScene(m.device);
  rtcSetSceneFlags(m.scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(m.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertex.size()));
  auto* faces = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                               3 * sizeof(unsigned), mesh.face.size()));
  ADIT_CHECK(vertices && faces);
  for (size_t i = 0; i < mesh.vertex.size(); ++i)
    for (int k = 0; k < 3; ++k) vertices[3 * i + k] = static_cast<float>(mesh.vertex[i][k] - m.middle[k]);
  for (size_t f = 0; f < mesh.face.size(); ++f) std::copy(mesh.face[f].begin(), mesh.face[f].end(), faces + 3 * f);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(m.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(m.scene);
}

Caster::~Caster() = default;
Caster::Caster(Caster&&) noexcept = default;
Caster& Caster::operator=(Caster&&) noexcept = default;

const Mesh& Caster::mesh() const {
  return *impl_->mesh;
}

Hit Caster::nearest(const Ray& ray) const {
  Hit hit;
  nearest(std::span<const Ray>(&ray, 1), std::span<Hit>(&hit, 1));
  return hit;
}

void Caster::nearest(std::span<const Ray> rays, std::span<Hit> hits) const {
  ADIT_CHECK(rays.size() == hits.size());
  alignas(64) RTCRayHit16 packet;
  for (size_t begin = 0; begin < rays.size(); begin += 16) {
    const size_t n = std::min<size_t>(16, rays.size() - begin);
    impl_->intersect(rays.subspan(begin, n), packet);
    for (size_t k = 0; k < n; ++k)
      hits[begin + k] = packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID
                            ? Hit{infinity, -1}
                            : impl_->refined(rays[begin + k], packet.hit.primID[k], packet.ray.tfar[k]);
  }
}

void Caster::glance(std::span<const Ray> rays, std::span<Glance> glances) const {
  ADIT_CHECK(rays.size() == glances.size());
  alignas(64) RTCRayHit16 packet;
  for (size_t begin = 0; begin < rays.size(); begin += 16) {
    const size_t n = std::min<size_t>(16, rays.size() - begin);
    impl_->intersect(rays.subspan(begin, n), packet);
    for (size_t k = 0; k < n; ++k) {
      // Embree's normal is not of unit length; like ours it looks out of a face that is counter-clockwise.
      const float x = packet.hit.Ng_x[k], y = packet.hit.Ng_y[k], z = packet.hit.Ng_z[k];
      const float along = x * packet.ray.dir_x[k] + y * packet.ray.dir_y[k] + z * packet.ray.dir_z[k];
      const bool met = packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      glances[begin + k] = {met ? packet.ray.tfar[k] : std::numeric_limits<float>::infinity(),
                            met ? static_cast<std::int32_t>(packet.hit.primID[k]) : -1,
                            met ? along / std::sqrt(x * x + y * y + z * z) : 0.0F};
    }
  }
}

namespace {

struct Query {
  const Mesh* mesh;
  Vec3 p;
  const Vec3* seen_along;  // or null
  double best;             // distance
  Vec3 point;
  std::int32_t face = -1;
};

constexpr double tie_m = 1e-10;  // rounding of coordinates a few hundred metres from their origin

// How squarely a face looks at p: where p is nearest to an edge or a corner, the face whose plane it is farthest from tells
// on which side p lies; another one may have it behind its back.
double facing(const Mesh& mesh, std::int32_t face, const Vec3& p, const Vec3& at) {
  return std::abs(mesh.normal(static_cast<size_t>(face)).dot(p - at));
}

// Ties between faces that share an edge; equal ones go to the lower index, whatever the order of the visit.
bool beats(const Query& q, unsigned face, const Vec3& at) {
  const auto f = static_cast<std::int32_t>(face);
  const double ours = facing(*q.mesh, f, q.p, at), best = facing(*q.mesh, q.face, q.p, q.point);
  return std::abs(ours - best) > tie_m ? ours > best : f < q.face;
}

bool look_at(RTCPointQueryFunctionArguments* args) {
  Query& q = *static_cast<Query*>(args->userPtr);
  const Mesh& mesh = *q.mesh;
  const unsigned f = args->primID;
  const Vec3 a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
  if (q.seen_along && (b - a).cross(c - a).dot(*q.seen_along) <= 0) return false;
  const Vec3 at = closest_on_triangle(q.p, a, b, c);
  const double d = (at - q.p).norm();
  if (!(d <= q.best + tie_m) || (d >= q.best - tie_m && q.face >= 0 && !beats(q, f, at))) return false;
  q.best = d;
  q.point = at;
  q.face = static_cast<std::int32_t>(f);
  // Rounded up, with room for the floats of the tree.
  args->query->radius = std::min(args->query->radius, static_cast<float>(d * (1 + 1e-6) + 1e-4));
  return true;
}

}  // namespace

std::optional<Closest> Caster::closest(const Vec3& p, double radius_m, const std::optional<Vec3>& seen_along) const {
  const Impl& m = *impl_;
  Query q{m.mesh, p, seen_along ? &*seen_along : nullptr, radius_m, p, -1};
  RTCPointQuery query;
  const Vec3 o = p - m.middle;
  query.x = static_cast<float>(o.x());
  query.y = static_cast<float>(o.y());
  query.z = static_cast<float>(o.z());
  query.time = 0;
  query.radius = static_cast<float>(radius_m + 1e-4);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(m.scene, &query, &context, look_at, &q);
  if (q.face < 0) return std::nullopt;
  return Closest{q.point, q.face, q.best};
}

}  // namespace adit
