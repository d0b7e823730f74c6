// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sensors/faults.h"
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

using ::testing::HasSubstr;

// A laser that drives down a tunnel at 1 m/s, 37.5 scans a second for 10 s, stamps exact.
Recording with(const std::vector<std::string>& faults) {
  const World tunnel = tunnel_world(40, 4, 2);
  const Drive drive = drive_of(10, [](double t) { return pose_of({10 + t, 0, 0}, 0); });
  SensorSettings s = exact();
  s.faults = faults;
  return record(tunnel, drive, one_laser("ideal", pose_of({0, 0, 1}, 0)), {}, s, 1);
}

TEST(Faults, ADeadLaserSaysNothingAndLivesAgainAfterwards) {
  const Recording all = with({}), some = with({"laser dies from_s=2 to_s=5"});
  std::vector<double> expected;
  for (double t : all.log.scans[0].stamp_s)
    if (t < 2 || t >= 5) expected.push_back(t);
  EXPECT_EQ(some.log.scans[0].stamp_s, expected);
  EXPECT_EQ(some.truth.scans[0].stamp_s, expected);
  EXPECT_EQ(some.log.scans[0].range_m.size(), expected.size() * 361);
}

TEST(Faults, AFrozenLaserRepeatsItsLastScanAndTheTruthGoesOn) {
  const Recording r = with({"laser freezes from_s=2 to_s=5"});
  const Scans& scans = r.log.scans[0];
  const ScanTruth& truth = r.truth.scans[0];
  size_t last = 0;
  for (size_t n = 0; n < scans.size(); ++n) {
    const bool frozen = truth.stamp_s[n] >= 2 && truth.stamp_s[n] < 5;
    if (!frozen) last = n;
    for (size_t k = 0; k < 361; ++k) {
      EXPECT_EQ(truth.fault[n * 361 + k], frozen ? trouble::frozen : 0);
      EXPECT_EQ(scans[n][k], scans[last][k]);
    }
    EXPECT_NEAR(truth.range_m[n * 361 + 180], 30 - truth.stamp_s[n] - 0.02, 0.02) << n;  // to the tunnel's end
  }
}

TEST(Faults, ASlippedMountLooksElsewhereForGood) {
  const Recording r = with({"laser slips from_s=5 yaw_deg=1"});
  const ScanTruth& truth = r.truth.scans[0];
  for (size_t n = 0; n < truth.stamp_s.size(); ++n) {
    const bool slipped = truth.stamp_s[n] >= 5;
    // Beam 300 looks 60 deg to the left at a rib 2 m away; after the slip 61 deg.
    const double a = (60 + (slipped ? 1 : 0)) * M_PI / 180;
    EXPECT_NEAR(truth.range_m[n * 361 + 300], 2 / std::sin(a), 1e-5) << n;
    EXPECT_EQ(truth.fault[n * 361 + 300], slipped ? trouble::slipped : 0);
  }
  EXPECT_EQ(r.truth.rig.mounts[0].X_BS.matrix(), r.log.rig.mounts[0].X_BS.matrix());  // as it was at the begin
}

TEST(Faults, LostScansAreMissingInTheirShare) {
  const double all = static_cast<double>(with({}).log.scans[0].size());
  const double left = static_cast<double>(with({"laser loses from_s=0 share=0.3"}).log.scans[0].size());
  EXPECT_NEAR(left / all, 0.7, 5 * std::sqrt(0.3 * 0.7 / all));
}

TEST(Faults, AClockThatDriftsAndLagsErrsByJustThat) {
  const Recording r = with({"laser drifts from_s=2 ppm=200", "laser lags from_s=4 lag_s=0.03"});
  for (size_t n = 0; n < r.log.scans[0].size(); ++n) {
    const double t = r.truth.scans[0].stamp_s[n];
    const double late = (t >= 2 ? 200e-6 * (t - 2) : 0) + (t >= 4 ? 0.03 : 0);
    EXPECT_NEAR(r.log.scans[0].stamp_s[n] - t, late, 1e-12);
    EXPECT_EQ(r.truth.scans[0].fault[n * 361], t >= 2 ? trouble::clock : 0);
  }
}

TEST(Faults, NoFaultIsTheSameRecordingBitForBit) {
  const Recording a = with({}), b = with({"laser dies from_s=100"});
  EXPECT_EQ(a.log.scans[0].range_m, b.log.scans[0].range_m);
  EXPECT_EQ(a.log.scans[0].stamp_s, b.log.scans[0].stamp_s);
}

TEST(Faults, BadWordsAreAnsweredByWhatWouldBeRight) {
  const auto error_of = [](const std::string& fault) -> std::string {
    try {
      with({fault});
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("front dies"), HasSubstr("no laser 'front'; it has laser"));
  EXPECT_THAT(error_of("laser sleeps"), HasSubstr("'sleeps' is no fault; there are dies, drifts"));
  EXPECT_THAT(error_of("laser slips to_s=4"), HasSubstr("'to_s' does not belong here; there are from_s, pitch_deg"));
  EXPECT_THAT(error_of("laser loses share=2"), HasSubstr("'share=2' must be a number from 0"));
  EXPECT_THAT(error_of("laser dies from_s=4 to_s=3"), HasSubstr("to_s must be greater"));
  EXPECT_THAT(error_of("laser dies from_s=100 to_s=x"), HasSubstr("to_s=x"));
  EXPECT_THAT(error_of("laser dies"), HasSubstr("no scan"));
}

}  // namespace
}  // namespace adit
