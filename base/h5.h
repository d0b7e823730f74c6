// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace adit {

using Shape = std::vector<std::uint64_t>;  // rows first

/// How arrays are laid down: deflated, or as they are, at a fifth of the time.
enum class Packing { small, quick };

/// Writes an HDF5 file: groups, attributes, arrays (little endian, chunked, shuffled, deflated, with checksums, no
/// object times: the same calls give the same bytes on any number of threads). Paths are absolute, "/scans/front". Array types: double, float,
/// int32, uint8. Safe from several threads, one at a time. Errors are Fault::file and name the file as `called`.
class H5Writer {
 public:
  H5Writer(const std::string& file, const std::string& called, Packing packing = Packing::small);
  ~H5Writer();

  void group(const std::string& path);
  void number(const std::string& path, const std::string& key, double value);
  void integer(const std::string& path, const std::string& key, std::int64_t value);
  void text(const std::string& path, const std::string& key, const std::string& value);
  template <class T>
  void array(const std::string& path, std::span<const T> values, const Shape& shape);
  /// The same piece by piece: `next` is asked for whole rows until the array is full, so that it is never in memory as a
  /// whole. Error if a piece is empty or too long.
  template <class T>
  void array(const std::string& path, const Shape& shape, const std::function<std::vector<T>()>& next);
  /// Everything is on its way to the disk; without this call the file is not whole.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads one. A missing, foreign, truncated or damaged file, or one that lacks what is asked for, is an Error.
class H5Reader {
 public:
  explicit H5Reader(const std::string& file);
  ~H5Reader();

  const std::string& file() const;
  bool has_attribute(const std::string& path, const std::string& key) const;
  double number(const std::string& path, const std::string& key) const;
  std::int64_t integer(const std::string& path, const std::string& key) const;
  std::string text(const std::string& path, const std::string& key) const;
  /// Names in a group, sorted.
  std::vector<std::string> names(const std::string& path) const;
  Shape shape(const std::string& path) const;
  /// Values of an array that must have that shape, row by row.
  template <class T>
  std::vector<T> array(const std::string& path, const Shape& shape) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
