// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"

#include <algorithm>
#include <utility>

namespace adit {

// Written by ci/cmake/bundle.cmake.
extern const std::pair<std::string_view, std::string_view> bundled_data[];
extern const int bundled_count;

std::string_view bundled(const std::string& path) {
  for (int i = 0; i < bundled_count; ++i)
    if (bundled_data[i].first == path) return bundled_data[i].second;
  return {};
}

std::vector<std::string> bundled_names(const std::string& folder) {
  std::vector<std::string> names;
  for (int i = 0; i < bundled_count; ++i) {
    const std::string path(bundled_data[i].first);
    if (!path.starts_with(folder + "/")) continue;
    const std::string name = path.substr(folder.size() + 1);
    names.push_back(name.substr(0, name.rfind('.')));
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace adit
