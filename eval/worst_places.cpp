// SPDX-License-Identifier: BSD-3-Clause
#include "eval/worst_places.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double square_m = 2, apart_m = 10;
constexpr std::int64_t least_points = 20;
constexpr size_t most_places = 10;

}  // namespace

std::vector<PassageScore> passage_scores(const LaidPoints& laid, const Mesh& mesh, const PassageMap& passages) {
  std::vector<PassageScore> scores;
  if (passages.empty()) return scores;
  std::vector<int> of_face(mesh.face.size());
  parallel_for(
      mesh.face.size(),
      [&](size_t f) {
        const Vec3 middle = (mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3;
        of_face[f] = passages.locate(middle.head<2>()).passage;
      },
      256);
  std::vector<std::vector<double>> errors(passages.size());
  for (size_t i = 0; i < laid.face.size(); ++i)
    if (laid.face[i] >= 0) errors[of_face[laid.face[i]]].push_back(static_cast<double>(laid.error_m[i]));
  for (size_t k = 0; k < errors.size(); ++k) {
    double sum = 0, absolute = 0;
    for (double& e : errors[k]) {
      sum += e;
      e = std::abs(e);
      absolute += e;
    }
    const double n = errors[k].empty() ? none : static_cast<double>(errors[k].size());
    scores.push_back({static_cast<int>(k), static_cast<std::int64_t>(errors[k].size()), sum / n, absolute / n,
                      quantile(errors[k], 0.95)});
  }
  return scores;
}

std::vector<WorstPlace> worst_places(const LaidPoints& laid, const PassageMap& passages) {
  struct Sum {
    Vec3 foot = Vec3::Zero();
    double error = 0, absolute = 0;
    std::int64_t n = 0;
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Sum> squares;
  for (size_t i = 0; i < laid.face.size(); ++i) {
    if (laid.face[i] < 0) continue;
    const Vec3& p = laid.foot_W[i];
    Sum& s = squares[{static_cast<std::int64_t>(std::floor(p.x() / square_m)),
                      static_cast<std::int64_t>(std::floor(p.y() / square_m))}];
    s.foot += p;
    s.error += static_cast<double>(laid.error_m[i]);
    s.absolute += std::abs(static_cast<double>(laid.error_m[i]));
    ++s.n;
  }
  std::vector<WorstPlace> all, worst;
  for (const auto& [square, s] : squares) {
    if (s.n < least_points) continue;
    const double n = static_cast<double>(s.n);
    all.push_back({s.foot / n, -1, s.n, s.error / n, s.absolute / n});
  }
  std::stable_sort(all.begin(), all.end(), [](const WorstPlace& a, const WorstPlace& b) { return a.mae_m > b.mae_m; });
  for (WorstPlace& place : all) {
    if (worst.size() == most_places) break;
    const bool near = std::any_of(worst.begin(), worst.end(),
                                  [&](const WorstPlace& w) { return (w.p_W - place.p_W).norm() < apart_m; });
    if (near) continue;
    if (!passages.empty()) place.passage = passages.locate(place.p_W.head<2>()).passage;
    worst.push_back(place);
  }
  return worst;
}

}  // namespace adit
