// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "cli/nightly_command.h"
#include "tests/bench/bench.h"

#include <cstdio>
#include <filesystem>

namespace {

using namespace adit;

std::vector<bench::Figure> quick_suite() {
  const std::string out = (std::filesystem::temp_directory_path() / "adit_bench_nightly").string();
  std::filesystem::remove_all(out);
  const bench::Cost cost = bench::cost_of([&] {
    if (!std::freopen("/dev/null", "w", stdout)) throw Error("/dev/null cannot be opened");  // of this process alone
    Console quiet(true, false);
    NightlyInput input;
    input.suite = "quick";
    Common common;
    common.out = out;
    nightly_command(input, common, quiet);
  });
  std::filesystem::remove_all(out);
  return {{"nightly_quick_s", cost.wall_s, "s", "lower", "adit nightly quick, all runs made anew, wall time"}};
}

}  // namespace

int main(int argc, char** argv) {
  return adit::bench::run(argc, argv, {{{"nightly_quick_s"}, quick_suite}});
}
