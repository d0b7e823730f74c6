// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "base/world.h"

namespace adit {

/// A closed box as a void: normals out of it. Floor and roof labelled so, the four sides rib; two triangles a side.
/// part: 0 for floor and roof, -1 for the ribs. Reflectivity 0.45.
Mesh box_mesh(const Vec3& low, const Vec3& high);

/// The same with square-ish faces of about edge_m.
Mesh fine_box_mesh(const Vec3& low, const Vec3& high, double edge_m);

/// A sphere about `centre`, an icosahedron subdivided `rounds` times, normals outward, labelled rib.
Mesh sphere_mesh(const Vec3& centre, double radius_m, int rounds);

/// A straight tunnel along x, from x = 0 to length_m, centred on y = 0, floor at z = 0; one passage, two dead ends.
World tunnel_world(double length_m, double width_m, double height_m, double edge_m = 1e9);

/// A square ring of four passages about one square pillar: outer edge from -outer/2 to outer/2 in x and y, floor z = 0.
/// Junctions in the corners' middles, counter-clockwise from the lower left; passage k joins junctions k and k + 1.
World ring_world(double outer_m, double width_m, double height_m, double edge_m);

}  // namespace adit
