// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace adit {

/// Runs write(temporary name), then renames to `file`: what bears its name is whole. Creates the folder. On failure the
/// temporary file is removed and an earlier `file` stays; the Error names the file and the system's reason.
void write_whole(const std::string& file, const std::function<void(const std::string& temporary)>& write);
void write_text(const std::string& file, const std::string& text);
std::string read_text(const std::string& file);

}  // namespace adit
