// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/rig.h"
#include "base/rig_text.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

namespace adit {
namespace {

TEST(Laser, Lms200FiresAHalfDegreeScanInTwoTurnsAndTheLinkThinsIt) {
  const LaserModel m = load_laser("lms200", 38400);
  EXPECT_EQ(m.beams, 361);
  EXPECT_NEAR(m.beam_angle_rad(180), 0, 1e-12);
  EXPECT_NEAR(m.beam_offset_s(1) - m.beam_offset_s(0), 0.01332 + 0.01332 / 720,
              1e-9);  // the next turn, half a degree on
  EXPECT_NEAR(m.beam_offset_s(360), 0.00666, 1e-9);
  EXPECT_NEAR(1 / m.interval_s, 4.17, 0.01);  // SICK telegram listing: 8 of 9 scans are skipped
  EXPECT_NEAR(load_laser("lms200", 500000).interval_s, 0.02664, 1e-9);
  EXPECT_THROW(load_laser("lms200", 4800), Error);
}

TEST(Laser, AModeRasterOrRateThatTheModelLacksIsAnErrorThatListsWhatItHas) {
  const auto error_of = [](int baud, const LaserChoice& choice) -> std::string {
    try {
      load_laser("lms200", baud, choice);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of(38400, {"64m", ""}), ::testing::HasSubstr("has no mode '64m'; it has 8m, 16m, 32m, 80m"));
  EXPECT_THAT(error_of(38400, {"", "180/0.1"}), ::testing::HasSubstr("has no raster '180/0.1'; it has 180/1"));
  EXPECT_THAT(error_of(38400, {"", "180/0.25"}),
              ::testing::HasSubstr("the raster '180/0.25' has no rate of 38400 Bd; it has 500000"));
  EXPECT_EQ(error_of(38400, {"8m", "100/0.25"}), "no error");
  EXPECT_THAT(error_of(38400, {.sensitivity = "high"}), ::testing::HasSubstr("has no sensitivity 'high'; it has none"));
}

TEST(Laser, AChartMustGrowAndBePositive) {
  const std::string file = scratch("laser.toml");
  const auto refused = [&](const std::string& text) {
    write_text(file, text);
    try {
      load_laser(file, 0);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused("chart_range_m = [1.0, 2.0]\nchart_reflectivity = [0.1, 0.2]\n"));
  EXPECT_TRUE(refused("chart_range_m = [2.0, 1.0]\nchart_reflectivity = [0.1, 0.2]\n"));
  EXPECT_TRUE(refused("chart_range_m = [1.0, 2.0]\nchart_reflectivity = [0.1]\n"));
  EXPECT_TRUE(refused("chart_range_m = [1.0, 2.0]\nchart_reflectivity = [0.1, 0.0]\n"));
}

TEST(Laser, AChoiceThatIsNoTableIsAnErrorAtItsLine) {
  const std::string file = scratch("laser_choice.toml");
  for (const std::string kind : {"mode", "raster", "sensitivity"}) {
    write_text(file, "name = 'x'\n" + kind + " = '8m'\n");
    try {
      load_laser(file, 0);
      ADD_FAILURE() << kind << " was taken";
    } catch (const Error& e) {
      EXPECT_THAT(e.what(),
                  ::testing::HasSubstr("laser_choice.toml:2: '" + kind + "' must be tables, [[" + kind + "]]"));
    }
  }
}

TEST(Rig, AModeAndARasterAreChosenByTheTableOrForAll) {
  const std::string file = scratch("rig_mode.toml");
  write_text(file, "[[laser]]\nname = 'a'\nmode = '8m'\n[[laser]]\nname = 'b'\nraster = '180/1'\n");
  const Rig own = load_rig(file, 38400), all = load_rig(file, 38400, {"16m", ""});
  EXPECT_EQ(own.mounts[0].laser.range_max_m, 8.183);
  EXPECT_EQ(own.mounts[1].laser.beams, 181);
  EXPECT_EQ(all.mounts[0].laser.range_max_m, 16.375);
  EXPECT_EQ(all.mounts[1].laser.range_max_m, 16.375);
  EXPECT_EQ(all.mounts[1].laser.beams, 181);
}

TEST(Rig, ASensitivityIsChosenByTheTableOrForAll) {
  const std::string file = scratch("rig_sensitivity.toml");
  write_text(file,
             "[[laser]]\nname = 'a'\nmodel = 'lms291'\nsensitivity = 'low'\n[[laser]]\nname = 'b'\nmodel = 'lms221'\n");
  const auto least = [&](const LaserChoice& choice, size_t mount) {
    return load_rig(file, 38400, choice).mounts[mount].laser.least_reflectivity(30);
  };
  EXPECT_NEAR(least({}, 0), 1.92 * 0.106, 1e-12);
  EXPECT_NEAR(least({}, 1), 0.106, 1e-12);
  EXPECT_NEAR(least({.sensitivity = "high"}, 0), 0.488 * 0.106, 1e-12);
  EXPECT_NEAR(least({.sensitivity = "high"}, 1), 0.488 * 0.106, 1e-12);
  EXPECT_EQ(to_toml(read_rig(file)).find("sensitivity = \"low\"") != std::string::npos, true);
}

TEST(Rig, Cart4HasOneLaserForEachView) {
  const Rig rig = load_rig("cart4", 38400);
  for (View v : {View::horizontal, View::forward_vertical, View::up, View::down}) EXPECT_GE(find_view(rig, v), 0);
}

TEST(Rig, ABadRigIsAnsweredWithFileLineAndKey) {
  const std::string file = scratch("rig.toml");
  const auto error_of = [&](const std::string& text) -> std::string {
    write_text(file, text);
    try {
      load_rig(file, 0);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("[[laser]]\nname = 'a'\npitch_degs = 3\n"),
              ::testing::HasSubstr("rig.toml:3: unknown key 'pitch_degs' (did you mean 'pitch_deg'?)"));
  EXPECT_THAT(error_of("[[laser]]\nname='a'\nmodel='lms99'\n"), ::testing::HasSubstr("lms99"));
  EXPECT_THAT(error_of("name='x'\n"), ::testing::HasSubstr("no [[laser]]"));
  EXPECT_THAT(error_of("[[laser]]\nname='a'\n[[laser]]\nname='a'\n"), ::testing::HasSubstr("a second time"));
  EXPECT_THAT(error_of("[[laser]]\nname='a'\nposition_m=[1, 2]\n"), ::testing::HasSubstr("three numbers"));
}

TEST(RigText, ChangesSetAddAndTakeOutLasersInTheirOrder) {
  RigText rig = read_rig("cart4");
  change_rig(rig, {"down off", "up pitch_deg=-80 z_m=0.9", "rear model=lms291 position_m=[-0.6, 0.0, 1.1] yaw_deg=180",
                   "rear yaw_deg=170"});
  ASSERT_EQ(rig.lasers.size(), 4u);
  EXPECT_EQ(rig.lasers[2].pitch_deg, -80);
  EXPECT_EQ(rig.lasers[2].position_m, (std::vector<double>{0, 0, 0.9}));
  EXPECT_EQ(rig.lasers[3].model, "lms291");
  EXPECT_EQ(rig.lasers[3].yaw_deg, 170);
  EXPECT_NEAR(rig_of(rig, 0).mounts[3].X_BS.translation().x(), -0.6, 1e-12);
}

TEST(RigText, WhatIsWrittenIsReadAgain) {
  for (const char* name : {"cart4", "groundhog2", "groundhog_tilt"}) {
    const std::string file = scratch("rig_again.toml"), once = to_toml(read_rig(name));
    write_text(file, once);
    EXPECT_EQ(to_toml(read_rig(file)), once);
  }
}

TEST(RigText, AChangeThatCannotBeIsQuotedWithItsCause) {
  const auto said = [](const std::string& change) -> std::string {
    RigText rig = read_rig("cart4");
    try {
      change_rig(rig, {change});
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(said("up"), ::testing::HasSubstr("sensors.mounts: \"up\": must be \"LASER key=value"));
  EXPECT_THAT(said("upp off"), ::testing::HasSubstr("the rig 'cart4' has no laser 'upp'"));
  EXPECT_THAT(said("up pich_deg=3"), ::testing::HasSubstr("did you mean 'pitch_deg'?"));
  EXPECT_THAT(said("up name=down"), ::testing::HasSubstr("another name"));
  EXPECT_THAT(said("up tilt_deg=[10, -10]"), ::testing::HasSubstr("'tilt_deg' must be"));
  RigText rig = read_rig("cart4");
  change_rig(rig, {"front off", "profile off", "up off", "down off"});
  EXPECT_THROW(rig_of(rig, 0), Error);
}

}  // namespace
}  // namespace adit
