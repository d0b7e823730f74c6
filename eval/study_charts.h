// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/study_page.h"

#include <string>

namespace adit {

// The charts of a study's page, as figures of its HTML.

/// Two objectives against each other, each point with its intervals.
std::string front_chart(const StudyPage& page, size_t a, size_t b);
/// The fast value against the first objective that is a metric; empty where there are not two points.
std::string agreement_chart(const StudyPage& page);
/// What is left of the prior's deviation in each direction, for each rig looked at closely.
std::string blind_chart(const StudyPage& page);

/// An objective with its unit.
std::string objective_words(const StudyTable& table, size_t objective);
/// A number as the page writes it.
std::string study_number(double value);

}  // namespace adit
