// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/graph_map.h"

#include "base/error.h"
#include "mapper/certificate.h"
#include "mapper/graph.h"
#include "mapper/graph_start.h"
#include "mapper/lifted.h"

#include <utility>
#include <vector>

namespace adit {

Fields fields(GraphMapSettings& s) {
  return {{"start",
           &s.start,
           "of the search for the optimum of a bare pose graph",
           {"best", "file", "odometric", "chordal", "lifted"}}};
}

SolvedGraph solve_graph(GraphFile file, const std::string& start, const Eigen::VectorXd& multiplier) {
  SolvedGraph solved;
  solved.id = std::move(file.id);
  solved.start = start;
  GraphSolution solution = solve(file.graph, {.max_iterations = 500});
  solved.converged = solution.converged;
  solved.iterations = solution.iterations;
  solved.chi2 = solution.chi2;
  solved.graph = std::move(file.graph);
  solved.graph.node = std::move(solution.node);
  solved.covariance = covariances(solved.graph);
  solved.certificate = certify(solved.graph, multiplier);
  return solved;
}

SolvedGraph solve_graph(const GraphFile& file, const GraphMapSettings& settings, const Progress& progress) {
  if (settings.start == "file" && !file.has_poses)
    throw Error("map.graph.start = \"file\": the file holds no poses; take odometric, chordal, lifted or best");
  std::vector<std::string> starts = {settings.start};
  if (settings.start == "best") starts = {"chordal", "lifted", "odometric"};
  if (settings.start == "best" && file.has_poses) starts.insert(starts.end() - 1, "file");
  SolvedGraph best;
  Eigen::VectorXd multiplier;
  for (size_t k = 0; k < starts.size(); ++k) {
    progress("optimising", static_cast<double>(k), static_cast<double>(starts.size()));
    GraphFile from = file;
    if (starts[k] == "chordal" || starts[k] == "lifted") from.graph.node = chordal_start(file.graph);
    if (starts[k] == "odometric") from.graph.node = odometric_start(file.graph);
    if (starts[k] == "lifted") {
      Lift lift = lifted_start(from.graph);
      from.graph.node = std::move(lift.node);
      multiplier = std::move(lift.multiplier);
    }
    SolvedGraph found = solve_graph(std::move(from), starts[k], multiplier);
    // Certified, or so near that another start is not worth its time.
    const bool done = found.certificate.certified || found.certificate.gap_bound < 1e-3 * found.certificate.objective;
    if (k == 0 || found.chi2 < best.chi2) best = std::move(found);
    if (done) break;
  }
  progress("optimising", 1, 1);
  return best;
}

}  // namespace adit
