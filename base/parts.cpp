// SPDX-License-Identifier: BSD-3-Clause
#include "base/parts.h"

#include "base/error.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string part_name(const char* kind, size_t n) {
  char name[48];
  std::snprintf(name, sizeof name, "%s-%04zu.h5", kind, n);
  return name;
}

// The number in a name that save_part gives.
std::optional<size_t> number_of(const std::string& name, const std::string& kind) {
  const size_t from = kind.size() + 1, to = name.size() < 3 ? 0 : name.size() - 3;
  if (!name.starts_with(kind + "-") || !name.ends_with(".h5") || to <= from || to - from > 9) return std::nullopt;
  const std::string digits = name.substr(from, to - from);
  if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  return std::stoul(digits);
}

std::vector<size_t> numbers_in(const std::string& dir, const std::string& kind) {
  std::vector<size_t> numbers;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(dir, failed))
    if (const auto n = number_of(entry.path().filename().string(), kind)) numbers.push_back(*n);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// Rig of a part, all of which is read once: a checksum that fails is found here.
Rig rig_of_log(const std::string& file) {
  return load_log(file).rig;
}
Rig rig_of_truth(const std::string& file) {
  return load_truth(file).rig;
}

// Why a part cannot be used; empty if it can. The first sets the rig's name.
std::string fault_of(const std::string& file, Rig (*rig_of)(const std::string&), std::string& rig_name) {
  try {
    const Rig rig = rig_of(file);
    if (rig_name.empty()) rig_name = rig.name;
    return rig.name == rig_name ? ""
                                : file + ": is of the rig '" + rig.name + "', the first part of '" + rig_name + "'";
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace

std::string part_log(const std::string& dir, size_t n) {
  return dir + "/" + part_name("log", n);
}

std::string part_truth(const std::string& dir, size_t n) {
  return dir + "/" + part_name("truth", n);
}

void save_part(const std::string& dir, size_t n, const Log& log, const Truth& truth) {
  save_truth(part_truth(dir, n), truth, Packing::quick);
  save_log(part_log(dir, n), log, Packing::quick);
}

bool is_parts(const std::string& dir) {
  return fs::is_directory(dir) && !numbers_in(dir, "log").empty();
}

Parts find_parts(const std::string& dir) {
  Parts parts;
  std::string rig;
  size_t expected = 0;
  for (const size_t n : numbers_in(dir, "log")) {
    const std::string log = part_log(dir, n), truth = part_truth(dir, n);
    if (n != expected) parts.notes.push_back(dir + ": part " + std::to_string(expected) + " is missing");
    expected = n + 1;
    if (const std::string fault = fault_of(log, rig_of_log, rig); !fault.empty()) {
      parts.notes.push_back("left out: " + fault);
      continue;
    }
    parts.logs.push_back(log);
    const std::string fault = fault_of(truth, rig_of_truth, rig);
    if (fault.empty())
      parts.truths.push_back(truth);
    else
      parts.notes.push_back("no truth is written: " + fault);
  }
  if (parts.logs.empty())
    throw Error(dir + ": holds no part of a recording that can be read" +
                (parts.notes.empty() ? "" : "; " + parts.notes.front()));
  if (parts.truths.size() != parts.logs.size()) parts.truths.clear();
  return parts;
}

void remove_parts(const std::string& dir) {
  std::error_code failed;
  for (const char* kind : {"log", "truth"})
    for (const size_t n : numbers_in(dir, kind)) fs::remove(fs::path(dir) / part_name(kind, n), failed);
  fs::remove(dir, failed);  // which fails where something else is in it
}

}  // namespace adit
