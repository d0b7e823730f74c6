// SPDX-License-Identifier: BSD-3-Clause
// From a study's factors to its points.
#include "base/error.h"
#include "base/rng.h"
#include "cli/study_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

// Primitive polynomials and first directions, new-joe-kuo-6.21201; the first dimension is van der Corput's.
struct SobolDimension {
  unsigned degree, polynomial;
  std::array<std::uint32_t, 6> first;
};
constexpr std::array<SobolDimension, 15> sobol_dimensions{{{1, 0, {1}},
                                                           {2, 1, {1, 3}},
                                                           {3, 1, {1, 3, 1}},
                                                           {3, 2, {1, 1, 1}},
                                                           {4, 1, {1, 1, 3, 3}},
                                                           {4, 4, {1, 3, 5, 13}},
                                                           {5, 2, {1, 1, 5, 5, 17}},
                                                           {5, 4, {1, 1, 5, 5, 5}},
                                                           {5, 7, {1, 1, 7, 11, 19}},
                                                           {5, 11, {1, 1, 5, 1, 1}},
                                                           {5, 13, {1, 1, 1, 3, 11}},
                                                           {5, 14, {1, 3, 5, 5, 31}},
                                                           {6, 1, {1, 3, 3, 9, 7, 49}},
                                                           {6, 13, {1, 1, 1, 15, 21, 21}},
                                                           {6, 16, {1, 3, 1, 13, 27, 49}}}};

std::array<std::uint32_t, 32> directions(size_t dimension) {
  std::array<std::uint32_t, 32> v{};
  for (unsigned k = 0; k < 32; ++k) v[k] = 1U << (31 - k);
  if (dimension == 0) return v;
  const SobolDimension& d = sobol_dimensions[dimension - 1];
  for (unsigned k = 0; k < 32; ++k) {
    if (k < d.degree) {
      v[k] = d.first[k] << (31 - k);
      continue;
    }
    v[k] = v[k - d.degree] ^ (v[k - d.degree] >> d.degree);
    for (unsigned j = 1; j < d.degree; ++j)
      if ((d.polynomial >> (d.degree - 1 - j)) & 1U) v[k] ^= v[k - j];
  }
  return v;
}

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string number_toml(const Factor& f, double v) {
  if (f.whole) return std::to_string(std::lround(v));
  const std::string text = number(v);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

// Value of a range at u in [0, 1].
double in_range(const Factor& f, double u) {
  return f.log ? f.from * std::pow(f.to / f.from, u) : f.from + u * (f.to - f.from);
}

std::string unquoted(const std::string& toml) {
  return toml.size() > 1 && toml.front() == '"' && toml.back() == '"' ? toml.substr(1, toml.size() - 2) : toml;
}

size_t levels_of(const Factor& f) {
  return f.values.empty() ? static_cast<size_t>(f.steps) : f.values.size();
}

std::vector<std::string> texts_of(const Factor& f, const std::string& toml) {
  std::vector<std::string> texts;
  set_field({{f.key, &texts, ""}}, f.key + "=" + toml);
  return texts;
}

void set_level(DesignPoint& point, const Factor& f, const std::string& value, const std::string& label) {
  point.level.push_back(label);
  if (f.key == "set") {
    const std::vector<std::string> changes = texts_of(f, value);
    point.changes.insert(point.changes.end(), changes.begin(), changes.end());
    return;
  }
  if (!f.key.starts_with("rig.")) {
    point.changes.push_back(f.key + "=" + value);
    return;
  }
  const size_t dot = f.key.find('.', 4);
  const std::string laser = f.key.substr(4, dot - 4), key = f.key.substr(dot + 1);
  point.mounts.push_back(key == "off" ? value == "true" ? laser + " off" : "" : laser + " " + key + "=" + value);
  if (point.mounts.back().empty()) point.mounts.pop_back();
}

void set_level(DesignPoint& point, const Factor& f, size_t i) {
  if (!f.values.empty()) {
    set_level(point, f, f.values[i], f.labels.empty() ? unquoted(f.values[i]) : f.labels[i]);
    return;
  }
  const double v = in_range(f, f.steps > 1 ? static_cast<double>(i) / (f.steps - 1) : 0);
  set_level(point, f, number_toml(f, v), number_toml(f, v));
}

}  // namespace

std::vector<std::vector<double>> sobol(size_t n, size_t dimensions, int seed) {
  if (dimensions > sobol_dimensions.size() + 1)
    throw Error("sample = \"sobol\" knows " + std::to_string(sobol_dimensions.size() + 1) + " dimensions, there are " +
                std::to_string(dimensions) + " factors; \"latin\" has no such limit");
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  for (size_t d = 0; d < dimensions; ++d) {
    const auto v = directions(d);
    const auto shift =
        static_cast<std::uint32_t>(random_bits(static_cast<std::uint64_t>(seed), Draw::study_sample, d, 0));
    for (size_t i = 0; i < n; ++i) {
      std::uint32_t x = shift;
      for (size_t k = 0, bits = i; bits != 0; ++k, bits >>= 1U)
        if (bits & 1U) x ^= v[k];
      points[i][d] = static_cast<double>(x) / 4294967296.0;
    }
  }
  return points;
}

std::vector<std::vector<double>> latin_hypercube(size_t n, size_t dimensions, int seed) {
  const auto s = static_cast<std::uint64_t>(seed);
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  for (size_t d = 0; d < dimensions; ++d) {
    std::vector<size_t> stratum(n);
    for (size_t i = 0; i < n; ++i) {  // Fisher and Yates, from within
      const auto j = static_cast<size_t>(uniform(s, Draw::study_sample, 1000 + d, i) * static_cast<double>(i + 1));
      stratum[i] = stratum[j], stratum[j] = i;
    }
    for (size_t i = 0; i < n; ++i)
      points[i][d] =
          (static_cast<double>(stratum[i]) + uniform(s, Draw::study_sample, 2000 + d, i)) / static_cast<double>(n);
  }
  return points;
}

double design_size(const Study& study) {
  if (study.sample != "grid") return study.factor.empty() ? 1 : study.samples;
  double n = 1;
  for (const Factor& f : study.factor) n *= static_cast<double>(levels_of(f));
  return n;
}

std::vector<DesignPoint> design_of(const Study& study) {
  std::vector<DesignPoint> points(static_cast<size_t>(design_size(study)));
  if (study.sample == "grid") {
    for (size_t p = 0; p < points.size(); ++p) {  // the last factor runs fastest
      size_t block = points.size();
      for (const Factor& f : study.factor) {
        block /= levels_of(f);
        set_level(points[p], f, p / block % levels_of(f));
      }
    }
    return points;
  }
  const auto samples = study.sample == "sobol" ? sobol(points.size(), study.factor.size(), study.sample_seed)
                                               : latin_hypercube(points.size(), study.factor.size(), study.sample_seed);
  for (size_t p = 0; p < points.size(); ++p)
    for (size_t f = 0; f < study.factor.size(); ++f) {
      const Factor& factor = study.factor[f];
      const double u = samples[p][f];
      if (!factor.values.empty()) {
        const auto last = factor.values.size() - 1;
        set_level(points[p], factor,
                  std::min(last, static_cast<size_t>(u * static_cast<double>(factor.values.size()))));
      } else {
        const std::string value = number_toml(factor, in_range(factor, u));
        set_level(points[p], factor, value, value);
      }
    }
  return points;
}

Scenario scenario_at(const Study& study, const DesignPoint& point, int seed) {
  std::vector<std::string> changes = study.set;
  changes.insert(changes.end(), point.changes.begin(), point.changes.end());
  Scenario s = load_scenario(study.scenario, changes);
  s.sensors.mounts.insert(s.sensors.mounts.end(), point.mounts.begin(), point.mounts.end());
  s.seed = seed;
  return s;
}

Device cost_of(const Study& study, const RigText& rig) {
  Device sum;
  for (const MountText& m : rig.lasers) {
    const auto d =
        std::find_if(study.device.begin(), study.device.end(), [&](const Device& x) { return x.model == m.model; });
    if (d != study.device.end()) {
      sum.price += d->price, sum.mass_kg += d->mass_kg;
      continue;
    }
    const bool asked = study.price_max > 0 || study.mass_max_kg > 0 ||
                       std::any_of(study.objectives.begin(), study.objectives.end(),
                                   [](const std::string& o) { return o == "price" || o == "mass_kg"; });
    if (asked)
      throw Error("the study asks what lasers cost, and there is no [[device]] for the model '" + m.model +
                  "' of laser '" + m.name + "'");
  }
  return sum;
}

std::string excluded(const Study& study, const RigText& rig, const Hull& hull) {
  const Device cost = cost_of(study, rig);
  if (study.price_max > 0 && cost.price > study.price_max) return "price above price_max";
  if (study.mass_max_kg > 0 && cost.mass_kg > study.mass_max_kg) return "mass above mass_max_kg";
  if (study.clearance_m <= 0) return "";
  for (const MountText& m : rig.lasers)
    if (clearance_of(hull, {m.position_m[0], m.position_m[1], m.position_m[2]}) < study.clearance_m)
      return "a mirror nearer to the hull than clearance_m";
  return "";
}

std::vector<Candidate> candidates_of(const Study& study, const Hull& hull) {
  const MountSearch& search = study.mounts;
  const std::vector<Vec3> places = hull_points(hull, search.spacing_m, std::max(search.clearance_m, study.clearance_m));
  const size_t n = places.size() * search.models.size() * search.orientations.size();
  if (n == 0)
    throw Error("[mounts]: no candidate: " + std::to_string(places.size()) + " places on the hull with clearance_m = " +
                number(search.clearance_m) + ", " + std::to_string(search.models.size()) + " models, " +
                std::to_string(search.orientations.size()) + " orientations");
  if (n > static_cast<size_t>(search.most))
    throw Error("[mounts]: " + std::to_string(n) + " candidates are more than mounts.most = " +
                std::to_string(search.most) + "; a greater spacing_m, fewer models or orientations leave fewer");
  std::vector<Candidate> all;
  for (const Vec3& p : places)
    for (const std::string& model : search.models)
      for (const std::string& o : search.orientations) {
        std::vector<double> turn;
        set_field({{"orientations", &turn, ""}}, "orientations=" + o);
        if (turn.size() != 3) throw Error("mounts.orientations: " + o + " must be three angles, [yaw, pitch, roll]");
        Candidate c;
        c.mount.name = "c" + std::to_string(all.size());
        c.mount.model = model;
        for (int k = 0; k < 3; ++k) c.mount.position_m[static_cast<size_t>(k)] = std::round(p[k] * 1000) / 1000;
        c.mount.yaw_deg = turn[0], c.mount.pitch_deg = turn[1], c.mount.roll_deg = turn[2];
        const Device cost = cost_of(study, {"", {c.mount}});
        c.price = cost.price, c.mass_kg = cost.mass_kg;
        all.push_back(std::move(c));
      }
  return all;
}

}  // namespace adit
