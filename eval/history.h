// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace adit {

/// One run of a night.
struct NightCell {
  std::string scenario, method;
  int seed = 0;
  std::string truth;                    // digests of mine and true path; empty where it failed
  std::string failure;                  // why there are no values; empty where there are
  std::string run;                      // folder of what is kept of it; empty: nothing
  double seconds = 0;                   // that it took; NaN: not known
  std::map<std::string, double> value;  // of the suite's metrics; what could not be had is missing
  double peak_gib =
      std::numeric_limits<double>::quiet_NaN();  // the most that the process held meanwhile; NaN: not known
};

/// Something that a verdict says of a metric of a night.
struct Claim {
  std::string scenario, method, metric;
  std::string kind;   // "regressed", "crept", "improved", "beyond", "failing", "not comparable"
  std::string words;  // value, baseline, interval, since when
};

/// Everything that one call of `adit nightly` measured and said.
struct Night {
  std::int64_t id = 0;                         // rising in a history; 0: not in one yet
  std::string suite, branch, commit, version;  // of adit or of whatever is tested
  std::string evaluator;                       // numbers of two evaluators are not comparable
  std::string machine, compiler;               // times and memory of two machines are not comparable
  std::string date;                            // of the night, for people: "2026-03-01 02:00"
  std::string verdict;                         // "first", "pass", "improved", "regressed", "not comparable"
  std::string accepted;                        // why what it shows is the new baseline; empty: it is not
  std::vector<NightCell> cells = {};
  std::vector<Claim> claims = {};
};

/// The nights of one or more suites in one SQLite file; docs/files.md has the schema. A night is one transaction: a kill
/// or a full disk leaves the file as it was. Every fault is an Error that names the file.
class History {
 public:
  /// Opens or makes the file.
  /// @param wait_ms  for another process that has it locked
  /// @throws Error (file) for one that is no history, that a newer adit made, that cannot be read or stays locked
  explicit History(const std::string& file, int wait_ms = 10000);
  ~History();

  /// All nights of a suite, oldest first.
  std::vector<Night> nights(const std::string& suite) const;
  /// @return its id
  std::int64_t add(const Night& night);
  /// Marks the last night of a suite (and branch, unless it is empty) as the new baseline: nothing before it is compared.
  /// @return its id
  /// @throws Error where there is none
  std::int64_t accept(const std::string& suite, const std::string& branch, const std::string& why);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
