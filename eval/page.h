// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/exhibit.h"

#include <string>
#include <vector>

namespace adit {

/// One number of the first screen.
struct KeyNumber {
  std::string label, value, unit, note;
};
/// The six numbers that say most, each with what it is made of; "–" and the reason where one could not be had.
std::vector<KeyNumber> key_numbers(const ReportInput& input);
/// What was mapped, how good it is and where it is worst, in one or two plain sentences.
std::string verdict(const ReportInput& input);

/// A figure as it stands on the page: the drawing as SVG, and one for narrow screens where there is one.
struct Plate {
  Figure figure;
  std::string svg, narrow_svg;
};
/// What stands together under one heading.
struct Chapter {
  std::string id, title;
  std::vector<Plate> plates;
  enum class Columns { one, two, first_three } columns = Columns::one;  // how wide pages lay them out
};

/// The whole page.
/// @param data  what its script draws from, as page_data gives it
std::string page_html(const ReportInput& input, const Plate& hero, const std::vector<Chapter>& chapters,
                      const std::string& data);
/// Everything before a page's body: title, policy (no network; no script but ours), style.
std::string page_head(const std::string& title);
/// The end of a page: what the script draws from, if anything, and the script.
std::string page_foot(const std::string& data);

}  // namespace adit
