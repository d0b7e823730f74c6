// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metric_list.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {

void MetricList::add(const std::string& name, double value, const std::string& unit, Better better, std::int64_t n,
                     const std::string& why) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const bool have = std::isfinite(value);
  all_->push_back({prefix_ + name, have ? value : none, unit, better, n,
                   have ? "" : (why.empty() ? "there is nothing to take it from" : why)});
}

void MetricList::count(const std::string& name, std::int64_t value, Better better, const std::string& why) const {
  add(name, why.empty() ? static_cast<double>(value) : std::numeric_limits<double>::quiet_NaN(), "count", better,
      why.empty() ? value : 0, why);
}

double quantile(std::span<double> values, double p) {
  ADIT_CHECK(p >= 0 && p <= 1);
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double at = p * static_cast<double>(values.size() - 1);
  const auto k = static_cast<size_t>(at);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
  const double low = values[k];
  if (k + 1 == values.size()) return low;
  const double high = *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(k) + 1, values.end());
  return low + (at - static_cast<double>(k)) * (high - low);
}

}  // namespace adit
