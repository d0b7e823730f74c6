// SPDX-License-Identifier: BSD-3-Clause
#include "cli/peak_memory.h"

#include <algorithm>
#include <fstream>
#include <string>

namespace adit {
namespace {

double gib_of(const char* file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(key + ":")) return std::stod(line.substr(key.size() + 1)) / (1024.0 * 1024.0);
  return 0;
}

}  // namespace

double peak_gib() {
  return gib_of("/proc/self/status", "VmHWM");
}

void restart_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

double available_gib() {
  return gib_of("/proc/meminfo", "MemAvailable");
}

PeakShares::Share::Share(PeakShares& all) : all_(all) {
  const std::lock_guard lock(all.mutex_);
  all.look();
  mine_ = all.running_.insert(all.running_.end(), 0);
}

PeakShares::Share::~Share() {
  const std::lock_guard lock(all_.mutex_);
  all_.look();
  all_.running_.erase(mine_);
}

double PeakShares::Share::peak_gib() const {
  const std::lock_guard lock(all_.mutex_);
  all_.look();
  return *mine_;
}

double PeakShares::highest_gib() const {
  const std::lock_guard lock(mutex_);
  look();
  return highest_;
}

// The peak since the last look belongs to all that ran.
void PeakShares::look() const {
  const double gib = adit::peak_gib();
  for (double& peak : running_) peak = std::max(peak, gib);
  highest_ = std::max(highest_, gib);
  restart_peak();
}

}  // namespace adit
