// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace adit {

/// The path `name` in a folder of this process alone, which is made at the first call and removed at the end: tests that
/// run side by side never meet in a file.
inline std::string scratch(const std::string& name) {
  struct Folder {
    std::filesystem::path at = std::filesystem::temp_directory_path() / ("adit_" + std::to_string(::getpid()));
    Folder() {
      std::filesystem::remove_all(at);
      std::filesystem::create_directories(at);
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(at, ignored);
    }
  };
  static const Folder folder;
  return (folder.at / name).string();
}

}  // namespace adit
