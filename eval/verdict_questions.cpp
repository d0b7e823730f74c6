// SPDX-License-Identifier: BSD-3-Clause
#include "eval/verdict_questions.h"

#include "eval/compare.h"

#include <algorithm>
#include <cmath>

namespace adit {

Question ask(size_t metric, std::vector<double> differences, const std::string& test, bool steady) {
  const auto changed = std::count_if(differences.begin(), differences.end(), [](double d) { return d != 0; });
  if (test == "wilcoxon") differences = signed_ranks(differences);
  return {metric, sign_flip_p(differences, steady ? Tail::both : Tail::above),
          std::ldexp(steady && changed > 0 ? 2 : 1, -static_cast<int>(changed))};
}

std::map<size_t, double> answers(const std::vector<Question>& questions, double level) {
  std::vector<const Question*> family;
  for (size_t k = 1; k <= std::max<size_t>(1, questions.size()); ++k) {
    family.clear();
    for (const Question& q : questions)
      if (q.least_p <= level / static_cast<double>(k)) family.push_back(&q);
    if (family.size() <= k) break;
  }
  std::vector<double> p;
  for (const Question* q : family) p.push_back(q->p);
  const std::vector<double> corrected = holm(p);
  std::map<size_t, double> out;
  for (size_t k = 0; k < family.size(); ++k) out[family[k]->metric] = corrected[k];
  return out;
}

}  // namespace adit
