// SPDX-License-Identifier: BSD-3-Clause
#include "eval/render.h"

#include "base/error.h"
#include "eval/exhibit.h"

#include <algorithm>
#include <functional>

namespace adit {

namespace {

constexpr int most_numbered = 20;
const std::string animated = "along";

const std::vector<std::pair<std::string, std::function<Figure(const Exhibit&)>>>& views() {
  static const std::vector<std::pair<std::string, std::function<Figure(const Exhibit&)>>> all = {
      {"plan", error_plan},      {"truth", truth_plan},     {"raw", raw_plan},      {"aligned", aligned_plan},
      {"rounds", rounds_plan},   {"errors", error_chart},   {"grid", grid_plan},    {"closures", closures_plan},
      {"cutaway", cutaway_view}, {"chamber", chamber_view}, {"tilt", tilt_section}, {"coverage", coverage_view},
      {"mine", mine_view}};
  return all;
}

// The number of "interior-3" where the stem fits; 0 otherwise.
int number_after(const std::string& view, const std::string& stem) {
  if (!view.starts_with(stem)) return 0;
  for (int k = 1; k <= most_numbered; ++k)
    if (view == stem + std::to_string(k)) return k;
  return 0;
}

// The label of "thing-crib".
std::optional<Label> thing_in(const std::string& view) {
  for (const auto& [name, id] : label_ids())
    if (static_cast<Label>(id) >= Label::rubble && view == "thing-" + name) return static_cast<Label>(id);
  return {};
}

Figure view_of_name(const std::string& name, const Exhibit& exhibit) {
  for (const auto& [known, make] : views())
    if (known == name) return make(exhibit);
  if (const auto label = thing_in(name)) return thing_view(exhibit, *label);
  if (const int k = number_after(name, "interior-")) return interior_view(exhibit, k - 1);
  return spot_view(exhibit, number_after(name, "spot-") - 1);
}

bool exists(const std::string& name) {
  return std::any_of(views().begin(), views().end(), [&](const auto& v) { return v.first == name; }) ||
         number_after(name, "interior-") || number_after(name, "spot-") || thing_in(name);
}

}  // namespace

std::vector<std::string> view_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : views()) names.push_back(name);
  names.push_back(animated);
  for (const std::string stem : {"interior-", "spot-"})
    for (int k = 1; k <= 3; ++k) names.push_back(stem + std::to_string(k));
  names.push_back("thing-crib");
  return names;
}

namespace {

Exhibit exhibit_for(const std::string& view, const ReportInput& input, const ReportSettings& settings,
                    const std::optional<Viewpoint>& viewpoint) {
  if (view != animated && !exists(view)) {
    std::string known;
    for (const std::string& name : view_names()) known += (known.empty() ? "" : ", ") + name;
    throw Error("view '" + view + "': there is none of that name; there are " + known);
  }
  const bool in_space =
      view == "cutaway" || view == "chamber" || view == "mine" || thing_in(view) || number_after(view, "interior-") > 0;
  if (viewpoint && !in_space)
    throw Error("view '" + view +
                "': it takes no viewpoint; those that do are cutaway, chamber, interior-1, mine and thing-crib");
  if (viewpoint && (viewpoint->target - viewpoint->eye).norm() < 1e-6)
    throw Error("view '" + view + "': the eye stands where it looks at");
  ReportSettings all = settings;
  all.places = std::max(all.places, number_after(view, "spot-"));
  all.interiors = std::max(all.interiors, number_after(view, "interior-"));
  Exhibit exhibit = make_exhibit(input, all);
  exhibit.viewpoint = viewpoint;
  return exhibit;
}

}  // namespace

Picture render_view(const std::string& view, const ReportInput& input, const ReportSettings& settings,
                    const std::optional<Viewpoint>& viewpoint) {
  if (view == animated) throw Error("view '" + view + "': it is a sequence, no single picture");
  const Figure made = view_of_name(view, exhibit_for(view, input, settings, viewpoint));
  if (!made.missing.empty()) throw Error("view '" + view + "': " + made.missing);
  return to_picture(made.drawing);
}

std::string render_png(const std::string& view, const ReportInput& input, const ReportSettings& settings,
                       const std::optional<Viewpoint>& viewpoint) {
  if (view != animated) return encode_png(render_view(view, input, settings, viewpoint));
  const std::vector<AlongFrame> frames = along_frames(exhibit_for(view, input, settings, viewpoint));
  if (frames.empty())
    throw Error("view '" + view + "': there is no path to look from, no map to see, or no frame asked for");
  return animation_of(frames);
}

}  // namespace adit
