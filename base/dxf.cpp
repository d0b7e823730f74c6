// SPDX-License-Identifier: BSD-3-Clause
#include "base/dxf.h"

#include <fmt/format.h>

namespace adit {

// Pairs of a group code and a value, a line each.
void Dxf::put(int code, const std::string& value) {
  entities_ += fmt::format("{}\n{}\n", code, value);
}

void Dxf::at(const Vec2& p) {
  put(10, fmt::format("{:.3f}", p.x()));
  put(20, fmt::format("{:.3f}", p.y()));
  put(30, "0.0");
}

void Dxf::polyline(const std::string& layer, const std::vector<Vec2>& line, bool closed) {
  put(0, "POLYLINE");
  put(8, layer);
  put(66, "1");
  put(70, closed ? "1" : "0");
  for (const Vec2& p : line) {
    put(0, "VERTEX");
    put(8, layer);
    at(p);
  }
  put(0, "SEQEND");
}

void Dxf::point(const std::string& layer, const Vec2& p) {
  put(0, "POINT");
  put(8, layer);
  at(p);
}

std::string Dxf::text() const {
  return "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities_ +
         "0\nENDSEC\n0\nEOF\n";
}

}  // namespace adit
