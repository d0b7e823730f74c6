// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace adit {

/// What kind of failure an Error is; the value is the exit code of the command.
enum class Fault { bad_input = 2, not_comparable = 3, bug = 70, file = 74 };

/// Thrown where an input cannot be used. The text names the culprit (file, line, key, value) and what would be right.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what, Fault fault = Fault::bad_input) : std::runtime_error(what), fault_(fault) {}
  Fault fault() const { return fault_; }

 private:
  Fault fault_;
};

/// Prints the broken claim and aborts. Called by ADIT_CHECK.
[[noreturn]] void check_failed(const char* claim, const char* file, int line);

}  // namespace adit

/// Aborts when our own reasoning is broken; always on. Never for input.
#define ADIT_CHECK(claim) ((claim) ? void() : ::adit::check_failed(#claim, __FILE__, __LINE__))
