// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace adit {

/// One question put to the seeds of a metric: are they worse (better, either)? With the least p that as many changed
/// seeds can reach.
struct Question {
  size_t metric;  // whose answer it is
  double p = 1, least_p = 1;
};
/// @param test    "wilcoxon" (of signed ranks) or "sign_flip" (of the values)
/// @param steady  any move counts, not one way alone
Question ask(size_t metric, std::vector<double> differences, const std::string& test, bool steady);

/// Holm's p, by metric, of those questions that could be answered with yes at all, after Tarone (Biometrics 46, 1990): of
/// the least k such that no more than k of them could reach level / k.
std::map<size_t, double> answers(const std::vector<Question>& questions, double level);

}  // namespace adit
