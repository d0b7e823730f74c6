// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace adit {
namespace {

class Parallel : public ::testing::Test {
 protected:
  void TearDown() override { set_threads(0); }
};

TEST_F(Parallel, SevenThreadsReallyWorkAtOnce) {
  set_threads(7);
  std::atomic<int> waiting{0};
  // Each waits until seven are in, so that the test ends only if seven really run; bounded, so that it fails otherwise.
  parallel_for(7, [&](size_t) {
    ++waiting;
    for (long spin = 0; waiting < 7 && spin < 2000000000L; ++spin) {
    }
  });
  EXPECT_EQ(threads_seen(), 7);
}

TEST_F(Parallel, ASumHasTheSameBitsOnAnyNumberOfThreads) {
  const auto f = [](size_t i) { return std::sin(static_cast<double>(i)) * 1e3; };
  set_threads(1);
  const double one = parallel_sum(200000, f, 1000);
  for (int n : {2, 7}) {
    set_threads(n);
    for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(parallel_sum(200000, f, 1000), one) << n << " threads";
  }
}

TEST_F(Parallel, EverySlotIsVisitedOnceAndAnExceptionComesThrough) {
  set_threads(2);
  std::vector<int> visits(1001, 0);
  parallel_for(
      visits.size(), [&](size_t i) { ++visits[i]; }, 10);
  for (int v : visits) ASSERT_EQ(v, 1);
  EXPECT_THROW(parallel_for(10,
                            [](size_t i) {
                              if (i == 3) throw std::runtime_error("three");
                            }),
               std::runtime_error);
}

TEST_F(Parallel, AThreadThatWaitsForAnInnerLoopDoesNotBeginAnotherTurnOfTheOuterOne) {
  set_threads(4);
  std::atomic<bool> nested{false};
  parallel_for(64, [&](size_t) {
    thread_local int turns = 0;  // of the outer loop that this thread is in
    if (++turns > 1) nested = true;
    std::atomic<int> done{0};
    parallel_for(100, [&](size_t) { ++done; });
    EXPECT_EQ(done, 100);
    --turns;
  });
  set_threads(0);
  EXPECT_FALSE(nested);
}

}  // namespace
}  // namespace adit
