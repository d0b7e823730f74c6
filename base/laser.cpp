// SPDX-License-Identifier: BSD-3-Clause
#include "base/laser.h"

#include "base/config.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace adit {

double LaserModel::beam_offset_s(int k) const {
  // Turn k % interlace; within a turn the mirror sweeps 360 deg in turn_s, the field of view at even speed.
  return (k % interlace) * turn_s + (beam_angle_rad(k) + fov_rad / 2) / (2 * std::numbers::pi) * turn_s;
}

double LaserModel::least_reflectivity(double range_m) const {
  if (chart_range_m.empty())
    return range_m <= 4 || reflectivity_at_4m == 0 ? reflectivity_at_4m
                                                   : reflectivity_at_4m * std::pow(range_m / 4, reflectivity_exponent);
  const size_t next = static_cast<size_t>(std::upper_bound(chart_range_m.begin(), chart_range_m.end(), range_m) -
                                          chart_range_m.begin());
  if (next == 0) return chart_reflectivity.front();
  if (next == chart_range_m.size()) return chart_reflectivity.back() * std::pow(range_m / chart_range_m.back(), 2);
  const double s = (range_m - chart_range_m[next - 1]) / (chart_range_m[next] - chart_range_m[next - 1]);
  return (1 - s) * chart_reflectivity[next - 1] + s * chart_reflectivity[next];
}

namespace {

constexpr double degree = std::numbers::pi / 180;

// What a laser's file states in the units that people write.
struct Sheet {
  LaserModel model;
  double fov_deg = 180, turn_ms = 13.32, resolution_mm = 1, sigma_mm = 5, bias_mm = 0, spot_mm = 0, divergence_mrad = 0;
  double curve_mm = 0, energy_mm = 0, warm_up_mm = 0, sensitivity_factor = 1;
  std::vector<int> bauds, skips;
};

Fields raster_fields(Sheet& s) {
  return {{"fov_deg", &s.fov_deg, "field of view", 1, 360},
          {"beams", &s.model.beams, "per scan, both ends of the field of view included", 2, 100000},
          {"interlace", &s.model.interlace, "turns that make one scan", 1, 16},
          {"bauds", &s.bauds, "rates of the serial link"},
          {"skips", &s.skips, "scans lost between two that are sent, for each of bauds"}};
}

Fields mode_fields(Sheet& s) {
  return {{"range_max_m", &s.model.range_max_m, "largest range that can be told", 0.1, 10000},
          {"resolution_mm", &s.resolution_mm, "step of the reported range", 0, 1000},
          {"sigma_mm", &s.sigma_mm, "noise of one range, 1 sd", 0, 1e9},
          {"bias_mm", &s.bias_mm, "systematic error of a device, half width of its band", 0, 1e9}};
}

Fields sensitivity_fields(Sheet& s) {
  return {{"sensitivity_factor", &s.sensitivity_factor, "of the least reflectivity", 0.01, 100}};
}

Fields sheet_fields(Sheet& s) {
  LaserModel& m = s.model;
  Fields all{{"name", &m.name, "how reports call it"},
             {"turn_ms", &s.turn_ms, "one turn of the mirror", 0.01, 10000},
             {"spot_mm", &s.spot_mm, "beam diameter at the window", 0, 1e9},
             {"divergence_mrad", &s.divergence_mrad, "growth of the diameter", 0, 1000},
             {"reflectivity_at_4m", &m.reflectivity_at_4m, "least diffuse reflectivity that is seen up to 4 m", 0, 100},
             {"reflectivity_exponent", &m.reflectivity_exponent, "its growth with range beyond", 0, 10},
             {"chart_range_m", &m.chart_range_m, "least reflectivity by range instead: ranges, growing"},
             {"chart_reflectivity", &m.chart_reflectivity, "and the reflectivity at each"},
             {"curve_mm", &s.curve_mm, "error that swings with the range, at most", 0, 1000},
             {"energy_mm", &s.energy_mm, "error between dark and bright targets, at most", 0, 1000},
             {"warm_up_mm", &s.warm_up_mm, "error of a cold device, at most", 0, 1000},
             {"warm_up_s", &m.warm_up_s, "time in which it fades to a third", 1, 1e6},
             {"codes", &m.codes, "whether it tells why there is no range"}};
  for (const Fields& more : {raster_fields(s), mode_fields(s), sensitivity_fields(s)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

// Reads the table KIND named `wanted` over what the top of the file states.
void choose(const Document& file, const std::string& kind, const std::string& wanted, Fields (*fields_of)(Sheet&),
            Sheet& sheet) {
  std::string known;
  bool found = wanted.empty();
  const Sheet top = sheet;
  const std::vector<Document> tables = file.tables(kind);
  if (tables.empty() && file.has(kind)) file.fail(kind, "must be tables, [[" + kind + "]] each");
  for (const Document& table : tables) {
    Sheet with = top;
    std::string name;
    Fields fields = fields_of(with);
    fields.push_back({"name", &name, "by which it is chosen"});
    table.read(fields);
    known += (known.empty() ? "" : ", ") + name;
    if (found || name != wanted) continue;
    found = true;
    sheet = with;
  }
  if (!found)
    throw Error(file.name() + ": has no " + kind + " '" + wanted + "'; it has " + (known.empty() ? "none" : known));
}

void check_chart(const Document& file, const LaserModel& m) {
  if (m.chart_range_m.size() != m.chart_reflectivity.size())
    file.fail("chart_reflectivity", "must have one number for each of 'chart_range_m'");
  for (size_t i = 0; i < m.chart_range_m.size(); ++i) {
    if (i > 0 && m.chart_range_m[i] <= m.chart_range_m[i - 1]) file.fail("chart_range_m", "must grow");
    if (!(m.chart_reflectivity[i] > 0)) file.fail("chart_reflectivity", "must be greater than 0");
  }
}

// A scan is on the link while `skips` mirror scans pass unheard.
double interval_s(const Document& file, const Sheet& s, int baud, const std::string& raster) {
  const double scan_s = s.turn_ms * 1e-3 * s.model.interlace;
  if (baud <= 0 || s.bauds.empty()) return scan_s;
  std::string known;
  for (size_t i = 0; i < s.bauds.size(); ++i) {
    if (s.bauds[i] == baud) return scan_s * (1 + s.skips[i]);
    known += (i ? ", " : "") + std::to_string(s.bauds[i]);
  }
  const std::string lacks = "has no rate of " + std::to_string(baud) + " Bd; it has " + known;
  if (raster.empty()) file.fail("bauds", lacks);
  throw Error(file.name() + ": the raster '" + raster + "' " + lacks);
}

// A scan leaves the device a turn later, at most 508 bytes a turn, and then has the link to cross, ten bits a byte.
// Source: SICK telegram listing 8007954; a telegram frames two bytes a value by ten, and holds 812 at most: longer scans
// come as one telegram a turn.
double latency_s(const Sheet& s, int baud) {
  if (baud <= 0 || s.bauds.empty()) return 0;
  const LaserModel& m = s.model;
  const auto bytes_of = [](int values) { return 10 + 2 * values; };
  const int bytes = bytes_of(m.beams) <= 812 ? bytes_of(m.beams) : bytes_of(1 + (m.beams - 1) / m.interlace);
  const int turns = m.interlace + (bytes + 507) / 508;
  return turns * s.turn_ms * 1e-3 + 10.0 * bytes / baud;
}

}  // namespace

LaserModel load_laser(const std::string& name_or_file, int baud, const LaserChoice& choice) {
  const Document file = Document::find("sensors/lasers", name_or_file);
  Sheet s;
  LaserModel& m = s.model;
  m.beams = 361;
  m.range_max_m = 30;
  file.read(sheet_fields(s), {"mode", "raster", "sensitivity"});
  choose(file, "mode", choice.mode, mode_fields, s);
  choose(file, "raster", choice.raster, raster_fields, s);
  choose(file, "sensitivity", choice.sensitivity, sensitivity_fields, s);
  if (m.name.empty()) m.name = name_or_file;
  if (s.bauds.size() != s.skips.size()) file.fail("skips", "must have one number for each of 'bauds'");
  check_chart(file, m);
  m.fov_rad = s.fov_deg * degree;
  m.turn_s = s.turn_ms * 1e-3;
  m.resolution_m = s.resolution_mm * 1e-3;
  m.sigma_m = s.sigma_mm * 1e-3;
  m.bias_m = s.bias_mm * 1e-3;
  m.spot_m = s.spot_mm * 1e-3;
  m.divergence_rad = s.divergence_mrad * 1e-3;
  m.curve_m = s.curve_mm * 1e-3;
  m.energy_m = s.energy_mm * 1e-3;
  m.warm_up_m = s.warm_up_mm * 1e-3;
  m.reflectivity_at_4m *= s.sensitivity_factor;
  for (double& least : m.chart_reflectivity) least *= s.sensitivity_factor;
  m.interval_s = interval_s(file, s, baud, choice.raster);
  m.latency_s = latency_s(s, baud);
  return m;
}

}  // namespace adit
