// SPDX-License-Identifier: BSD-3-Clause
// What the page says in words and numbers.
#include "eval/page.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

const Metric* had(const Score& score, const std::string& name) {
  const Metric* m = score.find(name);
  return m && std::isfinite(m->value) ? m : nullptr;
}

// A length that bounds a number: "95 % below 6.1 cm".
std::string bound_words(const Score& score, const std::string& before, const std::string& name) {
  const Metric* m = had(score, name);
  return m ? before + plain_number(100 * m->value, 2) + " cm" : "";
}

KeyNumber number_of(const Score& score, const std::string& label, const std::string& name, const std::string& unit,
                    double factor, const std::string& of_what, bool sign = false, const std::string& bound = "") {
  const Metric* m = score.find(name);
  if (!m) return {label, "–", "", "not scored"};
  if (!std::isfinite(m->value)) return {label, "–", "", m->why.empty() ? "could not be had" : m->why};
  const std::string plus = sign && m->value > 0 ? "+" : "";
  std::string note = m->n > 1 && !of_what.empty() ? "over " + std::to_string(m->n) + " " + of_what : "";
  if (!bound.empty()) note = bound + (note.empty() ? "" : ", " + note);
  return {label, plus + plain_number(factor * m->value), unit, note};
}

// The two shares whose harmonic mean f is.
std::string agreement_words(const Score& score) {
  const Metric *precision = had(score, "map.se3.precision_10cm"), *recall = had(score, "map.se3.recall_10cm");
  if (!precision || !recall) return "";
  return plain_number(100 * precision->value) + " % of the map, " + plain_number(100 * recall->value) +
         " % of the rock";
}

KeyNumber loops_of(const Score& score) {
  const Metric *closed = had(score, "closures.loops_closed"), *all = had(score, "closures.loops_true"),
               *wrong = had(score, "closures.wrong");
  if (!closed || !all) return {"loops closed", "–", "", "not scored"};
  const std::string note =
      wrong ? (wrong->value == 0 ? "no wrong closure" : plain_number(wrong->value) + " wrong closures") : "";
  return {"loops closed", plain_number(closed->value), "of " + plain_number(all->value), note};
}

KeyNumber worst_of(const Score& score) {
  if (score.worst.empty()) return {"worst place", "–", "", "no errors to rank"};
  const WorstPlace& w = score.worst.front();
  return {"worst place", plain_number(100 * w.mae_m, 2), "cm",
          "mean error at (" + plain_number(w.p_W.x(), 3) + ", " + plain_number(w.p_W.y(), 3) + ") m, mark 1"};
}

std::string length_words(double m) {
  return m >= 1000 ? plain_number(m / 1000, 3) + " km" : plain_number(m, 3) + " m";
}
std::string small_length(double m) {
  return std::abs(m) < 1 ? plain_number(100 * m, 2) + " cm" : plain_number(m, 3) + " m";
}

std::string mapped_words(const ReportInput& in) {
  const Trajectory& path = in.truth.drive.path;
  std::string words = in.name.empty() ? "The mine" : in.name;
  if (path.size() < 2) return words + ": nothing was driven";
  const double minutes = (path.stamp_s.back() - path.stamp_s.front()) / 60;
  return words + ": " + length_words(path.length_m()) + " driven in " + plain_number(minutes, 2) + " min";
}

KeyNumber volume_of(const Score& score) {
  KeyNumber k = number_of(score, "volume error", "volume.error_percent", "%", 1, "", true);
  if (const Metric* seen = had(score, "volume.observable_m3"); seen && k.note.empty())
    k.note = "of " + plain_number(seen->value, 4) + " m³ that could be seen";
  if (const Metric* sigma = had(score, "volume.sigma_percent"))
    k.note += (k.note.empty() ? "" : "; ") + std::string("by the map itself ± ") +
              plain_number(1.96 * sigma->value, 2) + " % (95 %)";
  return k;
}

}  // namespace

std::vector<KeyNumber> key_numbers(const ReportInput& in) {
  const Score& s = in.score;
  return {number_of(s, "path error, rms in plan", "trajectory.se3.ate_xy_rmse_m", "cm", 100, "poses", false,
                    bound_words(s, "in space at most ", "trajectory.se3.ate_max_m")),
          number_of(s, "map to rock, mean distance", "map.se3.mae_m", "cm", 100, "points", false,
                    bound_words(s, "95 % below ", "map.se3.p95_m")),
          number_of(s, "map and rock agree to 10 cm", "map.se3.f_10cm", "%", 100, "", false, agreement_words(s)),
          volume_of(s),
          loops_of(s),
          worst_of(s)};
}

std::string verdict(const ReportInput& in) {
  std::string words = mapped_words(in);
  std::vector<std::string> parts;
  if (const Metric* mae = had(in.score, "map.se3.mae_m"))
    parts.push_back("the map lies " + small_length(mae->value) + " from the true rock on average");
  else if (const Metric* ate = had(in.score, "trajectory.se3.ate_xy_rmse_m"))
    parts.push_back("the path is off by " + small_length(ate->value) + " rms in plan");
  const Metric *closed = had(in.score, "closures.loops_closed"), *loops = had(in.score, "closures.loops_true");
  if (closed && loops && loops->value > 0)
    parts.push_back(
        closed->value >= loops->value
            ? (loops->value == 1 ? "its loop is closed" : "all " + plain_number(loops->value) + " loops are closed")
            : plain_number(closed->value) + " of " + plain_number(loops->value) + " loops are closed");
  if (const Metric* wrong = had(in.score, "closures.wrong"); wrong && wrong->value > 0)
    parts.push_back(plain_number(wrong->value) + " closures are wrong");
  if (const Metric* volume = had(in.score, "volume.error_percent"))
    parts.push_back("its volume is " + plain_number(std::abs(volume->value), 2) + " % too " +
                    (volume->value < 0 ? "small" : "large"));
  if (parts.empty()) parts.push_back(in.estimate.path.empty() ? "no map was made" : "the map was not scored");
  for (size_t k = 0; k < parts.size(); ++k)
    words += (k == 0 ? "; " : k + 1 == parts.size() ? ", and " : ", ") + parts[k];
  words += ".";
  if (in.truth.drive.end != DriveEnd::finished) words += " The drive ended early: " + in.truth.drive.cause + ".";
  if (!in.score.worst.empty())
    words += " It is worst at mark 1, off by " + small_length(in.score.worst.front().mae_m) + ".";
  return words;
}

}  // namespace adit
