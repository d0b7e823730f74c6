// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/compare.h"
#include "eval/sight.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// A number that a study can ask for: of scores by its dotted name, "fast.NAME" of the true geometry, "price", "mass_kg".
struct StudyColumn {
  std::string name, unit;
  Better better = Better::lower;
};
/// The columns of a FastScore and its values in their order.
const std::vector<StudyColumn>& fast_columns();
std::vector<double> fast_values(const FastScore& score);

/// One way of doing it: a level of each factor.
struct StudyPoint {
  std::vector<std::string> level;  // (factors)
  double price = 0, mass_kg = 0;
  std::vector<double> fast;  // (fast_columns) NaN where it could not be had
};

/// One run of it.
struct StudyCell {
  std::string name, failure;  // empty: it has values
  size_t point = 0;
  int seed = 0;
  std::vector<double> value;  // (metric) NaN where the score lacks it
  double seconds = 0;
};

/// All that was run.
struct StudyTable {
  std::string name, about;
  std::vector<std::string> factor;
  std::vector<StudyColumn> metric;     // of the scores
  std::vector<std::string> objective;  // columns by which points are judged; the share of failures always counts
  std::vector<StudyPoint> point;
  std::vector<StudyCell> cell;
  std::vector<std::string> notes;
};

/// What the study says. Index of an objective: as in StudyTable::objective.
struct StudyAnswer {
  struct Point {
    std::vector<Spread> value;  // (objectives) over the seeds
    size_t runs = 0, failed = 0;
    bool front = false;      // no other point is as good in everything and better in something
    double front_share = 0;  // of 200 samples of the seeds in which it is
    double rank = 0;         // mean over the objectives, 1 = best
  };
  struct Level {
    std::string name;
    Spread value;
  };
  struct Effect {
    size_t factor, objective;
    std::vector<Level> level;
    double share = 0;  // of the variance within a seed that the levels account for
  };
  struct Interaction {
    size_t a, b, objective;
    double share = 0;  // of the variance that the pairs of levels account for beyond both factors' own
  };
  /// How the order by a fast number agrees with the order by a metric, over the points: Spearman's rho, +1 = fast
  /// predicts it, with a 95 % bootstrap interval over the points.
  struct Agreement {
    std::string fast, metric;
    size_t n = 0;
    double rho = 0, low = 0, high = 0;  // NaN for fewer than 4 points, or where one side has one value alone
  };
  std::vector<Point> point;
  std::optional<size_t> best, worst;  // the best by rank of the front, the worst of all; none where nothing was scored
  std::vector<Effect> effect;
  std::vector<Interaction> interaction;
  std::vector<Agreement> agreement;
  Comparison comparison;  // of the points with the first one, over the seeds, for the objectives that are metrics
};

/// Error where an objective is no column of the table.
StudyAnswer answer_of(const StudyTable& table);

/// Spearman's rank correlation, ties sharing their mean rank; NaN where one side has one value alone.
double spearman(const std::vector<double>& a, const std::vector<double>& b);

/// Points of which none is as good in everything and better in something: rows of badness, lower is better.
std::vector<bool> pareto_front(const std::vector<std::vector<double>>& badness);

/// study.json; cells.csv, one row a cell; study.sqlite with the tables cells, levels, metrics, numbers and seconds. The same
/// bytes for the same table, but for the seconds.
void write_study(const std::string& dir, const StudyTable& table, const StudyAnswer& answer);

}  // namespace adit
