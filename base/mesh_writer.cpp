// SPDX-License-Identifier: BSD-3-Clause
#include "base/mesh_writer.h"

#include "base/error.h"
#include "base/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <numeric>

namespace adit {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void cannot_write(const std::string& file) {
  throw Error(file + ": cannot write: " + std::strerror(errno), Fault::file);
}

template <class T>
std::string column(const std::vector<T>& values, const std::string& line) {
  return values.empty() ? "" : "property " + line + "\n";
}

}  // namespace

Spool::Spool(const std::string& file, const std::string& what) {
  const fs::path path(file);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(folder.string() + ": cannot make this folder: " + failed.message(), Fault::file);
  file_ = (folder / ("." + path.filename().string() + "." + what + "." + std::to_string(::getpid()))).string();
  out_.open(file_, std::ios::binary | std::ios::trunc);
  if (!out_) cannot_write(file_);
}

Spool::~Spool() {
  out_.close();
  std::error_code ignored;
  fs::remove(file_, ignored);
}

void Spool::flush() {
  out_.write(block_.data(), static_cast<std::streamsize>(block_.size()));
  out_.flush();
  if (!out_) cannot_write(file_);
  written_ += block_.size();
  block_.clear();
}

void Spool::copy_to(std::ostream& out) {
  flush();
  if (written_ == 0) return;
  std::ifstream in(file_, std::ios::binary);
  out << in.rdbuf();
}

PlyWriter::PlyWriter(std::string file) : file_(std::move(file)), vertices_(file_, "vertices"), faces_(file_, "faces") {}

void PlyWriter::add(const Mesh& m, const std::vector<std::uint32_t>& vertex_id) {
  for (size_t v = 0; v < m.vertex.size(); ++v) {
    if (vertex_id[v] != vertex_count_) continue;
    ++vertex_count_;
    for (int axis = 0; axis < 3; ++axis) vertices_.put(m.vertex[v][axis]);
  }
  const std::string columns = column(m.label, "int label") + column(m.part, "int part") +
                              column(m.reflectivity, "float reflectivity") + column(m.passage, "int passage") +
                              column(m.material, "uchar material") + column(m.wetness, "float wetness");
  if (face_count_ == 0) columns_ = columns;
  ADIT_CHECK(columns == columns_ || m.face.empty());
  for (size_t f = 0; f < m.face.size(); ++f) {
    faces_.put(std::uint8_t{3});
    for (std::uint32_t v : m.face[f]) faces_.put(vertex_id[v]);
    if (!m.label.empty()) faces_.put(static_cast<std::int32_t>(m.label[f]));
    if (!m.part.empty()) faces_.put(static_cast<std::int32_t>(m.part[f]));
    if (!m.reflectivity.empty()) faces_.put(m.reflectivity[f]);
    if (!m.passage.empty()) faces_.put(static_cast<std::int32_t>(m.passage[f]));
    if (!m.material.empty()) faces_.put(static_cast<std::uint8_t>(m.material[f]));
    if (!m.wetness.empty()) faces_.put(m.wetness[f]);
  }
  face_count_ += static_cast<std::uint32_t>(m.face.size());
}

void PlyWriter::close() {
  write_whole(file_, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\ncomment adit\nelement vertex " << vertex_count_
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << face_count_
        << "\nproperty list uchar int vertex_indices\n"
        << columns_ << "end_header\n";
    vertices_.copy_to(out);
    faces_.copy_to(out);
    out.close();
    if (!out) cannot_write(file_);
  });
}

std::vector<std::uint32_t> all_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> id(mesh.vertex.size());
  std::iota(id.begin(), id.end(), 0u);
  return id;
}

}  // namespace adit
