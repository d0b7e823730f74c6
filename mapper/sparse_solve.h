// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace adit {

/// A sparse linear least-squares problem, row by row: row r is value[k] in column[k], k in [offset[r], offset[r + 1]),
/// columns rising within a row, and its right-hand side; rows carry the root of their weight.
struct SparseRows {
  int unknowns = 0;
  std::vector<int> offset = {0};  // (rows + 1)
  std::vector<int> column;
  std::vector<double> value;
  std::vector<double> right;  // (rows)

  size_t rows() const { return right.size(); }
};

struct SparseSolution {
  std::vector<double> x;         // (unknowns)
  double factor_entries = 0;     // of the Cholesky factor, and
  double factor_operations = 0;  // what it cost: where the time goes
  Eigen::MatrixXd covariance;    // (wanted x wanted) of the unknowns asked for, as the rows' weights say
};

/// x of least |A x - b|^2 by the normal equations and a supernodal Cholesky (CHOLMOD; Chen et al., TOMS 2008), on one
/// thread: the same bits every time. An unknown that no row holds is an Error.
/// @param wanted  unknowns whose covariance is told, few: each costs one solution
SparseSolution solve_least_squares(const SparseRows& problem, const std::vector<int>& wanted = {});

}  // namespace adit
