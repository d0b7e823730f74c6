// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/ogr.h"

#include "base/error.h"
#include "base/files.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr int not_found = 127;

// Runs ogr2ogr with what it complains of in a file; its exit code, not_found where there is none.
int ogr2ogr(const std::string& to, const std::string& from, const std::string& complaints) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (!std::freopen(complaints.c_str(), "w", stderr)) ::_exit(1);
    ::execlp("ogr2ogr", "ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=6", "-lco", "RFC7946=NO", to.c_str(),
             from.c_str(), static_cast<char*>(nullptr));
    ::_exit(not_found);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 1;
  return WEXITSTATUS(status);
}

}  // namespace

std::string as_geojson(const std::string& file) {
  if (!fs::exists(file)) throw Error(file + ": no such file");
  const fs::path stem = fs::temp_directory_path() / ("adit-plan-" + std::to_string(::getpid()));
  const std::string to = stem.string() + ".geojson", complaints = stem.string() + ".txt";
  const int code = ogr2ogr(to, file, complaints);
  std::string text, why;
  if (code == 0 && fs::exists(to)) text = read_text(to);
  if (fs::exists(complaints)) why = read_text(complaints);
  std::error_code ignored;
  fs::remove(to, ignored);
  fs::remove(complaints, ignored);
  if (code == not_found)
    throw Error(file +
                ": to read this format adit needs ogr2ogr (Debian: gdal-bin), which is not installed; GeoJSON "
                "(.geojson) and centre lines (.json) it reads itself");
  if (text.empty()) throw Error(file + ": ogr2ogr cannot read it as polygons: " + why.substr(0, why.find('\n')));
  return text;
}

}  // namespace adit
