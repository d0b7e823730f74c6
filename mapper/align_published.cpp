// SPDX-License-Identifier: BSD-3-Clause
// Thrun et al., "A System for Volumetric Robotic Mapping of Abandoned Mines", ICRA 2003, section III-B; numbers in
// brackets are its equations. Our turn is counter-clockwise where the paper's is clockwise.
#include "base/error.h"
#include "mapper/align.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

namespace adit {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double degree = std::numbers::pi / 180;

Vector3 vector_of(const Pose2& X) {
  return {X.x_m, X.y_m, X.yaw_rad};
}

Matrix3 turn(double yaw_rad) {
  Matrix3 T = Matrix3::Identity();
  T.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
  return T;
}

/// A node and a point of the earlier path, between the nodes t and t + 1, that are taken for the same place.
struct Correspondence {
  int s = 0, t = 0;
  double share = 0;      // of node t + 1 in the point, 0..1
  Pose2 X_foot_in_scan;  // the foot lies off its nearest scan by a part of a step
  double direction_rad = 0;
  bool opposite = false;
  int scan = 0, foot_scan = 0;

  /// What makes it the same correspondence in another round.
  std::tuple<int, int, bool> key() const { return {s, share < 0.5 ? t : t + 1, opposite}; }
};

std::vector<Correspondence> correspondences(const Chain& chain, const std::vector<Pose2>& X_MB,
                                            const std::vector<int>& before, const PublishedSettings& settings) {
  const EncounterCriteria criteria{settings.near_m, settings.parallel_deg * degree, settings.orthogonal_deg * degree,
                                   settings.gap_m};
  const std::vector<double> direction_rad = directions(chain, X_MB);
  std::vector<Correspondence> result;
  for (const Encounter& e : find_encounters(chain, X_MB, chain.scan, criteria)) {
    Correspondence c;
    c.scan = e.scan, c.foot_scan = e.foot_scan, c.opposite = e.opposite;
    c.s = before[e.scan];
    c.t = std::min(before[e.foot_scan], static_cast<int>(chain.scan.size()) - 2);
    const double from_m = chain.along_m[chain.scan[c.t]], to_m = chain.along_m[chain.scan[c.t + 1]];
    c.share = to_m > from_m ? std::clamp((chain.along_m[e.foot_scan] - from_m) / (to_m - from_m), 0.0, 1.0) : 0;
    const int i = static_cast<int>(e.foot);
    const Pose2 X_foot = e.foot > i ? blend(X_MB[i], X_MB[i + 1], e.foot - i) : X_MB[i];
    c.X_foot_in_scan = X_MB[e.foot_scan].inverse() * X_foot;
    c.direction_rad = direction_rad[e.scan];
    result.push_back(c);
  }
  return result;
}

/// The stacked quadratic cost [9], as the normal equations of the changes of the node poses; node 0 is fixed.
class Stack {
 public:
  explicit Stack(int nodes) : n_(3 * (nodes - 1)), b_(Eigen::VectorXd::Zero(n_)) {
    for (int d = 0; d < n_; ++d) entries_.emplace_back(d, d, 0.0);
  }
  struct Term {
    int node;
    Matrix3 J;
  };
  /// Adds || r + sum J_k dxi_k ||^2 under W.
  void add(const Vector3& r, const std::vector<Term>& terms, const Matrix3& W) {
    for (const Term& a : terms) {
      if (a.node == 0) continue;
      b_.segment<3>(3 * (a.node - 1)) -= a.J.transpose() * (W * r);
      for (const Term& c : terms)
        if (c.node != 0) add_block(a.node - 1, c.node - 1, a.J.transpose() * W * c.J);
    }
  }
  /// The changes that minimise the cost [10].
  Eigen::VectorXd solve() const {
    Sparse A(n_, n_);
    A.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Sparse> factor(A);
    ADIT_CHECK(factor.info() == Eigen::Success);  // the chain alone makes A positive definite
    return factor.solve(b_);
  }

 private:
  void add_block(int row_node, int column_node, const Matrix3& block) {
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r)
        if (3 * row_node + r >= 3 * column_node + c)
          entries_.emplace_back(3 * row_node + r, 3 * column_node + c, block(r, c));
  }
  int n_;
  Eigen::VectorXd b_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// A move of the pose `of` when the frame that it is rigidly fixed to, now at `with`, moves by dxi.
Matrix3 carried(const Pose2& of, const Pose2& with) {
  Matrix3 G = Matrix3::Identity();
  G(0, 2) = -(of.y_m - with.y_m);
  G(1, 2) = of.x_m - with.x_m;
  return G;
}

/// The penalty of bending the path [7]: xi_t - f(xi_{t-1}, delta_t), linearised [5, 6]. F is `carried`.
void add_motion(Stack& stack, const Relative& step, const std::vector<Pose2>& node, const PublishedSettings& settings) {
  const Pose2 f = node[step.i] * step.X_ij;
  Vector3 r = vector_of(node[step.j]) - vector_of(f);
  r.z() = wrap_angle(r.z());
  Matrix3 H = step.information;
  if (settings.penalty == "fixed") {
    const double yaw_rad = settings.bend_deg * degree;
    H = Vector3(1 / (settings.bend_m * settings.bend_m), 1 / (settings.bend_m * settings.bend_m),
                1 / (yaw_rad * yaw_rad))
            .asDiagonal();
  }
  const Matrix3 T = turn(f.yaw_rad);  // the information is about the later node's frame, the residual is in M
  stack.add(r, {{step.j, Matrix3::Identity()}, {step.i, -carried(f, node[step.i])}}, T * H * T.transpose());
}

/// The penalty of a correspondence [8]: xi_s - xi_foot - d, d = (0, 0, 0 or pi, whole turns).
void add_correspondence(Stack& stack, const Correspondence& c, const Chain& chain, const std::vector<Pose2>& open_loop,
                        const std::vector<Pose2>& node, const PublishedSettings& settings) {
  const Pose2 local_t = open_loop[chain.scan[c.t]].inverse() * open_loop[c.foot_scan];
  const Pose2 local_u = open_loop[chain.scan[c.t + 1]].inverse() * open_loop[c.foot_scan];
  const Pose2 foot = blend(node[c.t] * local_t, node[c.t + 1] * local_u, c.share) * c.X_foot_in_scan;
  Vector3 r = vector_of(node[c.s]) - vector_of(foot);
  r.z() = wrap_angle(r.z() - (c.opposite ? std::numbers::pi : 0));
  const double yaw_rad = settings.sigma_yaw_deg * degree;
  const Vector3 z(1 / std::pow(settings.sigma_along_m, 2), 1 / std::pow(settings.sigma_across_m, 2),
                  1 / (yaw_rad * yaw_rad));
  const Matrix3 T = turn(c.direction_rad);
  stack.add(r,
            {{c.s, Matrix3::Identity()},
             {c.t, -(1 - c.share) * carried(foot, node[c.t])},
             {c.t + 1, -c.share * carried(foot, node[c.t + 1])}},
            T * z.asDiagonal() * T.transpose());
}

void move_nodes(const Eigen::VectorXd& change, std::vector<Pose2>& node) {
  for (size_t k = 1; k < node.size(); ++k) {
    const Vector3 d = change.segment<3>(3 * (k - 1));
    node[k] = {node[k].x_m + d.x(), node[k].y_m + d.y(), wrap_angle(node[k].yaw_rad + d.z())};
  }
}

std::vector<Closure> closures_of(const std::vector<Correspondence>& pairs) {
  std::vector<Closure> result;
  for (const Correspondence& c : pairs)
    result.push_back({c.foot_scan, c.scan, {0, 0, c.opposite ? std::numbers::pi : 0}, false, true, false});
  return result;
}

AlignmentRound round_of(const std::vector<Pose2>& node, const std::vector<Correspondence>& pairs) {
  AlignmentRound round;
  for (const Pose2& X : node) round.nodes.push_back(X.position());
  for (const Correspondence& c : pairs) round.correspondences.emplace_back(std::get<1>(c.key()), c.s);
  return round;
}

}  // namespace

Fields fields(PublishedSettings& s) {
  return {
      {"node_m", &s.node_m, "way between two nodes of the path", 0.2, 50},
      {"near_m", &s.near_m, "a place is the same within this distance", 0.1, 50},
      {"parallel_deg", &s.parallel_deg, "between the directions of two passages", 1, 60},
      {"orthogonal_deg", &s.orthogonal_deg, "between the joining line and the perpendicular of either passage", 1, 60},
      {"gap_m", &s.gap_m, "least way between two passages", 1, 1000},
      {"max_rounds", &s.max_rounds, "rounds of choosing correspondences", 1, 1000},
      {"relinearisations", &s.relinearisations, "solutions of the linear system per round", 1, 100},
      {"sigma_along_m", &s.sigma_along_m, "of a correspondence, along the way", 1e-3, 1e6},
      {"sigma_across_m", &s.sigma_across_m, "of a correspondence, across the way", 1e-3, 1e6},
      {"sigma_yaw_deg", &s.sigma_yaw_deg, "of a correspondence, in heading", 1e-3, 1e6},
      {"penalty",
       &s.penalty,
       "of bending the path: the scan matcher's information, or a fixed diagonal",
       {"matched", "fixed"}},
      {"bend_m", &s.bend_m, "fixed penalty: sigma of the position from node to node", 1e-5, 10},
      {"bend_deg", &s.bend_deg, "fixed penalty: sigma of the heading from node to node", 1e-5, 90}};
}

Aligned align_published(const Odometry& odometry, const PublishedSettings& settings, const Progress& progress) {
  const Chain chain = chain_of(odometry, settings.node_m);
  const std::vector<int> before = node_before(chain);
  std::vector<Pose2> node;
  for (int i : chain.scan) node.push_back(odometry.X_MB[i]);
  Aligned result;
  result.X_MB = odometry.X_MB;
  std::set<std::set<std::tuple<int, int, bool>>> seen;
  std::set<std::tuple<int, int, bool>> last;
  for (int n = 0; node.size() > 1; ++n) {
    progress("aligning the path", n, settings.max_rounds);
    const std::vector<Correspondence> pairs = correspondences(chain, result.X_MB, before, settings);
    std::set<std::tuple<int, int, bool>> keys;
    for (const Correspondence& c : pairs) keys.insert(c.key());
    result.closures = closures_of(pairs);
    result.converged = n > 0 && keys == last;
    if (result.converged) break;
    if (n == settings.max_rounds || !seen.insert(keys).second) {
      result.notes.push_back(n == settings.max_rounds
                                 ? "the correspondences still changed after the last round allowed"
                                 : "the correspondences came back to an earlier set and went round in a circle");
      break;
    }
    last = keys;
    result.rounds.push_back(round_of(node, pairs));
    for (int k = 0; k < settings.relinearisations; ++k) {
      Stack stack(static_cast<int>(node.size()));
      for (const Relative& step : chain.step) add_motion(stack, step, node, settings);
      for (const Correspondence& c : pairs) add_correspondence(stack, c, chain, odometry.X_MB, node, settings);
      move_nodes(stack.solve(), node);
    }
    result.X_MB = spread(chain, odometry.X_MB, node);
  }
  if (node.size() < 2) result.converged = true;
  progress("aligning the path", settings.max_rounds, settings.max_rounds);
  return result;
}

}  // namespace adit
