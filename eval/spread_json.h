// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/compare.h"

#include <cmath>
#include <optional>

namespace adit {

/// A number as JSON has it: null where it is none. `Json` is the caller's, whose library stays out of headers.
template <class Json>
Json json_of(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

template <class Json>
Json json_of(const std::optional<double>& value) {
  return value ? json_of<Json>(*value) : Json(nullptr);
}

template <class Json>
Json json_of(const Spread& s) {
  return {
      {"n", s.n}, {"median", json_of<Json>(s.median)}, {"low", json_of<Json>(s.low)}, {"high", json_of<Json>(s.high)}};
}

}  // namespace adit
