// SPDX-License-Identifier: BSD-3-Clause
#include "cli/console.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string short_number(double v) {
  char text[32];
  if (v >= 1e6)
    std::snprintf(text, sizeof text, "%.1f M", v / 1e6);
  else if (v >= 1e4)
    std::snprintf(text, sizeof text, "%.0f k", v / 1e3);
  else
    std::snprintf(text, sizeof text, v < 10 && v != std::floor(v) ? "%.2g" : "%.0f", v);
  return text;
}

}  // namespace

Console::Console(bool quiet, bool json) : quiet_(quiet), json_(json), terminal_(::isatty(STDERR_FILENO) != 0) {}

Progress Console::progress() {
  if (quiet_) return Progress();
  return Progress([this](const std::string& step, double done, double total) { report(step, done, total); });
}

void Console::report(const std::string& step, double done, double total) {
  const double now = now_s();
  if (step != step_) {
    close_bar();
    step_ = step, step_began_s_ = now, last_drawn_s_ = 0, quarter_ = -1;
  }
  const double share = total > 0 ? std::min(1.0, done / total) : 1.0;
  if (!terminal_) {
    const int quarter = static_cast<int>(share * 4);
    if (quarter == quarter_ || quarter == 0) return;
    quarter_ = quarter;
    std::fprintf(stderr, "  %s: %.0f %%\n", step.c_str(), 100 * share);
    return;
  }
  if (now - last_drawn_s_ < 0.1 && share < 1) return;
  last_drawn_s_ = now;
  const double passed = now - step_began_s_, rate = passed > 0 ? done / passed : 0;
  const double left = share > 0 && share < 1 ? passed * (1 - share) / share : 0;
  constexpr int width = 30;
  std::string bar(width, '.');
  for (int i = 0; i < static_cast<int>(share * width); ++i) bar[i] = '#';
  std::fprintf(stderr, "\r  %-28s [%s] %3.0f %%  %s/s  %.0f s left \033[K", step.c_str(), bar.c_str(), 100 * share,
               short_number(rate).c_str(), left);
  std::fflush(stderr);
  bar_open_ = share < 1;
  if (!bar_open_) std::fputc('\n', stderr);
}

void Console::close_bar() {
  if (bar_open_) std::fputc('\n', stderr);
  bar_open_ = false;
}

void Console::note(const std::string& line) {
  if (quiet_) return;
  close_bar();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::result(const std::string& line) {
  close_bar();
  if (!json_) std::printf("%s\n", line.c_str());
}

void Console::json(const std::string& object) {
  if (json_) std::printf("%s\n", object.c_str());
}

}  // namespace adit
