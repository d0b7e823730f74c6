// SPDX-License-Identifier: BSD-3-Clause
#include "rays/caster.h"

#include "base/error.h"
#include "rays/nearest_face.h"

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

// 16 rays on their way through Embree.
struct Packet {
  alignas(64) RTCRayHit16 rays;
  alignas(64) int valid[16];

  Packet() {
    for (size_t k = 0; k < 16; ++k) {
      rays.ray.tnear[k] = rays.ray.time[k] = 0;
      rays.ray.mask[k] = ~0U;
      rays.ray.id[k] = rays.ray.flags[k] = 0;
    }
  }

  bool met(size_t k) const { return rays.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID; }

  // The first n lanes; the others stay empty.
  void arm(size_t n, float far_m) {
    for (size_t k = 0; k < 16; ++k) {
      valid[k] = k < n ? -1 : 0;
      rays.ray.tfar[k] = far_m;
      rays.hit.geomID[k] = rays.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
  }
};

// The plane of a face, its normal as long as the cross product of two sides.
struct Plane {
  double n[3], a[3], length;
};

// The planes that 16 rays meet, lane by lane.
struct Lanes {
  alignas(64) double n[3][16], a[3][16], length[16];

  void set(size_t k, const Plane& p) {
    for (int i = 0; i < 3; ++i) n[i][k] = p.n[i], a[i][k] = p.a[i];
    length[k] = p.length;
  }
};

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

  void intersect(Packet& p) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(p.valid, scene, &context, &p.rays);
  }

  Plane plane_of(unsigned face) const {
    const auto& corner = mesh->face[face];
    const Vec3 &a = mesh->vertex[corner[0]], &b = mesh->vertex[corner[1]], &c = mesh->vertex[corner[2]];
    const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    return {{nx, ny, nz}, {a[0], a[1], a[2]}, std::sqrt(nx * nx + ny * ny + nz * nz)};
  }

  // The planes of the faces that the rays of a packet met. Neighbours mostly meet one face.
  void planes_of(const Packet& p, Lanes& l) const {
    unsigned last = 0;
    Plane plane = {};
    for (size_t k = 0; k < 16; ++k) {
      const unsigned face = p.met(k) ? p.rays.hit.primID[k] : last;
      if (k == 0 || face != last) plane = plane_of(face);
      last = face;
      l.set(k, plane);
    }
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
  Packet p;
  for (size_t begin = 0; begin < rays.size(); begin += 16) {
    const size_t n = std::min<size_t>(16, rays.size() - begin);
    p.arm(n, 0);
    for (size_t k = 0; k < 16; ++k) {
      const Ray& ray = rays[begin + std::min(k, n - 1)];
      const Vec3 o = ray.origin - impl_->middle;
      p.rays.ray.org_x[k] = static_cast<float>(o.x());
      p.rays.ray.org_y[k] = static_cast<float>(o.y());
      p.rays.ray.org_z[k] = static_cast<float>(o.z());
      p.rays.ray.dir_x[k] = static_cast<float>(ray.direction.x());
      p.rays.ray.dir_y[k] = static_cast<float>(ray.direction.y());
      p.rays.ray.dir_z[k] = static_cast<float>(ray.direction.z());
      p.rays.ray.tfar[k] = static_cast<float>(ray.far_m);
    }
    impl_->intersect(p);
    for (size_t k = 0; k < n; ++k)
      hits[begin + k] =
          p.met(k) ? impl_->refined(rays[begin + k], p.rays.hit.primID[k], p.rays.ray.tfar[k]) : Hit{infinity, -1};
  }
}

namespace {

// Sixteen numbers from and into columns, mostly whole: a copy of a known length is a few registers, others are calls.
template <class T>
void take(T* lanes, const std::vector<T>& column, size_t at, size_t n) {
  if (n == 16) return void(std::copy_n(column.data() + at, 16, lanes));
  std::copy_n(column.data() + at, n, lanes);
  std::fill(lanes + n, lanes + 16, lanes[n - 1]);
}
template <class T>
void put(const T* lanes, size_t n, std::vector<T>& column, size_t at) {
  if (n == 16) return void(std::copy_n(lanes, 16, column.data() + at));
  std::copy_n(lanes, n, column.data() + at);
}

struct Sixteen {
  alignas(64) double x[16], y[16], z[16], dx[16], dy[16], dz[16];

  Sixteen(const RayColumns<double>& rays, size_t at, size_t n) {
    take(x, rays.x, at, n), take(y, rays.y, at, n), take(z, rays.z, at, n);
    take(dx, rays.dx, at, n), take(dy, rays.dy, at, n), take(dz, rays.dz, at, n);
  }
};

// The range to the plane in doubles, or that of Embree where the plane is seen edge-on and says nothing; as in refined().
// Plain loops that the compiler turns into vectors.
void refine(const Packet& p, const Sixteen& r, const Lanes& l, double* range_m, double* cosine, std::int32_t* face) {
  for (size_t k = 0; k < 16; ++k) {
    const double slope = l.n[0][k] * r.dx[k] + l.n[1][k] * r.dy[k] + l.n[2][k] * r.dz[k];
    const double way =
        l.n[0][k] * (l.a[0][k] - r.x[k]) + l.n[1][k] * (l.a[1][k] - r.y[k]) + l.n[2][k] * (l.a[2][k] - r.z[k]);
    const double exact = way / slope, rough = static_cast<double>(p.rays.ray.tfar[k]);
    const double sound = std::abs(exact - rough) < 1e-3 * (1 + rough) ? exact : rough;
    const bool met = p.met(k);
    range_m[k] = met ? sound : infinity;
    cosine[k] = met ? slope / l.length[k] : 0;
    face[k] = met ? static_cast<std::int32_t>(p.rays.hit.primID[k]) : -1;
  }
}

}  // namespace

void Caster::nearest(const RayColumns<double>& rays, size_t begin, size_t end, size_t together,
                     HitColumns<double>& hits) const {
  ADIT_CHECK(end <= rays.size() && end <= hits.face.size() && together > 0 && together <= 16);
  Packet p;
  Lanes l;
  const Vec3& m = impl_->middle;
  for (size_t at = begin; at < end; at += together) {
    const size_t n = std::min(together, end - at);
    const Sixteen r(rays, at, n);
    p.arm(n, 1e4F);
    for (size_t k = 0; k < 16; ++k) {
      p.rays.ray.org_x[k] = static_cast<float>(r.x[k] - m.x());
      p.rays.ray.org_y[k] = static_cast<float>(r.y[k] - m.y());
      p.rays.ray.org_z[k] = static_cast<float>(r.z[k] - m.z());
      p.rays.ray.dir_x[k] = static_cast<float>(r.dx[k]);
      p.rays.ray.dir_y[k] = static_cast<float>(r.dy[k]);
      p.rays.ray.dir_z[k] = static_cast<float>(r.dz[k]);
    }
    impl_->intersect(p);
    impl_->planes_of(p, l);
    alignas(64) double range_m[16], cosine[16];
    alignas(64) std::int32_t face[16];
    refine(p, r, l, range_m, cosine, face);
    put(range_m, n, hits.range_m, at), put(cosine, n, hits.cosine, at), put(face, n, hits.face, at);
  }
}

void Caster::glance(const RayColumns<float>& rays, HitColumns<float>& hits) const {
  hits.resize(rays.size());
  Packet p;
  for (size_t begin = 0; begin < rays.size(); begin += 16) {
    const size_t n = std::min<size_t>(16, rays.size() - begin);
    p.arm(n, 1e4F);
    take(p.rays.ray.org_x, rays.x, begin, n), take(p.rays.ray.org_y, rays.y, begin, n),
        take(p.rays.ray.org_z, rays.z, begin, n);
    take(p.rays.ray.dir_x, rays.dx, begin, n), take(p.rays.ray.dir_y, rays.dy, begin, n),
        take(p.rays.ray.dir_z, rays.dz, begin, n);
    impl_->intersect(p);
    alignas(64) float range_m[16], cosine[16];
    alignas(64) std::int32_t face[16];
    for (size_t k = 0; k < 16; ++k) {
      // Embree's normal is not of unit length; like ours it looks out of a face that is counter-clockwise.
      const float x = p.rays.hit.Ng_x[k], y = p.rays.hit.Ng_y[k], z = p.rays.hit.Ng_z[k];
      const float along = x * p.rays.ray.dir_x[k] + y * p.rays.ray.dir_y[k] + z * p.rays.ray.dir_z[k];
      const float whole = along / std::sqrt(x * x + y * y + z * z);
      const bool met = p.met(k);
      range_m[k] = met ? p.rays.ray.tfar[k] : std::numeric_limits<float>::infinity();
      cosine[k] = met ? whole : 0.0F;
      face[k] = met ? static_cast<std::int32_t>(p.rays.hit.primID[k]) : -1;
    }
    put(range_m, n, hits.range_m, begin), put(cosine, n, hits.cosine, begin), put(face, n, hits.face, begin);
  }
}

const Vec3& Caster::middle() const {
  return impl_->middle;
}

namespace {

bool look_at(RTCPointQueryFunctionArguments* args) {
  NearestFace& nearest = *static_cast<NearestFace*>(args->userPtr);
  if (!nearest.offer(args->primID)) return false;
  // Rounded up, with room for the floats of the tree.
  args->query->radius = std::min(args->query->radius, static_cast<float>(nearest.best_m() * (1 + 1e-6) + 1e-4));
  return true;
}

}  // namespace

std::optional<Closest> Caster::closest(const Vec3& p, double radius_m, const std::optional<Vec3>& seen_along) const {
  const Impl& m = *impl_;
  NearestFace nearest(*m.mesh, p, radius_m, seen_along);
  RTCPointQuery query;
  const Vec3 o = p - m.middle;
  query.x = static_cast<float>(o.x());
  query.y = static_cast<float>(o.y());
  query.z = static_cast<float>(o.z());
  query.time = 0;
  query.radius = static_cast<float>(radius_m + 1e-4);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(m.scene, &query, &context, look_at, &nearest);
  return nearest.found();
}

}  // namespace adit
