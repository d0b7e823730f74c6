// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.h"

#include <string>

namespace adit {

/// What the Error says that f() throws; "no error" where it throws none.
template <class F>
std::string error_of(const F& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace adit
