// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"

#include <cstdio>
#include <cstdlib>

namespace adit {

void check_failed(const char* claim, const char* file, int line) {
  std::fprintf(stderr, "adit: internal error: '%s' does not hold at %s:%d; please report it\n", claim, file, line);
  std::abort();
}

}  // namespace adit
