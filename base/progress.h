// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace adit {

/// How far a long step is. Libraries report through it and never print; silent by default.
class Progress {
 public:
  using Report = std::function<void(const std::string& step, double done, double total)>;
  Progress() = default;
  explicit Progress(Report report) : report_(std::move(report)) {}
  /// `done` of `total` units of `step` are behind us. Call from one thread.
  void operator()(const std::string& step, double done, double total) const {
    if (report_) report_(step, done, total);
  }

 private:
  Report report_;
};

}  // namespace adit
