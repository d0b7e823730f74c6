// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/cloud.h"
#include "base/world.h"

#include <string>

namespace adit {

/// Wavefront OBJ with its materials beside it (.mtl): a group for each label of the rock (floor, roof, rib, ...) and an
/// object for each thing (post_12, ...), in metres.
/// @param inward  faces turned to look into the void, as programs that draw one side alone need them
void write_obj(const std::string& file, const World& world, bool inward = false);

/// A world for Gazebo: FILE (.sdf) and beside it the model's folder, named as the file: model.config, model.sdf, meshes/.
/// GZ_SIM_RESOURCE_PATH (or GAZEBO_MODEL_PATH) must name the folder of FILE.
void write_sdf(const std::string& file, const World& world);

/// A list of instances in the manner of COCO: categories, and of each thing its category, box (middle, size, yaw),
/// volume and passage.
void write_instances(const std::string& file, const World& world);

/// Points spread evenly over all faces, so many a square metre, with label and part of each. The same for the same mine.
LabelledCloud surface_cloud(const World& world, double per_m2);
/// Binary PLY: float x y z, uchar label, int instance.
void write_labelled_ply(const std::string& file, const LabelledCloud& cloud);
/// One frame in the layout of SemanticKITTI: DIR/velodyne/000000.bin, DIR/labels/000000.label.
void write_kitti_frame(const std::string& dir, const LabelledCloud& cloud);

}  // namespace adit
