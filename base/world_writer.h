// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh_writer.h"
#include "base/world.h"

#include <map>
#include <string>
#include <vector>

namespace adit {

/// Writes DIR/mine.ply, mine.glb and truth.json of a mine that comes part by part (MinePart).
class WorldWriter {
 public:
  explicit WorldWriter(std::string dir);
  void add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id);
  /// @param truth  the mine, its mesh or not
  void close(const World& truth);

 private:
  struct Sums {
    double area_m2 = 0, reflected = 0, wet = 0;
  };
  std::string dir_;
  PlyWriter ply_;
  GlbWriter glb_;
  std::map<Label, Sums> labels_;
  std::map<Material, Sums> rocks_;
  bool reflects_ = false;
};

}  // namespace adit
