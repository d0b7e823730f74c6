// SPDX-License-Identifier: BSD-3-Clause
#include "eval/yardstick.h"

#include "base/error.h"

#include <numbers>

namespace adit {
namespace {

// The cubes of the patches stand on it, so that they move with the mine.
Pose start_of(const Truth& truth) {
  return truth.drive.path.empty() ? Pose::Identity() : truth.drive.path.X_WB.front();
}

}  // namespace

void check_comparable(const World& world, const Truth& truth, const Rig& nominal) {
  if (const std::string hash = world_hash(world); truth.world != hash)
    throw Error("the truth belongs to another world: its hash is " + truth.world + ", the world's is " + hash,
                Fault::not_comparable);
  if (nominal.mounts.size() != truth.rig.mounts.size())
    throw Error("the mapper's rig has " + std::to_string(nominal.mounts.size()) + " lasers, the truth's " +
                    std::to_string(truth.rig.mounts.size()),
                Fault::not_comparable);
}

Yardstick::Yardstick(const World& of, const Truth& true_drive, const Rig& told, const ScoreSettings& how,
                     const Progress& progress)
    : world((check_comparable(of, true_drive, told), of)),
      truth(true_drive),
      nominal(told),
      settings(how),
      surface(world.mesh),
      passages(world),
      scans(truth, world.mesh),
      patches(world.mesh, settings.patch_m, start_of(truth)),
      observable(
          observable_surface(patches, scans, world.mesh.face.size(), settings.incidence_deg * std::numbers::pi / 180)) {
  surface.caster.emplace(world.mesh);
  if (const size_t open = open_edges(world.mesh); open > 0)
    no_domain = "the mine's mesh has " + std::to_string(open) + " open edges: it encloses no volume";
  else
    domain = volume_domain(world.mesh, patches, observable, scans, settings, progress);
}

}  // namespace adit
