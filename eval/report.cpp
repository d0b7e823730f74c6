// SPDX-License-Identifier: BSD-3-Clause
#include "eval/report.h"

#include "base/files.h"
#include "base/parallel.h"
#include "eval/exhibit.h"
#include "eval/page.h"
#include "eval/page_data.h"

#include <algorithm>

namespace adit {

namespace {

std::vector<Chapter> make_chapters(const Exhibit& x, const Progress& progress) {
  std::vector<Chapter> chapters;
  const int total = 11 + x.settings.interiors + static_cast<int>(x.spots.size());
  int done = 0;
  const auto add = [&](Figure figure) {
    chapters.back().plates.push_back({std::move(figure), {}, {}});
    progress("report: pictures", ++done, total);
  };
  chapters.push_back({"worst", "Worst places", {}, Chapter::Columns::two});
  for (int k = 0; k < static_cast<int>(x.spots.size()); ++k) add(spot_view(x, k));
  if (x.spots.empty()) add(spot_view(x, 0));
  chapters.push_back({"space", "The map in space", {}, Chapter::Columns::one});
  add(cutaway_view(x));
  add(chamber_view(x));
  for (int k = 0; k < x.settings.interiors; ++k) add(interior_view(x, k));
  add(tilt_section(x));
  add(coverage_view(x));
  chapters.push_back({"plans", "Path and plan", {}, Chapter::Columns::first_three});
  add(truth_plan(x));
  add(raw_plan(x));
  add(aligned_plan(x));
  add(error_chart(x));
  add(rounds_plan(x));
  add(closures_plan(x));
  add(grid_plan(x));
  return chapters;
}

// Sets every drawing and writes its picture; each on its own, so on all threads.
void set_plates(const std::string& dir, const std::vector<Plate*>& plates, const Progress& progress) {
  progress("report: files", 0, 1);
  parallel_for(plates.size(), [&](size_t k) {
    Plate& plate = *plates[k];
    const Figure& figure = plate.figure;
    if (!figure.missing.empty()) return;
    plate.svg = to_svg(figure.drawing, figure.alt);
    write_png(dir + "/" + figure.name + ".png", to_picture(figure.drawing));
  });
  progress("report: files", 1, 1);
}

}  // namespace

Fields fields(ReportSettings& s) {
  return {{"width_px", &s.width_px, "width of a full-width picture", 600, 4000},
          {"range_m", &s.range_m, "end of the colour range of signed errors, 0 = chosen by the errors", 0, 100},
          {"interiors", &s.interiors, "views from the path", 0, 20},
          {"places", &s.places, "worst places with a close-up", 0, 20},
          {"frames", &s.frames, "of the animated sequence along the path, 0 = none", 0, 100},
          {"exaggeration", &s.exaggeration, "of heights, in the view of the whole mine", 1, 20}};
}

void write_report(const std::string& dir, const ReportInput& input, const ReportSettings& settings,
                  const Progress& progress) {
  const Exhibit x = make_exhibit(input, settings, progress);
  Plate hero{error_plan(x), {}, {}};
  std::vector<Chapter> chapters = make_chapters(x, progress);
  std::vector<Plate*> plates = {&hero};
  for (Chapter& c : chapters)
    for (Plate& p : c.plates) plates.push_back(&p);
  set_plates(dir, plates, progress);
  const std::vector<AlongFrame> frames = along_frames(x, progress);
  if (!frames.empty()) write_text(dir + "/along.png", animation_of(frames));
  const Figure narrow = narrow_error_plan(x);
  hero.narrow_svg = to_svg(narrow.drawing, hero.figure.alt);
  progress("report: page", 0, 1);
  write_text(dir + "/index.html", page_html(input, hero, chapters, page_data(x, hero.figure, narrow, frames)));
  progress("report: page", 1, 1);
}

}  // namespace adit
