// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <string>
#include <vector>

namespace adit {

/// A drawing for CAD programs: AutoCAD's DXF, release 12, metres, to the millimetre.
class Dxf {
 public:
  void polyline(const std::string& layer, const std::vector<Vec2>& line, bool closed);
  void point(const std::string& layer, const Vec2& p);
  /// The file.
  std::string text() const;

 private:
  void put(int code, const std::string& value);
  void at(const Vec2& p);
  std::string entities_;
};

}  // namespace adit
