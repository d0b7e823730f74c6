// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// PLY files as tables: elements (vertex, face) of columns. Meshes and point clouds stand on it.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace adit {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// One property of an element. All types fit in double without loss.
struct PlyColumn {
  std::string name;
  PlyType type = PlyType::float64;
  bool list = false;
  std::vector<double> value;          // (rows), or of a list all items, one row after the other
  std::vector<std::uint32_t> offset;  // of a list: row i is value[offset[i] .. offset[i + 1]); else empty
};

struct PlyElement {
  std::string name;
  size_t rows = 0;
  std::vector<PlyColumn> columns;

  const PlyColumn* find(const std::string& column) const;
};

struct Ply {
  std::vector<PlyElement> elements;

  const PlyElement* find(const std::string& element) const;
};

/// What a file holds, row by row, for what is too large to be held twice.
struct PlySink {
  std::function<void(const PlyElement&)> element;  // its rows come next; columns have names and types
  /// One row: (columns) the value, or the items of a list.
  std::function<void(const PlyElement&, const std::vector<std::vector<double>>& row)> row;
};
void read_ply(const std::string& file, const PlySink& sink);

/// Reads ascii, little-endian and big-endian files. Truncated or foreign files: Error with file and place.
Ply read_ply(const std::string& file);
/// Binary, little endian; lists with a uint8 count.
void write_ply(const std::string& file, const Ply& ply);

}  // namespace adit
