// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"

#include "base/error.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace adit {
namespace fs = std::filesystem;

void write_whole(const std::string& file, const std::function<void(const std::string&)>& write) {
  const fs::path path(file);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(folder.string() + ": cannot make this folder: " + failed.message(), Fault::file);
  const std::string temporary =
      (folder / ("." + path.filename().string() + "." + std::to_string(::getpid()) + path.extension().string()))
          .string();
  try {
    write(temporary);
  } catch (...) {
    fs::remove(temporary, failed);
    throw;
  }
  fs::rename(temporary, path, failed);
  if (failed) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error(file + ": cannot write: " + failed.message(), Fault::file);
  }
}

void write_text(const std::string& file, const std::string& text) {
  write_whole(file, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    if (!out) throw Error(file + ": cannot write: " + std::strerror(errno), Fault::file);
  });
}

std::string read_text(const std::string& file) {
  std::error_code failed;
  if (fs::is_directory(file, failed)) throw Error(file + ": is a folder, a file is needed");
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    const bool absent = !fs::exists(file, failed);
    throw Error(file + (absent ? ": no such file" : ": cannot read: " + std::string(std::strerror(errno))),
                absent ? Fault::bad_input : Fault::file);
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace adit
