// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace adit {

/// A file that grows beside the one that it will become a part of, and is removed in the end.
class Spool {
 public:
  explicit Spool(const std::string& file, const std::string& what);
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  template <class T>
  void put(T v) {
    block_.append(reinterpret_cast<const char*>(&v), sizeof v);
    if (block_.size() > (1u << 20)) flush();
  }
  std::uint64_t bytes() const { return written_ + block_.size(); }
  void copy_to(std::ostream& out);

 private:
  void flush();
  std::string file_;
  std::ofstream out_;
  std::string block_;
  std::uint64_t written_ = 0;
};

/// Writes a mesh as binary little-endian PLY, part by part: what write_mesh writes of the whole.
class PlyWriter {
 public:
  explicit PlyWriter(std::string file);
  /// A part (MinePart); all have the same of the optional columns.
  void add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id);
  void close();

 private:
  std::string file_, columns_;
  Spool vertices_, faces_;
  std::uint32_t vertex_count_ = 0, face_count_ = 0;
};

/// The same as binary glTF (2.0, sections 3.6 and 4.4 of the specification).
class GlbWriter {
 public:
  explicit GlbWriter(std::string file);
  void add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id);
  void close();

 private:
  std::string file_;
  Spool positions_;
  std::map<Label, std::unique_ptr<Spool>> indices_;
  std::uint32_t vertex_count_ = 0;
  std::array<float, 3> low_{}, high_{};
};

/// The colour in which programs of others show a label: red, green, blue, 0 to 1.
std::array<double, 3> label_colour(Label label);

/// Ids of the vertices of a mesh that is the only part of itself.
std::vector<std::uint32_t> all_vertices(const Mesh& mesh);

}  // namespace adit
