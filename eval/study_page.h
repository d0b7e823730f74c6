// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/picture.h"
#include "eval/study.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// A rig looked at closely.
struct RigWhy {
  std::string title;                                      // "best: placement 3"
  std::optional<FastScore> score;                         // none: not judged by geometry
  std::vector<std::pair<std::string, Picture>> pictures;  // file's name and what is seen
};

/// What a study's page tells.
struct StudyPage {
  const StudyTable& table;
  const StudyAnswer& answer;
  std::vector<RigWhy> why;  // best, worst
  std::string study_toml, recommended_toml;
};

/// DIR/index.html, one file that needs no other, and the pictures beside it. The same bytes for the same input.
void write_study_page(const std::string& dir, const StudyPage& page);

/// "placement 3, speed 0.5".
std::string words_of(const StudyTable& table, size_t point);

}  // namespace adit
