// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/score.h"

#include <span>
#include <string>
#include <vector>

namespace adit {

/// Metrics as they are found, under one prefix of their names.
class MetricList {
 public:
  explicit MetricList(std::vector<Metric>& all, std::string prefix = "") : all_(&all), prefix_(std::move(prefix)) {}
  /// The same list, names begin with "prefix.block.".
  MetricList under(const std::string& block) const { return MetricList(*all_, prefix_ + block + "."); }

  /// A value that is not finite needs the reason why it could not be had.
  void add(const std::string& name, double value, const std::string& unit, Better better, std::int64_t n,
           const std::string& why = "") const;
  void count(const std::string& name, std::int64_t value, Better better, const std::string& why = "") const;

 private:
  std::vector<Metric>* all_;
  std::string prefix_;
};

/// The p-quantile (0..1) of the values, linear between neighbours (as numpy's default); NaN of none. Reorders them.
double quantile(std::span<double> values, double p);

}  // namespace adit
