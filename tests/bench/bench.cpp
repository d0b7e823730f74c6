// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/bench.h"

#include "base/error.h"

#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

namespace adit::bench {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

nlohmann::json result_of(const Benchmark& benchmark) {
  nlohmann::json out = nlohmann::json::object();
  try {
    for (const Figure& f : benchmark.run())
      out[f.name] = {{"value", f.value}, {"unit", f.unit}, {"better", f.better}, {"what", f.what}, {"n", f.n}};
  } catch (const Error& e) {
    for (const std::string& name : benchmark.names) out[name] = {{"why", e.what()}};
  }
  return out;
}

}  // namespace

Cost cost_of(const std::function<void()>& work) {
  int words[2];
  if (pipe(words) != 0) throw Error("no pipe could be opened");
  std::fflush(nullptr);
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) throw Error("no process could be started");
  if (child == 0) {
    std::string said;
    try {
      work();
    } catch (const std::exception& e) {
      said = e.what();
    }
    if (!said.empty() && write(words[1], said.data(), said.size()) < 0) _exit(2);
    _exit(said.empty() ? 0 : 1);
  }
  close(words[1]);
  std::string said(4096, '\0');
  const ssize_t got = read(words[0], said.data(), said.size());
  close(words[0]);
  said.resize(static_cast<size_t>(std::max<ssize_t>(0, got)));
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(said.empty() ? "the measured process ended badly" : said);
  return {wall_s, seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0)};
}

double best_seconds(int repeats, const std::function<void()>& work) {
  double best = seconds_of(work);
  for (int i = 1; i < repeats; ++i) best = std::min(best, seconds_of(work));
  return best;
}

int run(int argc, char** argv, const std::vector<Benchmark>& benchmarks) {
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  if (wanted == std::vector<std::string>{"--names"}) {
    for (const Benchmark& b : benchmarks)
      for (const std::string& name : b.names) std::cout << name << "\n";
    return 0;
  }
  nlohmann::json out = nlohmann::json::object();
  for (const Benchmark& b : benchmarks) {
    const bool asked = wanted.empty() || std::any_of(b.names.begin(), b.names.end(), [&](const std::string& name) {
                         return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
                       });
    if (!asked) continue;
    for (const std::string& name : b.names) std::cerr << "bench: " << name << "\n";
    out.update(result_of(b));
  }
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace adit::bench
