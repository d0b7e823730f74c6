// SPDX-License-Identifier: BSD-3-Clause
// Readers that others wrote see in our files what we wrote. Each test asks for its tool and is skipped without it.
#include "base/carmen.h"
#include "base/files.h"
#include "base/recording.h"
#include "base/rng.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>

namespace adit {
namespace {

using ::testing::HasSubstr;

Log a_log(int scans) {
  Log log{{.name = "one", .mounts = {{.name = "front", .laser = load_laser("lms200", 38400)}}}, {}};
  log.rig.mounts[0].X_BS = pose_of({0.5, 0, 0.7}, 0);
  Scans s;
  s.beams = 361;
  for (int i = 0; i < scans; ++i) {
    s.stamp_s.push_back(0.1 + 0.24 * i);
    for (int k = 0; k < 361; ++k) {
      const double u = uniform(5, Draw::test, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(k));
      s.range_m.push_back(u < 0.05 ? INFINITY : static_cast<float>(std::round(u * 8000) * 1e-3));
    }
  }
  log.scans.push_back(s);
  return log;
}

// Millimetres of all ranges, and how many beams have none.
struct Sums {
  long long mm = 0;
  int none = 0;
};

Sums sums_of(const Log& log) {
  Sums sums;
  for (const float r : log.scans[0].range_m)
    std::isfinite(r) ? sums.mm += std::llround(static_cast<double>(r) * 1000) : ++sums.none;
  return sums;
}

TEST(Peers, H5pyReadsTheSameRangesFromTheLog) {
  if (std::system("/usr/bin/python3 -c 'import h5py' >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs python3-h5py: ci/setup --peers";
  const Log log = a_log(700);  // several chunks
  save_log(scratch("log.h5"), log);
  write_text(
      scratch("ask.py"),
      "import h5py\n"
      "f = h5py.File('" +
          scratch("log.h5") +
          "')\n"
          "s = f['scans']['front']['ranges_mm']; v = s[:]\n"
          "print(v[v >= 0].sum(), (v == s.attrs['no_echo']).sum(), s.shape, s.compression, s.shuffle, s.fletcher32)\n");
  ASSERT_EQ(std::system(("/usr/bin/python3 " + scratch("ask.py") + " >" + scratch("said.txt") + " 2>&1").c_str()), 0)
      << read_text(scratch("said.txt"));
  const Sums sums = sums_of(log);
  EXPECT_EQ(read_text(scratch("said.txt")),
            std::to_string(sums.mm) + " " + std::to_string(sums.none) + " (700, 361) gzip True True\n");
}

TEST(Peers, MrptReadsEveryScanOfACarmenLog) {
  if (std::system("command -v carmen2rawlog >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs carmen2rawlog of mrpt-apps: ci/setup --peers";
  write_carmen(scratch("mrpt.log"), a_log(37), CarmenStyle::robotlaser);
  const std::string said = scratch("mrpt.txt"), raw = scratch("mrpt.rawlog");
  std::system(("rm -f " + raw).c_str());
  ASSERT_EQ(std::system(("carmen2rawlog -i " + scratch("mrpt.log") + " -o " + raw + " >" + said + " 2>&1").c_str()), 0)
      << read_text(said);
  ASSERT_EQ(std::system(("rawlog-edit --info -i " + raw + " >" + said + " 2>&1").c_str()), 0) << read_text(said);
  EXPECT_THAT(read_text(said), HasSubstr("37"));
}

}  // namespace
}  // namespace adit
