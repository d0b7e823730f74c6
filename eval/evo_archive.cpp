// SPDX-License-Identifier: BSD-3-Clause
// PKWARE, APPNOTE.TXT 6.3 (zip); numpy.lib.format, version 1.0 (npy); github.com/MichaelGrupp/evo, evo/tools/file_interface.py.
#include "eval/evo_archive.h"

#include "base/error.h"
#include "base/files.h"
#include "eval/metric_list.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace adit {
namespace {

using nlohmann::ordered_json;

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

// Whole numbers as the format keeps them: little endian.
void put(std::string& text, std::uint32_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) text.push_back(static_cast<char>(value >> 8 * k & 0xff));
}

class Zip {
 public:
  void add(const std::string& name, const std::string& bytes) {
    ADIT_CHECK(bytes.size() < 0xffffffffu && files_.size() + bytes.size() < 0xffffffffu);
    std::string facts;  // what the entry and the directory both say
    put(facts, 20, 2);  // version that can read it
    put(facts, 0, 2);
    put(facts, 0, 2);  // stored
    put(facts, 0, 2);  // no time of day: 1980-01-01
    put(facts, 0x21, 2);
    put(facts, crc32(bytes), 4);
    put(facts, static_cast<std::uint32_t>(bytes.size()), 4);
    put(facts, static_cast<std::uint32_t>(bytes.size()), 4);
    put(facts, static_cast<std::uint32_t>(name.size()), 2);
    put(facts, 0, 2);
    put(directory_, 0x02014b50, 4);
    put(directory_, 20, 2);
    directory_ += facts;
    put(directory_, 0, 2);
    put(directory_, 0, 2);
    put(directory_, 0, 2);
    put(directory_, 0, 4);
    put(directory_, static_cast<std::uint32_t>(files_.size()), 4);
    directory_ += name;
    put(files_, 0x04034b50, 4);
    files_ += facts + name + bytes;
    ++count_;
  }
  std::string whole() const {
    std::string end;
    put(end, 0x06054b50, 4);
    put(end, 0, 4);
    put(end, count_, 2);
    put(end, count_, 2);
    put(end, static_cast<std::uint32_t>(directory_.size()), 4);
    put(end, static_cast<std::uint32_t>(files_.size()), 4);
    put(end, 0, 2);
    return files_ + directory_ + end;
  }

 private:
  std::string files_, directory_;
  std::uint32_t count_ = 0;
};

std::string npy(const std::vector<double>& values) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(values.size()) + ",), }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string out = std::string("\x93NUMPY\x01", 7) + '\0';
  put(out, static_cast<std::uint32_t>(header.size()), 2);
  out += header;
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return out;
}

ordered_json stats_of(std::vector<double> error) {
  const auto n = static_cast<double>(error.size());
  double sum = 0, squares = 0, spread = 0;
  for (const double e : error) sum += e, squares += e * e;
  for (const double e : error) spread += (e - sum / n) * (e - sum / n);
  return {{"rmse", std::sqrt(squares / n)},
          {"mean", sum / n},
          {"median", quantile(error, 0.5)},
          {"std", std::sqrt(spread / n)},
          {"min", *std::min_element(error.begin(), error.end())},
          {"max", *std::max_element(error.begin(), error.end())},
          {"sse", squares}};
}

}  // namespace

void write_evo_archive(const std::string& file, const Score& score) {
  if (score.poses.empty()) throw Error(file + ": the score has no path whose errors it could hold");
  std::vector<double> error, stamp, since, along;
  for (const PoseError& e : score.poses) {
    error.push_back(e.p_error_W.norm());
    stamp.push_back(e.stamp_s);
    since.push_back(e.stamp_s - score.poses.front().stamp_s);
    along.push_back(e.along_m - score.poses.front().along_m);
  }
  std::string method = "estimate";
  for (const auto& [key, value] : score.meta)
    if (key == "method" && !value.empty()) method = value;
  const ordered_json info{{"title", "APE w.r.t. translation part (m)\n(with SE(3) Umeyama alignment)"},
                          {"label", "APE (m)"},
                          {"ref_name", "truth"},
                          {"est_name", method}};
  Zip zip;
  zip.add("info.json", info.dump());
  zip.add("stats.json", stats_of(error).dump());
  zip.add("error_array.npy", npy(error));
  zip.add("seconds_from_start.npy", npy(since));
  zip.add("timestamps.npy", npy(stamp));
  zip.add("distances_from_start.npy", npy(along));
  write_text(file, zip.whole());
}

}  // namespace adit
