// SPDX-License-Identifier: BSD-3-Clause
#include "sim/remote.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace adit {
namespace {

constexpr double pushed_mps2 = 0.5, pushed_rad_s2 = 2;  // what a person does to a cart
constexpr const char* columns[] = {"time_s", "speed_mps", "turn_rate_rad_s"};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream rest(line);
  for (std::string cell; std::getline(rest, cell, ',');) {
    const size_t from = cell.find_first_not_of(" \t\r"), to = cell.find_last_not_of(" \t\r");
    cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
  }
  return cells;
}

class Table {
 public:
  explicit Table(const std::string& file) : file_(file), text_(read_text(file)) {}

  std::vector<Command> read() {
    std::vector<Command> commands;
    for (std::string line; std::getline(text_, line);) {
      ++number_;
      const std::vector<std::string> cells = cells_of(line);
      if (cells.empty() || cells[0].empty() || cells[0][0] == '#') continue;
      if (!headed_)
        head(cells);
      else
        commands.push_back({value(cells, 0), value(cells, 1), value(cells, 2)});
      if (commands.size() > 1 && !(commands.back().time_s > commands[commands.size() - 2].time_s))
        fail("time_s must increase from row to row");
    }
    if (commands.size() < 2) throw Error(file_ + ": two commands at least are needed; the last one ends the drive");
    if (commands.front().time_s < 0) throw Error(file_ + ": time_s must not be negative");
    return commands;
  }

 private:
  void head(const std::vector<std::string>& cells) {
    for (int k = 0; k < 3; ++k) {
      const auto at = std::find(cells.begin(), cells.end(), columns[k]);
      if (at == cells.end())
        fail(std::string("has no column ") + columns[k] +
             "; the first line must name time_s,speed_mps,turn_rate_rad_s");
      column_[k] = static_cast<size_t>(at - cells.begin());
    }
    headed_ = true;
  }

  double value(const std::vector<std::string>& cells, int k) const {
    double number = 0;
    if (column_[k] >= cells.size()) fail(std::string(columns[k]) + " is missing");
    const std::string& cell = cells[column_[k]];
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(number))
      fail(std::string(columns[k]) + " = '" + cell + "' is no number");
    return number;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(file_ + ":" + std::to_string(number_) + ": " + what);
  }

  std::string file_;
  std::istringstream text_;
  int number_ = 0;
  bool headed_ = false;
  size_t column_[3] = {0, 0, 0};
};

}  // namespace

std::vector<Command> read_commands(const std::string& file) {
  return Table(file).read();
}

Remote::Remote(std::vector<Command> commands, const Vehicle& vehicle) : commands_(std::move(commands)) {
  const bool pushed = vehicle.drivetrain == Drivetrain::pushed;
  acceleration_mps2_ = pushed ? pushed_mps2 : vehicle.motors.acceleration_mps2;
  turn_acceleration_rad_s2_ = pushed ? pushed_rad_s2 : vehicle.motors.turn_max_rad_s;
}

Intent Remote::want(double t_s, double step_s) {
  while (next_ < commands_.size() && commands_[next_].time_s <= t_s) ++next_;
  const double speed = next_ > 0 ? commands_[next_ - 1].speed_mps : 0;
  const double turn = next_ > 0 ? commands_[next_ - 1].turn_rate_rad_s : 0;
  const double faster = acceleration_mps2_ * step_s, quicker = turn_acceleration_rad_s2_ * step_s;
  speed_mps_ = std::clamp(speed, speed_mps_ - faster, speed_mps_ + faster);
  turn_rad_s_ = std::clamp(turn, turn_rad_s_ - quicker, turn_rad_s_ + quicker);
  return {speed_mps_, turn_rad_s_, speed_mps_ == 0 && turn_rad_s_ == 0};
}

}  // namespace adit
