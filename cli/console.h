// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/progress.h"

#include <string>

namespace adit {

/// Where a command's words go: results to stdout, progress to stderr. With --json stdout holds one JSON object and
/// nothing else; with --quiet stderr holds errors only.
class Console {
 public:
  Console(bool quiet, bool json);

  /// A bar with rate and time left on a terminal; elsewhere a plain line at each start and each further quarter.
  Progress progress();
  /// A line for people on stderr.
  void note(const std::string& line);
  /// A line of the result on stdout; dropped with --json.
  void result(const std::string& line);
  /// The JSON object, printed only with --json.
  void json(const std::string& object);
  bool wants_json() const { return json_; }

 private:
  bool quiet_, json_, terminal_;
  bool bar_open_ = false;
  std::string step_;
  double step_began_s_ = 0, last_drawn_s_ = 0;
  int quarter_ = -1;

  void report(const std::string& step, double done, double total);
  void close_bar();
};

}  // namespace adit
