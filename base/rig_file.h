// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/h5.h"
#include "base/rig.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace adit {

// What the files of logs and of truths have in common; docs/files.md has their layout.

/// The head of a file, and the check of one that is read.
void begin_file(H5Writer& out, const std::string& format);
void expect_format(const H5Reader& in, const std::string& format);

/// Error where a laser's name cannot be that of a group.
void check_names(const Rig& rig, const std::string& file);
void save_rig(H5Writer& out, const Rig& rig);
Rig load_rig(const H5Reader& in);

/// Poses as the upper three rows of their matrices.
std::vector<double> flat(std::span<const Pose> poses);
std::vector<Pose> poses_of(std::span<const double> numbers);

/// Whether a group has an array: some came to the layout later, and some only some recordings have.
bool has_array(const H5Reader& in, const std::string& group, const std::string& name);

/// Files that follow each other, of which arrays are joined row behind row. Few are open at a time.
class Pieces {
 public:
  explicit Pieces(std::vector<std::string> files);
  size_t size() const { return files_.size(); }
  const H5Reader& at(size_t i);
  /// Whether any of them has the array.
  bool has(const std::string& group, const std::string& name);
  /// The array of all pieces, written at the same path. Where a piece lacks it, its stamps must be none.
  template <class T>
  void join(H5Writer& out, const std::string& group, const std::string& name);

 private:
  std::vector<std::string> files_;
  std::vector<std::unique_ptr<H5Reader>> open_;
  size_t number_open_ = 0;
};

}  // namespace adit
