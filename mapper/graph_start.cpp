// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/graph_start.h"

#include "base/error.h"
#include "mapper/isotropic.h"

#include <Eigen/SparseCholesky>

#include <cmath>
#include <complex>
#include <cstdlib>
#include <deque>

namespace adit {
namespace {

using Complex = std::complex<double>;
using Sparse = Eigen::SparseMatrix<Complex>;
using Vector = Eigen::VectorXcd;

/// One equation weight |x_j - factor x_i - offset|^2.
struct Link {
  int i, j;
  double weight;
  Complex factor, offset;
};

/// The x that minimise the sum, x_0 given.
Vector solve_links(const std::vector<Link>& links, int nodes, Complex x_0) {
  std::vector<Eigen::Triplet<Complex>> entries;
  Vector b = Vector::Zero(nodes - 1);
  for (const Link& l : links) {
    if (l.j > 0) entries.emplace_back(l.j - 1, l.j - 1, l.weight), b[l.j - 1] += l.weight * l.offset;
    if (l.i > 0) {
      entries.emplace_back(l.i - 1, l.i - 1, l.weight * std::norm(l.factor));
      b[l.i - 1] -= l.weight * std::conj(l.factor) * l.offset;
    }
    if (l.i > 0 && l.j > 0) {  // the lower triangle
      const Complex h_ji = -l.weight * l.factor;
      if (l.j > l.i)
        entries.emplace_back(l.j - 1, l.i - 1, h_ji);
      else
        entries.emplace_back(l.i - 1, l.j - 1, std::conj(h_ji));
    }
    if (l.i == 0 && l.j > 0) b[l.j - 1] += l.weight * l.factor * x_0;
    if (l.j == 0 && l.i > 0) b[l.i - 1] += l.weight * std::conj(l.factor) * x_0;
  }
  Sparse A(nodes - 1, nodes - 1);
  A.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Sparse> factor(A);
  ADIT_CHECK(factor.info() == Eigen::Success);  // a graph in one part
  Vector x(nodes);
  x << x_0, factor.solve(b);
  return x;
}

}  // namespace

std::vector<Pose2> odometric_start(const PoseGraph& graph) {
  std::vector<std::vector<size_t>> at(graph.node.size());  // edges of each node
  for (size_t k = 0; k < graph.edge.size(); ++k) at[graph.edge[k].i].push_back(k), at[graph.edge[k].j].push_back(k);
  std::vector<Pose2> pose = graph.node;
  std::vector<bool> known(graph.node.size(), false);
  // A neighbour in the numbering is taken at once, any other when nothing else is left.
  struct Step {
    size_t edge;
    int from;
  };
  std::deque<Step> open;
  const auto reach = [&](int n) {
    known[n] = true;
    for (const size_t k : at[n]) {
      const int other = graph.edge[k].i == n ? graph.edge[k].j : graph.edge[k].i;
      if (known[other]) continue;
      if (std::abs(other - n) == 1)
        open.push_front({k, n});
      else
        open.push_back({k, n});
    }
  };
  reach(0);
  while (!open.empty()) {
    const auto [k, from] = open.front();
    open.pop_front();
    const Relative& e = graph.edge[k];
    const int to = e.i == from ? e.j : e.i;
    if (known[to]) continue;
    pose[to] = pose[from] * (e.i == from ? e.X_ij : e.X_ij.inverse());
    reach(to);
  }
  return pose;
}

std::vector<Pose2> chordal_start(const PoseGraph& graph) {
  const int n = static_cast<int>(graph.node.size());
  std::vector<Pose2> pose = graph.node;
  if (n < 2) return pose;
  std::vector<Link> turns, ways;
  for (const Relative& e : graph.edge)
    turns.push_back({e.i, e.j, isotropic_weight(e).kappa, std::polar(1.0, e.X_ij.yaw_rad), 0});
  Vector z = solve_links(turns, n, std::polar(1.0, graph.node[0].yaw_rad));
  for (int k = 0; k < n; ++k) z[k] = std::abs(z[k]) > 0 ? z[k] / std::abs(z[k]) : Complex(1);
  for (const Relative& e : graph.edge)
    ways.push_back({e.i, e.j, isotropic_weight(e).tau, 1, z[e.i] * Complex(e.X_ij.x_m, e.X_ij.y_m)});
  const Vector t = solve_links(ways, n, Complex(graph.node[0].x_m, graph.node[0].y_m));
  for (int k = 1; k < n; ++k) pose[k] = {t[k].real(), t[k].imag(), std::arg(z[k])};
  return pose;
}

}  // namespace adit
