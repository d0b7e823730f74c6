// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "eval/explain.h"
#include "tests/eval/exact_case.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(Explain, EveryMetricOfAScoreIsDefined) {
  for (const Metric& m : score_of(tunnel_case()).metrics) {
    EXPECT_NO_THROW(explain_metric(m.name)) << m.name;
    EXPECT_TRUE(is_metric(m.name)) << m.name;
  }
  for (const char* none : {"p95_m", "map.p95_m", "map.se3", "map.se3.p95_mm", ""})
    EXPECT_FALSE(is_metric(none)) << none;
}

TEST(Explain, TellsDefinitionAlignmentAndWhatItsBlockHolds) {
  const std::string ate = explain_metric("trajectory.se3.ate_rmse_m");
  EXPECT_NE(ate.find("distance between estimated and true position"), std::string::npos) << ate;
  EXPECT_NE(ate.find("takes away: 6 degrees of freedom"), std::string::npos) << ate;
  const std::string iou = explain_metric("iou");
  EXPECT_NE(iou.find("volume.iou"), std::string::npos) << iou;
  EXPECT_NE(iou.find("Judged on a domain"), std::string::npos) << iou;
}

TEST(Explain, AnUnknownNameIsAnErrorThatNamesNearOnes) {
  try {
    explain_metric("volume.overshoot");
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("volume.overbreak_m3"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace adit
