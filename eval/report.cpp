// SPDX-License-Identifier: BSD-3-Clause
#include "eval/report.h"

#include "base/files.h"
#include "base/parallel.h"
#include "eval/exhibit.h"
#include "eval/page.h"
#include "eval/page_data.h"

#include <algorithm>
#include <functional>
#include <mutex>
#include <utility>

namespace adit {

namespace {

// A page's pictures before they are made: chapters with empty plates, and what makes each of them.
struct Plan {
  std::vector<Chapter> chapters;
  std::vector<std::function<Figure()>> make;  // (plates of all chapters, in their order)

  void chapter(Chapter begun) { chapters.push_back(std::move(begun)); }
  void add(std::function<Figure()> figure) {
    chapters.back().plates.emplace_back();
    make.push_back(std::move(figure));
  }
};

Plan plan_of(const Exhibit& x) {
  Plan plan;
  const auto add = [&](Figure (*view)(const Exhibit&)) { plan.add([&x, view] { return view(x); }); };
  plan.chapter({"worst", "Worst places", {}, Chapter::Columns::two});
  const int spots = std::max<int>(1, static_cast<int>(x.spots.size()));  // the first tells where there is none
  for (int k = 0; k < spots; ++k) plan.add([&x, k] { return spot_view(x, k); });
  plan.chapter({"space", "The map in space", {}, Chapter::Columns::one});
  add(cutaway_view);
  add(chamber_view);
  for (int k = 0; k < x.settings.interiors; ++k) plan.add([&x, k] { return interior_view(x, k); });
  add(tilt_section);
  add(coverage_view);
  plan.chapter({"plans", "Path and plan", {}, Chapter::Columns::first_three});
  for (const auto view : {truth_plan, raw_plan, aligned_plan, error_chart, rounds_plan, closures_plan, grid_plan})
    add(view);
  return plan;
}

// Makes every picture, sets it and writes its file: each on its own, so on all threads.
void set_plates(const std::string& dir, const std::vector<Plate*>& plates,
                const std::vector<std::function<Figure()>>& make, const Progress& progress) {
  std::mutex mutex;
  size_t done = 0;
  parallel_for(plates.size(), [&](size_t k) {
    Plate& plate = *plates[k];
    plate.figure = make[k]();
    if (plate.figure.missing.empty()) {
      plate.svg = to_svg(plate.figure.drawing, plate.figure.alt);
      write_png(dir + "/" + plate.figure.name + ".png", to_picture(plate.figure.drawing));
    }
    const std::lock_guard lock(mutex);
    progress("report: pictures", static_cast<double>(++done), static_cast<double>(plates.size()));
  });
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
  Plan plan = plan_of(x);
  std::vector<Chapter>& chapters = plan.chapters;
  Plate hero;
  plan.make.insert(plan.make.begin(), [&x] { return error_plan(x); });
  std::vector<Plate*> plates = {&hero};
  for (Chapter& c : chapters)
    for (Plate& p : c.plates) plates.push_back(&p);
  set_plates(dir, plates, plan.make, progress);
  const std::vector<AlongFrame> frames = along_frames(x, progress);
  if (!frames.empty()) write_text(dir + "/along.png", animation_of(frames));
  const Figure narrow = narrow_error_plan(x);
  hero.narrow_svg = to_svg(narrow.drawing, hero.figure.alt);
  progress("report: page", 0, 1);
  write_text(dir + "/index.html", page_html(input, hero, chapters, page_data(x, hero.figure, narrow, frames)));
  progress("report: page", 1, 1);
}

}  // namespace adit
