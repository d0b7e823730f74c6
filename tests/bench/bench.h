// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace adit::bench {

/// One measured figure, as ci/bench prints it.
struct Figure {
  std::string name;
  double value;
  std::string unit;    // "s", "GiB", "ratio", "1/s", "share"
  std::string better;  // "lower" or "higher"
  std::string what;    // in words, with what it was measured on
  std::int64_t n = 1;  // repetitions, rays, matches, ... that it stands on
};

/// A benchmark: all the figures that one piece of work yields. It runs when any of its names is asked for.
struct Benchmark {
  std::vector<std::string> names;
  std::function<std::vector<Figure>()> run;  // throws Error with the reason where it cannot be run (a peer is missing)
};

/// What a piece of work took in a process of its own, so that its peak is its own.
struct Cost {
  double wall_s, cpu_s, peak_gib;
};
/// @throws Error if the work throws, with its words
Cost cost_of(const std::function<void()>& work);

/// Seconds of wall time of one call, the best of `repeats`.
double best_seconds(int repeats, const std::function<void()>& work);

/// A program's main: runs the benchmarks that are named on the command line (all without a name, names that are not
/// its own are passed over) and writes one JSON object {name: {value, unit, better, what, n}} to stdout; what could not
/// be run stands as {name: {why}}. `--names` lists them.
/// @return the program's exit code
int run(int argc, char** argv, const std::vector<Benchmark>& benchmarks);

}  // namespace adit::bench
