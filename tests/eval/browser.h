// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace adit {

/// Headless Chromium with one page open, driven over its debugging pipe in real time: an answer is waited for, so that a
/// slow machine makes a test slow and nothing else. WebGL is drawn by software. Its profile is a scratch folder.
/// Protocol: https://chromedevtools.github.io/devtools-protocol/
class Browser {
 public:
  /// Whether the browser is on the PATH (ci/setup --peers).
  static bool installed();

  /// Starts it with a window of `width_px` by `height_px`, as narrow as asked.
  Browser(int width_px, int height_px);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Opens `url` and returns when it has loaded.
  void open(const std::string& url);

  /// Runs `script` in the page, waits for the promise that it may give, and returns its value as JSON text ("null" for
  /// none). Throws Error with what the script threw.
  std::string run(const std::string& script);

  /// The page as PDF, in base64.
  std::string pdf();

  /// Errors of the page so far: uncaught exceptions, console errors, refusals by its security policy, failed requests.
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  std::string call(const std::string& method, const std::string& params);  // waits for the answer; its "result" as text
  std::string next();                                                      // the next message of the browser
  void note(const std::string& message);                                   // keeps what an event says of errors

  pid_t process_ = 0;
  int to_ = -1, from_ = -1, calls_ = 0;
  bool loaded_ = false;
  std::string session_, unread_, home_;
  std::vector<std::string> errors_;
};

}  // namespace adit
