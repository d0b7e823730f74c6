// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "sensors/motion.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(Motion, IsThePathItselfForwardsBackwardsAndBeyondItsEnds) {
  Trajectory path;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const auto draw = [&](std::uint64_t j) { return normal(3, Draw::test, i, j); };
    path.stamp_s.push_back(i * 0.01 + 0.004 * uniform(3, Draw::test, i, 9));
    path.X_WB.push_back(pose_of({100 + draw(0), draw(1), draw(2)}, 0.05 * i, 0.1 * draw(3), 0.1 * draw(4)));
    if (i % 7 == 3) path.X_WB.back() = path.X_WB[i - 1];  // standing still
  }
  Motion motion(path);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double t = i < 250 ? -0.01 + i * 0.0018 : -0.05 + 0.5 * uniform(4, Draw::test, i);
    // 1e-12: two ways to write one rotation, in doubles.
    EXPECT_LT((motion.at(t).matrix() - path.at(t).matrix()).norm(), 1e-12 * 100) << t;
  }
}

}  // namespace
}  // namespace adit
