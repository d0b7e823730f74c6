// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "mapper/align.h"
#include "mapper/graph_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace adit {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;

/// A pair of nodes that was matched.
struct Loop {
  int a = 0, b = 0;  // nodes, a < b
  Pose2 guess;       // with which it was matched
  double reach_m = 0;
  PlaceMatch match;
  bool agrees = false;  // with its neighbours
  bool accepted = false;

  bool usable() const { return match.found && !match.ambiguous && !match.degenerate; }
};

struct Problem {
  const Odometry& odometry;
  const RobustSettings& settings;
  Chain chain;
  std::vector<int> before;     // (scans) node at or before
  std::vector<Matrix3> carry;  // (nodes) sum of the steps' covariances, each carried into the open-loop map frame
  std::map<std::pair<int, int>, Loop> loops;

  std::vector<Pose2> node;  // as they stand
};

Pose2 open_loop(const Problem& p, int node) {
  return p.odometry.X_MB[p.chain.scan[node]];
}

/// Covariances of the chain as sums in the map frame, so that that of any stretch is a difference.
std::vector<Matrix3> carried_covariances(const Problem& p) {
  std::vector<Matrix3> carry{Matrix3::Zero()};
  for (const Relative& step : p.chain.step) {
    const Matrix3 A = adjoint(open_loop(p, step.j));
    carry.push_back(carry.back() + A * step.information.inverse() * A.transpose());
  }
  return carry;
}

/// The front end's pose of node b in node a and its covariance about frame b, either one first.
std::pair<Pose2, Matrix3> stretch(const Problem& p, int a, int b) {
  const Matrix3 A = adjoint(open_loop(p, b).inverse());
  const Matrix3 sum = p.carry[std::max(a, b)] - p.carry[std::min(a, b)];
  return {open_loop(p, a).inverse() * open_loop(p, b), A * sum * A.transpose()};
}

Matrix3 floored(const PlaceMatch& match, const RobustSettings& settings) {
  const double yaw_rad = settings.floor_deg * degree, m2 = settings.floor_m * settings.floor_m;
  // (information^-1 + floor)^-1 without inverting what may be singular in the open direction.
  const Matrix3 F = Vector3(m2, m2, yaw_rad * yaw_rad).asDiagonal();
  const Matrix3 I = match.information;
  const Matrix3 result = (Matrix3::Identity() + I * F).inverse() * I;
  return 0.5 * (result + result.transpose());
}

PoseGraph graph_of(const Problem& p, std::vector<std::pair<int, int>>* members = nullptr) {
  PoseGraph graph{p.node, p.chain.step, std::vector<double>(p.chain.step.size(), 0.0)};
  for (const auto& [key, loop] : p.loops) {
    if (!loop.accepted) continue;
    graph.edge.push_back({loop.a, loop.b, loop.match.X_ij, floored(loop.match, p.settings)});
    graph.kernel.push_back(p.settings.kernel);
    if (members) members->push_back(key);
  }
  return graph;
}

struct Candidate {
  int a, b;
  Pose2 X_ab;
  double sigma_m = 0, sigma_rad = 0;
};

/// The node that is nearest along the way.
int nearest_node(const Problem& p, int scan) {
  const int a = p.before[scan], b = std::min(a + 1, static_cast<int>(p.chain.scan.size()) - 1);
  const std::vector<double>& along = p.chain.along_m;
  return along[p.chain.scan[b]] - along[scan] < along[scan] - along[p.chain.scan[a]] ? b : a;
}

/// Pairs of nodes that meet by the criteria, within the farthest reach, and are not measured yet; and how well the path
/// knows them.
std::vector<Candidate> candidates(const Problem& p, const std::vector<Pose2>& X_MB) {
  const RobustSettings& s = p.settings;
  std::vector<int> from;
  double next_m = 0;
  for (int i : p.chain.scan)
    if (p.chain.along_m[i] >= next_m) from.push_back(i), next_m = p.chain.along_m[i] + s.closure_m;
  const EncounterCriteria criteria{s.near_m + s.reach_m, s.parallel_deg * degree, s.orthogonal_deg * degree, s.gap_m};
  std::set<std::pair<int, int>> known;
  for (const Encounter& e : find_encounters(p.chain, X_MB, from, criteria)) {
    const std::pair<int, int> pair(nearest_node(p, e.foot_scan), p.before[e.scan]);
    const auto it = p.loops.find(pair);
    if (it == p.loops.end() || !it->second.usable()) known.insert(pair);
  }
  const std::vector<std::pair<int, int>> pairs(known.begin(), known.end());
  const std::vector<Matrix3> covariance = relative_covariances(graph_of(p), pairs);
  std::vector<Candidate> result;
  for (size_t k = 0; k < pairs.size(); ++k) {
    const auto [a, b] = pairs[k];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance[k].topLeftCorner<2, 2>());
    result.push_back({a, b, p.node[a].inverse() * p.node[b], s.doubt * std::sqrt(std::max(0.0, axes.eigenvalues()[1])),
                      s.doubt * std::sqrt(std::max(0.0, covariance[k](2, 2)))});
  }
  return result;
}

/// Three standard deviations and what a settled path still leaves open.
double reach_m(const Candidate& c, const RobustSettings& s) {
  return std::min(s.reach_m, 3 * c.sigma_m + s.least_reach_m);
}

/// Worth matching: never tried; or tried in vain, or with a direction open, and the path knows better now.
bool worthwhile(const Problem& p, const Candidate& c) {
  const auto it = p.loops.find({c.a, c.b});
  if (it == p.loops.end()) return true;
  const Loop& loop = it->second;
  const double moved_m = (loop.guess.inverse() * c.X_ab).position().norm();
  return moved_m > p.settings.least_reach_m || reach_m(c, p.settings) < 0.5 * loop.reach_m;
}

/// Thins what needs a wide search to one in wide_step_m of either passage: once these are closed, the others are
/// narrow.
void thin_wide(const Problem& p, std::vector<Candidate>& fresh) {
  const RobustSettings& s = p.settings;
  const auto along_m = [&](int node) { return p.chain.along_m[p.chain.scan[node]]; };
  std::vector<Candidate> kept, wide;
  for (const Candidate& c : fresh) {
    const bool near_one = std::any_of(wide.begin(), wide.end(), [&](const Candidate& w) {
      return std::abs(along_m(w.a) - along_m(c.a)) < s.wide_step_m &&
             std::abs(along_m(w.b) - along_m(c.b)) < s.wide_step_m;
    });
    const bool is_wide = reach_m(c, s) > s.wide_m;
    if (is_wide && near_one) continue;
    if (is_wide) wide.push_back(c);
    kept.push_back(c);
  }
  fresh = kept;
}

/// What is to be matched now: only as far as the path knows where to look, to a sigma of limit_m.
std::vector<Candidate> new_candidates(const Problem& p, const std::vector<Candidate>& all, double limit_m) {
  std::vector<Candidate> result;
  for (const Candidate& c : all)
    if (c.sigma_m <= limit_m && c.X_ab.position().norm() <= p.settings.near_m + reach_m(c, p.settings) &&
        worthwhile(p, c))
      result.push_back(c);
  thin_wide(p, result);
  return result;
}

void match_new(Problem& p, const std::vector<Candidate>& fresh, const MatchPlaces& match_places) {
  std::vector<PlacePair> pairs;
  for (const Candidate& c : fresh)
    pairs.push_back({p.chain.scan[c.a], p.chain.scan[c.b], c.X_ab, reach_m(c, p.settings),
                     std::min(0.5, 3 * c.sigma_rad + 2 * degree)});
  const std::vector<PlaceMatch> match = match_places(pairs);
  ADIT_CHECK(match.size() == pairs.size());
  for (size_t k = 0; k < fresh.size(); ++k)
    p.loops[{fresh[k].a, fresh[k].b}] = {fresh[k].a, fresh[k].b, fresh[k].X_ab, pairs[k].reach_m,
                                         match[k],   false,      false};
}

/// Squared Mahalanobis length of the way round: by closure k, along the path, back by closure l, along the path.
double disagreement(const Problem& p, const Loop& k, const Loop& l) {
  const auto [X_b, C_b] = stretch(p, k.b, l.b);
  const auto [X_a, C_a] = stretch(p, l.a, k.a);
  const Pose2 X_l = l.match.X_ij.inverse();
  const auto covariance = [&](const Loop& loop) {
    return Matrix3(
        (floored(loop.match, p.settings) + 1e-6 * Matrix3::Identity()).inverse());  // an open direction: sd 1 km
  };
  // k.a -> k.b -> l.b -> l.a -> k.a; everything about the last frame.
  const Matrix3 A_rest_k = adjoint((X_b * X_l * X_a).inverse()), A_rest_b = adjoint((X_l * X_a).inverse());
  const Matrix3 A_rest_l = adjoint(X_a.inverse() * l.match.X_ij);
  const Matrix3 C = A_rest_k * covariance(k) * A_rest_k.transpose() + A_rest_b * C_b * A_rest_b.transpose() +
                    A_rest_l * covariance(l) * A_rest_l.transpose() + C_a;
  const Pose2 E = k.match.X_ij * X_b * X_l * X_a;
  const Vector3 e(E.x_m, E.y_m, E.yaw_rad);
  return e.dot(C.ldlt().solve(e));
}

/// A closure that another is held against.
struct Neighbour {
  size_t index;
  bool agrees;
};

/// Neighbours of closure k: near along both passages, the nearest of them.
std::vector<Neighbour> neighbours(const Problem& p, const std::vector<Loop*>& usable, size_t k) {
  const auto along = [&](int node) { return p.chain.along_m[p.chain.scan[node]]; };
  std::vector<std::pair<double, size_t>> near;
  for (size_t l = 0; l < usable.size(); ++l) {
    const double d = std::abs(along(usable[l]->a) - along(usable[k]->a)),
                 e = std::abs(along(usable[l]->b) - along(usable[k]->b));
    if (l != k && d <= p.settings.neighbour_m && e <= p.settings.neighbour_m) near.emplace_back(d + e, l);
  }
  std::sort(near.begin(), near.end());
  if (static_cast<int>(near.size()) > p.settings.neighbours) near.resize(p.settings.neighbours);
  std::vector<Neighbour> result;
  for (const auto& [distance_m, l] : near)
    result.push_back({l, disagreement(p, *usable[std::min(k, l)], *usable[std::max(k, l)]) < p.settings.agree_chi2});
  return result;
}

/// Keeps the closures that agree with most of their neighbours, at least one; the worst goes first and the rest is
/// judged without it.
void choose_consistent(Problem& p) {
  std::vector<Loop*> usable;
  for (auto& [key, loop] : p.loops) {
    loop.agrees = loop.usable();
    if (loop.agrees) usable.push_back(&loop);
  }
  std::vector<std::vector<Neighbour>> around(usable.size());
  parallel_for(usable.size(), [&](size_t k) { around[k] = neighbours(p, usable, k); });
  const auto share = [&](size_t k) {
    int count = 0, good = 0;
    for (const Neighbour& n : around[k])
      if (usable[n.index]->agrees) ++count, good += n.agrees;
    return count > 0 ? static_cast<double>(good) / count : 0.0;
  };
  for (bool removed = true; removed;) {
    Loop* worst = nullptr;
    double worst_share = p.settings.agree_share;
    for (size_t k = 0; k < usable.size(); ++k) {
      if (!usable[k]->agrees) continue;
      const double s = share(k);
      if (s < worst_share) worst = usable[k], worst_share = s;
    }
    removed = worst != nullptr;
    if (removed) worst->agrees = false;
  }
}

std::set<std::pair<int, int>> accepted(const Problem& p) {
  std::set<std::pair<int, int>> keys;
  for (const auto& [key, loop] : p.loops)
    if (loop.accepted) keys.insert(key);
  return keys;
}

/// Solves; takes back what the kernel silences and solves again, until all that is in has its say.
void optimise(Problem& p) {
  for (auto& [key, loop] : p.loops) loop.accepted = loop.agrees;
  for (bool dropped = true; dropped;) {
    std::vector<std::pair<int, int>> members;
    const PoseGraph graph = graph_of(p, &members);
    const GraphSolution solution = solve(graph);
    p.node = solution.node;
    dropped = false;
    for (size_t k = 0; k < members.size(); ++k) {
      if (solution.edge_weight[p.chain.step.size() + k] >= p.settings.drop_weight) continue;
      p.loops.at(members[k]).accepted = false;
      dropped = true;
    }
  }
}

AlignmentRound round_of(const Problem& p, const std::vector<Pose2>& before) {
  AlignmentRound round;
  for (const Pose2& X : before) round.nodes.push_back(X.position());
  for (const auto& [a, b] : accepted(p)) round.correspondences.emplace_back(a, b);
  return round;
}

std::vector<Closure> closures_of(const Problem& p) {
  std::vector<Closure> result;
  for (const auto& [key, loop] : p.loops)
    if (loop.match.found)
      result.push_back({p.chain.scan[loop.a], p.chain.scan[loop.b], loop.match.X_ij, true, loop.accepted,
                        loop.match.ambiguous || loop.match.degenerate});
  return result;
}

}  // namespace

Fields fields(RobustSettings& s) {
  return {
      {"node_m", &s.node_m, "way between two nodes of the path", 0.2, 50},
      {"closure_m", &s.closure_m, "way between two candidates for a closure", 0.2, 100},
      {"near_m", &s.near_m, "distance between two passages of a place, if the path were exact", 0.1, 50},
      {"reach_m", &s.reach_m, "most that the path may be thought to be out", 0.1, 100},
      {"least_reach_m", &s.least_reach_m, "that a settled path is thought to be out", 0.05, 10},
      {"wide_m", &s.wide_m, "a reach beyond this is searched for few candidates first", 0.1, 100},
      {"wide_step_m", &s.wide_step_m, "way between those", 0, 100},
      {"doubt", &s.doubt, "times the path's stated sigma is believed", 0.1, 100},
      {"parallel_deg", &s.parallel_deg, "between the directions of two passages", 1, 60},
      {"orthogonal_deg", &s.orthogonal_deg, "between the joining line and the perpendicular of either passage", 1, 60},
      {"gap_m", &s.gap_m, "least way between two passages", 1, 1000},
      {"max_rounds", &s.max_rounds, "rounds of finding and weighing closures", 1, 1000},
      {"neighbour_m", &s.neighbour_m, "way within which closures are held against each other", 1, 1000},
      {"neighbours", &s.neighbours, "closures that each is held against", 1, 1000},
      {"agree_chi2", &s.agree_chi2, "two closures agree when the way round closes within this", 0.1, 1e6},
      {"agree_share", &s.agree_share, "of the neighbours must agree", 0, 1},
      {"kernel", &s.kernel, "width of the Cauchy kernel, standard deviations", 0.1, 1e6},
      {"drop_weight", &s.drop_weight, "a closure with less weight is taken back", 0, 1},
      {"floor_m", &s.floor_m, "sigma added to the position of each match", 0, 10},
      {"floor_deg", &s.floor_deg, "sigma added to the heading of each match", 0, 90}};
}

Aligned align_robust(const Odometry& odometry, const MatchPlaces& match_places, const RobustSettings& settings,
                     const Progress& progress) {
  Problem p{odometry, settings, chain_of(odometry, settings.node_m), {}, {}, {}, {}};
  p.before = node_before(p.chain);
  p.carry = carried_covariances(p);
  for (size_t k = 0; k < p.chain.scan.size(); ++k) p.node.push_back(open_loop(p, static_cast<int>(k)));
  Aligned result;
  result.X_MB = odometry.X_MB;
  std::set<std::pair<int, int>> last;
  double limit_m = settings.least_reach_m;
  for (int n = 0; n < settings.max_rounds && !result.converged; ++n) {
    progress("closing loops", n, settings.max_rounds);
    const std::vector<Candidate> all = candidates(p, result.X_MB);
    std::vector<Candidate> fresh = new_candidates(p, all, limit_m);
    // The surest first: what they close makes the others surer.
    for (; fresh.empty() && limit_m < settings.reach_m; fresh = new_candidates(p, all, limit_m)) limit_m *= 2;
    match_new(p, fresh, match_places);
    choose_consistent(p);
    const std::vector<Pose2> before = p.node;
    optimise(p);
    result.X_MB = spread(p.chain, odometry.X_MB, p.node);
    result.rounds.push_back(round_of(p, before));
    result.converged = fresh.empty() && accepted(p) == last;
    last = accepted(p);
  }
  result.closures = closures_of(p);
  if (p.node.size() > 1) {
    result.graph = solve_graph({graph_of(p), p.chain.scan, true}, "path");
    result.covariance = spread_covariances(p.chain, result.X_MB, result.graph->covariance);
    for (size_t i = 1; i < odometry.jitter.size(); ++i)
      result.covariance[i] = result.covariance[i] / odometry.steadiness + odometry.jitter[i];
  }
  if (!result.converged) result.notes.push_back("closures were still found in the last round allowed");
  progress("closing loops", settings.max_rounds, settings.max_rounds);
  return result;
}

}  // namespace adit
