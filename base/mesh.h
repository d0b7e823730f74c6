// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace adit {

/// What a face of a mine is. The ids stand in mesh files and in truth.json.
/// From `post` to `block`, `sludge` left out, they are things in a mine: closed bodies, whose faces look into them (they
/// bound the void too).
enum class Label : std::uint8_t {
  none = 0,
  floor = 1,
  roof = 2,
  rib = 3,
  cap = 4,
  vehicle = 5,
  pusher = 6,
  rubble = 7,  // what fell from the roof, where it lies as ground
  talus = 8,   // what spalled from the ribs, at their foot
  post = 9,
  crossbar = 10,
  crib = 11,
  bolt = 12,
  rail = 13,
  tie = 14,
  belt = 15,
  stopping = 16,
  door = 17,
  pipe = 18,
  cable = 19,
  water = 20,
  sludge = 21,  // floor under mud of iron
  car = 22,
  beam = 23,    // fallen
  block = 24,   // loose rock
  cavity = 25,  // what a major fall left of the roof
  scar = 26,    // what a skin fall left of it
};
/// Whether wheels stand on it.
bool is_ground(Label label);
/// Whether it is overhead: roof, cavity or scar.
bool is_roof(Label label);
/// Whether it is a closed body in the void, not rock.
bool is_object(Label label);
/// Whether its faces' part is the number of an object: of a body, or of what fell (rubble, cavity, scar).
bool is_numbered(Label label);
const std::map<std::string, int>& label_ids();
std::string label_name(Label label);

/// What a face's rock is, under its dust and water. The ids stand in mesh files and in truth.json.
enum class Material : std::uint8_t {
  none = 0,
  coal = 1,
  shale = 2,
  fireclay = 3,
  rock_dust = 4,
  block = 5,
  timber = 6,
  steel = 7,
  water = 8,
  mud = 9
};
const std::map<std::string, int>& material_ids();

/// An indexed triangle mesh in metres. Faces are counter-clockwise seen from outside of the enclosed volume: the
/// enclosed volume of a mine is its void, so normals point into the rock.
struct Mesh {
  std::vector<Vec3> vertex;                        // (n x 3)
  std::vector<std::array<std::uint32_t, 3>> face;  // (m x 3)
  std::vector<Label> label;                        // (m) or empty
  std::vector<int> part;            // (m) or empty: id of the passage (floor, roof, talus, sludge), pillar (rib)
                                    // or object (is_numbered); -1 none
  std::vector<float> reflectivity;  // (m) or empty: diffuse, at 905 nm, 0..1
  std::vector<int> passage;         // (m) or empty: id of the passage that a face bounds
  std::vector<Material> material;   // (m) or empty
  std::vector<float> wetness;       // (m) or empty: 0 dry .. 1 wet through

  Vec3 corner(size_t f, int k) const { return vertex[face[f][k]]; }
  /// Unit normal, out of the enclosed volume.
  Vec3 normal(size_t f) const;
  double area(size_t f) const;
};

/// Enclosed volume by the divergence theorem, m3, > 0 for an outward mesh; meaningless for an open one.
double enclosed_volume(const Mesh& mesh);

/// Number of edges that do not join exactly two faces in opposite directions; 0 for a closed, oriented mesh.
size_t open_edges(const Mesh& mesh);

/// Binary little-endian PLY: double x y z; faces vertex_indices, and as present int label, int part, float
/// reflectivity, int passage, uchar material, float wetness.
void write_mesh(const std::string& file, const Mesh& mesh);
/// Any PLY mesh, ascii or binary, float or double, triangles (polygons are fanned); what write_mesh writes of
/// each face if present. A name that ends in .obj: Wavefront OBJ, vertices and faces alone.
Mesh read_mesh(const std::string& file);
/// Binary glTF, one primitive and material per label, y up as the format demands.
void write_glb(const std::string& file, const Mesh& mesh);

}  // namespace adit
