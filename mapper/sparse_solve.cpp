// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/sparse_solve.h"

#include "base/error.h"

#include <cholmod.h>

#include <algorithm>
#include <memory>

extern "C" void openblas_set_num_threads(int);
extern "C" void omp_set_max_active_levels(int);

namespace adit {
namespace {

/// CHOLMOD's workspace; one BLAS thread, since sums in another order would give other bits. CHOLMOD's own loops ask for
/// four OpenMP threads whatever the machine has, and wake them for every supernode: they stay asleep.
class Workspace {
 public:
  Workspace() {
    openblas_set_num_threads(1);
    omp_set_max_active_levels(0);
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = true;
    common_.supernodal = CHOLMOD_SUPERNODAL;
  }
  ~Workspace() { cholmod_finish(&common_); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

}  // namespace

SparseSolution solve_least_squares(const SparseRows& problem, const std::vector<int>& wanted) {
  Workspace workspace;
  cholmod_common* common = workspace.get();
  const auto drop_sparse = [&](cholmod_sparse* p) { cholmod_free_sparse(&p, common); };
  const auto drop_dense = [&](cholmod_dense* p) { cholmod_free_dense(&p, common); };
  const auto drop_factor = [&](cholmod_factor* p) { cholmod_free_factor(&p, common); };
  // Rows of A as columns of its transpose: a view of our arrays.
  cholmod_sparse transposed{};
  transposed.nrow = static_cast<size_t>(problem.unknowns);
  transposed.ncol = problem.rows();
  transposed.nzmax = problem.value.size();
  transposed.p = const_cast<int*>(problem.offset.data());
  transposed.i = const_cast<int*>(problem.column.data());
  transposed.x = const_cast<double*>(problem.value.data());
  transposed.stype = 0;
  transposed.itype = CHOLMOD_INT;
  transposed.xtype = CHOLMOD_REAL;
  transposed.dtype = CHOLMOD_DOUBLE;
  transposed.sorted = 1;
  transposed.packed = 1;

  std::unique_ptr<cholmod_dense, decltype(drop_dense)> right(cholmod_zeros(transposed.nrow, 1, CHOLMOD_REAL, common),
                                                             drop_dense);
  auto* b = static_cast<double*>(right->x);
  for (size_t r = 0; r < problem.rows(); ++r)
    for (int k = problem.offset[r]; k < problem.offset[r + 1]; ++k)
      b[problem.column[k]] += problem.value[k] * problem.right[r];

  std::unique_ptr<cholmod_sparse, decltype(drop_sparse)> product(cholmod_aat(&transposed, nullptr, 0, 1, common),
                                                                 drop_sparse);
  ADIT_CHECK(product);
  std::unique_ptr<cholmod_sparse, decltype(drop_sparse)> normal(cholmod_copy(product.get(), 1, 1, common), drop_sparse);
  product.reset();
  ADIT_CHECK(normal);
  std::unique_ptr<cholmod_factor, decltype(drop_factor)> factor(cholmod_analyze(normal.get(), common), drop_factor);
  ADIT_CHECK(factor);
  SparseSolution solution;
  solution.factor_entries = common->lnz;
  solution.factor_operations = common->fl;
  cholmod_factorize(normal.get(), factor.get(), common);
  if (common->status != CHOLMOD_OK)
    throw Error("the measurements leave some of the " + std::to_string(problem.unknowns) +
                " unknowns open (the normal equations are singular)");
  std::unique_ptr<cholmod_dense, decltype(drop_dense)> x(cholmod_solve(CHOLMOD_A, factor.get(), right.get(), common),
                                                         drop_dense);
  ADIT_CHECK(x);
  const auto* values = static_cast<const double*>(x->x);
  solution.x.assign(values, values + problem.unknowns);

  const auto n = static_cast<Eigen::Index>(wanted.size());
  solution.covariance.resize(n, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    std::fill(b, b + problem.unknowns, 0.0);
    b[wanted[c]] = 1;
    x.reset(cholmod_solve(CHOLMOD_A, factor.get(), right.get(), common));
    ADIT_CHECK(x);
    for (Eigen::Index r = 0; r < n; ++r) solution.covariance(r, c) = static_cast<const double*>(x->x)[wanted[r]];
  }
  return solution;
}

}  // namespace adit
