// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/study.h"

namespace adit {

/// Appends what each factor, and each pair of factors beyond that, does to a metric (index in StudyTable::metric) which
/// is an objective. Each seed's mean is taken off first; a factor of more than eight numbers is taken in thirds.
void add_effects(const StudyTable& table, size_t metric, size_t objective, StudyAnswer& answer);

}  // namespace adit
