// SPDX-License-Identifier: BSD-3-Clause
#include "base/relay.h"

#include "base/error.h"
#include "tests/support/errors.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace adit {
namespace {

using Give = std::function<void(int&&)>;

struct Relay : ::testing::TestWithParam<int> {
  void SetUp() override { set_threads(GetParam()); }
  void TearDown() override { set_threads(0); }
};

TEST_P(Relay, EachValueComesOnceInItsOrder) {
  std::vector<int> got;
  relay<int>(
      3,
      [](const Give& give) {
        for (int i = 0; i < 1000; ++i) give(int{i});
      },
      [&](int&& value) { got.push_back(value); });
  ASSERT_EQ(got.size(), 1000u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(got[i], i);
}

TEST_P(Relay, AnErrorOfTheMakerComesAfterWhatItMade) {
  std::vector<int> got;
  EXPECT_EQ(error_of([&] {
              relay<int>(
                  3,
                  [](const Give& give) {
                    for (int i = 0; i < 5; ++i) give(int{i});
                    throw Error("no more");
                  },
                  [&](int&& value) { got.push_back(value); });
            }),
            "no more");
  EXPECT_EQ(got, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST_P(Relay, AnErrorOfTheUserStopsTheMaker) {
  int made = 0;
  EXPECT_EQ(error_of([&] {
              relay<int>(
                  2,
                  [&](const Give& give) {
                    for (;;) give(made++);
                  },
                  [](int&& value) {
                    if (value == 7) throw Error("enough");
                  });
            }),
            "enough");
  EXPECT_LE(made, 7 + 2 + 2);  // those that lay waiting, and the one in hand
}

INSTANTIATE_TEST_SUITE_P(OneThreadOrMany, Relay, ::testing::Values(1, 2, 7));

}  // namespace
}  // namespace adit
