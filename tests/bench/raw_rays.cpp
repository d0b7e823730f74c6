// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/raw_rays.h"

#include "base/error.h"
#include "tests/bench/bench.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace adit::bench {
namespace {

RTCScene scene_of(RTCDevice device, const Mesh& mesh) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertex.size()));
  auto* faces = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                               3 * sizeof(unsigned), mesh.face.size()));
  for (size_t i = 0; i < mesh.vertex.size(); ++i)
    for (int k = 0; k < 3; ++k) vertices[3 * i + k] = static_cast<float>(mesh.vertex[i][k]);
  for (size_t f = 0; f < mesh.face.size(); ++f) std::copy(mesh.face[f].begin(), mesh.face[f].end(), faces + 3 * f);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

// Single precision from the start, as a program would keep them that does nothing else.
struct Bare {
  float p[3], d[3];
};

double cast_all(RTCScene scene, const std::vector<Bare>& rays) {
  alignas(64) RTCRayHit16 packet;
  alignas(64) int valid[16];
  double sum = 0;
  for (size_t begin = 0; begin + 16 <= rays.size(); begin += 16) {
    for (size_t k = 0; k < 16; ++k) {
      const Bare& ray = rays[begin + k];
      valid[k] = -1;
      packet.ray.org_x[k] = ray.p[0];
      packet.ray.org_y[k] = ray.p[1];
      packet.ray.org_z[k] = ray.p[2];
      packet.ray.dir_x[k] = ray.d[0];
      packet.ray.dir_y[k] = ray.d[1];
      packet.ray.dir_z[k] = ray.d[2];
      packet.ray.tnear[k] = 0;
      packet.ray.tfar[k] = 1e4F;
      packet.ray.time[k] = 0;
      packet.ray.mask[k] = ~0U;
      packet.ray.id[k] = 0;
      packet.ray.flags[k] = 0;
      packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, &packet);
    for (size_t k = 0; k < 16; ++k) sum += static_cast<double>(packet.ray.tfar[k]);
  }
  return sum;
}

}  // namespace

double raw_seconds(const Mesh& mesh, std::span<const Ray> rays, int repeats) {
  RTCDevice device = rtcNewDevice("isa=avx2,threads=0,set_affinity=0");
  if (!device) throw Error("Embree cannot start");
  RTCScene scene = scene_of(device, mesh);
  std::vector<Bare> bare(rays.size());
  for (size_t i = 0; i < rays.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      bare[i].p[k] = static_cast<float>(rays[i].origin[k]);
      bare[i].d[k] = static_cast<float>(rays[i].direction[k]);
    }
  double sum = 0;
  const double seconds = best_seconds(repeats, [&] { sum = cast_all(scene, bare); });
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  if (!(sum > 0)) throw Error("the bare rays met nothing");
  return seconds;
}

}  // namespace adit::bench
