// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/history.h"

#include <string>
#include <vector>

namespace adit {

/// A regression as one sees it.
struct BeforeAfter {
  Claim claim;
  int seed = 0;
  std::string title, before, after;  // pictures, from the page's folder; empty: there is none
  std::string report;                // page of the run, from the page's folder
};

/// What the page of a suite tells of.
struct TrendInput {
  std::string suite, about;
  std::vector<std::string> metrics;  // in their order
  std::vector<Night> nights;         // of one branch, oldest first
  std::vector<BeforeAfter> pictures = {};
};

/// What happened in a history, in the order of its nights: claims that a night is the first to make, what they were gone
/// with, and what parts the history: another evaluator, another truth, another machine, an accepted night.
struct Event {
  size_t night;      // index of TrendInput::nights
  std::string kind;  // of a claim, or "recovered", "evaluator", "truth", "machine", "accepted"
  std::string words;
};
std::vector<Event> story(const std::vector<Night>& nights);

/// DIR/index.html: the story, and of each metric a line over the nights: the median over seeds with a band that holds half
/// of them. One file that needs no network.
void write_trend_page(const std::string& dir, const TrendInput& input);

}  // namespace adit
