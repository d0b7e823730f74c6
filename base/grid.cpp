// SPDX-License-Identifier: BSD-3-Clause
#include "base/grid.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

namespace adit {
namespace {

namespace fs = std::filesystem;

// What map_server writes and reads.
constexpr int free_grey = 255, occupied_grey = 0, unknown_grey = 205;
constexpr double occupied_above = 0.65, free_below = 0.196;
constexpr float sure = 2;  // log odds of a cell that comes from a picture

std::string yaml_beside(const std::string& pgm_file) {
  return fs::path(pgm_file).replace_extension(".yaml").string();
}

struct Picture {
  int width = 0, height = 0, most = 255;
  std::vector<std::uint8_t> grey;  // (height x width), top row first
};

// Portable graymap, binary (P5, one byte a pixel) or in words (P2).
Picture read_pgm(const std::string& file) {
  const std::string text = read_text(file);
  size_t at = 2;
  const auto number = [&]() {
    while (at < text.size() && (std::isspace(static_cast<unsigned char>(text[at])) || text[at] == '#'))
      if (text[at] == '#')
        while (at < text.size() && text[at] != '\n') ++at;
      else
        ++at;
    int value = 0, digits = 0;
    for (; at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) && digits < 9; ++at, ++digits)
      value = value * 10 + (text[at] - '0');
    if (digits == 0) throw Error(file + ": no valid picture; a PGM (P5 or P2) is needed");
    return value;
  };
  const bool words = text.compare(0, 2, "P2") == 0;
  if (!words && text.compare(0, 2, "P5") != 0) throw Error(file + ": no PGM (P5 or P2)");
  Picture p;
  p.width = number(), p.height = number(), p.most = number();
  ++at;  // one blank ends the header
  const size_t size = static_cast<size_t>(p.width) * static_cast<size_t>(p.height);
  if (size == 0 || p.most < 1 || p.most > 255) throw Error(file + ": empty picture, or more than one byte a pixel");
  if (words) {
    for (size_t k = 0; k < size; ++k) p.grey.push_back(static_cast<std::uint8_t>(std::min(number(), p.most)));
    return p;
  }
  if (text.size() < at + size)
    throw Error(file + ": cut off: " + std::to_string(text.size() - std::min(at, text.size())) + " of " +
                std::to_string(size) + " pixels are there");
  p.grey.assign(text.begin() + static_cast<std::ptrdiff_t>(at), text.begin() + static_cast<std::ptrdiff_t>(at + size));
  return p;
}

// The few lines "key: value" of a map_server yaml.
class MapYaml {
 public:
  explicit MapYaml(const std::string& file) : file_(file) {
    std::istringstream in(read_text(file));
    std::string line, last;
    while (std::getline(in, line)) {
      line = line.substr(0, line.find('#'));
      const size_t colon = line.find(':');
      if (colon != std::string::npos) {
        last = trimmed(line.substr(0, colon));
        value_[last] = trimmed(line.substr(colon + 1));
      } else if (const size_t dash = line.find("- "); dash != std::string::npos && !last.empty()) {
        value_[last] += " " + trimmed(line.substr(dash + 2)) + ",";  // a list, one entry a line
      }
    }
  }
  std::string text(const std::string& key) const {
    const auto found = value_.find(key);
    if (found == value_.end()) throw Error(file_ + ": key '" + key + "' is missing; a ROS map_server file is needed");
    return found->second;
  }
  double number(const std::string& key) const { return to_number(key, text(key).c_str()); }
  double number_or(const std::string& key, double other) const { return value_.contains(key) ? number(key) : other; }
  /// The first two of "[x, y, yaw]"; a turned map is an Error.
  Vec2 origin() const {
    const std::string list = text("origin");
    double v[3] = {0, 0, 0};
    size_t at = 0;
    for (double& x : v) {
      at = list.find_first_of("+-.0123456789", at);
      if (at == std::string::npos) throw Error(file_ + ": key 'origin' must be [x, y, yaw]");
      x = to_number("origin", list.c_str() + at);
      at = list.find_first_of(",]", at);
    }
    if (v[2] != 0) throw Error(file_ + ": key 'origin': the map is turned; only a yaw of 0 can be read");
    return {v[0], v[1]};
  }

 private:
  static std::string trimmed(const std::string& s) {
    const size_t a = s.find_first_not_of(" \t\r\"'"), b = s.find_last_not_of(" \t\r\"'");
    return a == std::string::npos ? "" : s.substr(a, b - a + 1);
  }
  double to_number(const std::string& key, const char* at) const {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at || !std::isfinite(x)) throw Error(file_ + ": key '" + key + "' must be a number");
    return x;
  }
  std::string file_;
  std::map<std::string, std::string> value_;
};

}  // namespace

Grid::Cell Grid::cell(int i, int j) const {
  if (i < 0 || j < 0 || i >= width || j >= height) return unknown;
  const float odds = log_odds[index(i, j)];
  return odds > 0 ? occupied : odds < 0 ? free : unknown;
}

void write_grid(const std::string& pgm_file, const Grid& grid) {
  std::string picture = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  for (int j = grid.height; j-- > 0;)
    for (int i = 0; i < grid.width; ++i) {
      const Grid::Cell c = grid.cell(i, j);
      picture.push_back(static_cast<char>(c == Grid::free       ? free_grey
                                          : c == Grid::occupied ? occupied_grey
                                                                : unknown_grey));
    }
  write_text(pgm_file, picture);
  char text[512];
  std::snprintf(text, sizeof text,
                "resolution: %.9g\norigin: [%.9g, %.9g, 0.0]\nnegate: 0\noccupied_thresh: %g\nfree_thresh: %g\n",
                grid.cell_m, grid.origin.x(), grid.origin.y(), occupied_above, free_below);
  write_text(yaml_beside(pgm_file), "image: " + fs::path(pgm_file).filename().string() + "\n" + text);
}

Grid read_grid(const std::string& yaml_file) {
  if (yaml_file.ends_with(".pgm") || yaml_file.ends_with(".png"))
    throw Error(yaml_file +
                ": a picture tells neither its scale nor its place; name the yaml of ROS map_server beside it");
  const MapYaml yaml(yaml_file);
  const fs::path image(yaml.text("image"));
  const Picture p =
      read_pgm(image.is_absolute() ? image.string() : (fs::path(yaml_file).parent_path() / image).string());
  Grid grid;
  grid.cell_m = yaml.number("resolution");
  if (!(grid.cell_m > 0)) throw Error(yaml_file + ": key 'resolution' must be > 0");
  grid.origin = yaml.origin();
  grid.width = p.width, grid.height = p.height;
  grid.log_odds.assign(p.grey.size(), 0);
  const bool negate = yaml.number_or("negate", 0) != 0;
  const double above = yaml.number_or("occupied_thresh", occupied_above),
               below = yaml.number_or("free_thresh", free_below);
  for (int j = 0; j < p.height; ++j)
    for (int i = 0; i < p.width; ++i) {
      const double light = p.grey[static_cast<size_t>(p.height - 1 - j) * p.width + i] / static_cast<double>(p.most);
      const double occupancy = negate ? light : 1 - light;
      grid.log_odds[grid.index(i, j)] = occupancy > above ? sure : occupancy < below ? -sure : 0;
    }
  return grid;
}

}  // namespace adit
