// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/files.h"

#include <filesystem>
#include <map>
#include <string>

namespace adit {

/// Every file below a folder with its bytes, but for timing.json, which alone may differ between equal runs.
inline std::map<std::string, std::string> bytes_of(const std::string& dir) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir))
    if (entry.is_regular_file() && entry.path().filename() != "timing.json")
      all[fs::relative(entry.path(), dir).string()] = read_text(entry.path().string());
  return all;
}

}  // namespace adit
