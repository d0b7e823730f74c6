// SPDX-License-Identifier: BSD-3-Clause
#include "tests/eval/browser.h"

#include "base/error.h"
#include "tests/support/scratch.h"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

using nlohmann::json;

// Nothing that is asked here takes a free machine more than some seconds; a browser that is silent for so long has hung.
constexpr int patience_ms = 300000;

// A pipe whose ends lie above the places 3 and 4 that the browser reads from and writes to.
void open_pipe(int ends[2]) {
  int made[2];
  if (::pipe2(made, O_CLOEXEC) != 0) throw Error("no pipe to the browser");
  for (int k = 0; k < 2; ++k) {
    ends[k] = ::fcntl(made[k], F_DUPFD_CLOEXEC, 10);
    ::close(made[k]);
  }
}

}  // namespace

bool Browser::installed() {
  return std::system("command -v chromium >/dev/null 2>&1") == 0;
}

Browser::Browser(int width_px, int height_px) {
  ::signal(SIGPIPE, SIG_IGN);  // a browser that ended is told by what a write returns
  static int count = 0;
  home_ = scratch("browser_" + std::to_string(count++));
  std::filesystem::create_directories(home_);
  int down[2], up[2];
  open_pipe(down);
  open_pipe(up);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, down[0], 3);
  posix_spawn_file_actions_adddup2(&files, up[1], 4);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (home_ + "/log.txt").c_str(), O_WRONLY | O_CREAT, 0644);
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);
  std::string profile = "--user-data-dir=" + home_;
  const char* words[] = {"chromium",
                         "--headless",
                         "--no-sandbox",
                         "--disable-gpu",
                         "--use-angle=swiftshader",
                         "--enable-unsafe-swiftshader",
                         "--disable-dev-shm-usage",
                         "--hide-scrollbars",
                         "--remote-debugging-pipe",
                         profile.c_str(),
                         nullptr};
  const int code = ::posix_spawnp(&process_, "chromium", &files, &how, const_cast<char**>(words), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&how);
  ::close(down[0]);
  ::close(up[1]);
  to_ = down[1];
  from_ = up[0];
  if (code != 0) throw Error("the browser does not start");

  const json target = json::parse(call("Target.createTarget", R"({"url":"about:blank"})"));
  const json attach{{"targetId", target["targetId"]}, {"flatten", true}};
  session_ = json::parse(call("Target.attachToTarget", attach.dump()))["sessionId"].get<std::string>();
  for (const std::string room : {"Page", "Runtime", "Log"}) call(room + ".enable", "{}");
  const json screen{{"width", width_px}, {"height", height_px}, {"deviceScaleFactor", 1}, {"mobile", false}};
  call("Emulation.setDeviceMetricsOverride", screen.dump());
}

Browser::~Browser() {
  ::close(to_);
  ::close(from_);
  if (process_ > 0) {
    ::kill(-process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  std::error_code ignored;
  std::filesystem::remove_all(home_, ignored);
}

void Browser::open(const std::string& url) {
  loaded_ = false;
  call("Page.navigate", json{{"url", url}}.dump());
  while (!loaded_) note(next());
}

std::string Browser::run(const std::string& script) {
  const json ask{{"expression", script}, {"awaitPromise", true}, {"returnByValue", true}};
  const json answer = json::parse(call("Runtime.evaluate", ask.dump()));
  if (answer.contains("exceptionDetails"))
    throw Error("the page's script failed: " + answer["exceptionDetails"].dump());
  return answer["result"].value("value", json()).dump();
}

std::string Browser::pdf() {
  return json::parse(call("Page.printToPDF", R"({"printBackground":true})"))["data"].get<std::string>();
}

std::string Browser::call(const std::string& method, const std::string& params) {
  const int id = ++calls_;
  json message{{"id", id}, {"method", method}, {"params", json::parse(params)}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(to_, text.data() + done, text.size() - done);
    if (n <= 0) throw Error("the browser has ended; it was asked for " + method);
    done += size_t(n);
  }
  for (;;) {
    const std::string heard = next();
    const json answer = json::parse(heard);
    if (answer.value("id", 0) == id) {
      if (answer.contains("error")) throw Error(method + ": " + answer["error"].dump());
      return answer["result"].dump();
    }
    note(heard);
  }
}

std::string Browser::next() {
  for (;;) {
    if (const size_t end = unread_.find('\0'); end != std::string::npos) {
      std::string message = unread_.substr(0, end);
      unread_.erase(0, end + 1);
      return message;
    }
    pollfd wait{from_, POLLIN, 0};
    if (::poll(&wait, 1, patience_ms) <= 0) throw Error("the browser has been silent for minutes");
    char bytes[65536];
    const ssize_t n = ::read(from_, bytes, sizeof bytes);
    if (n <= 0) throw Error("the browser has ended");
    unread_.append(bytes, size_t(n));
  }
}

void Browser::note(const std::string& message) {
  const json event = json::parse(message);
  const std::string method = event.value("method", "");
  if (method == "Page.loadEventFired") loaded_ = true;
  const bool bad = method == "Runtime.exceptionThrown" ||
                   (method == "Runtime.consoleAPICalled" && event["params"]["type"] == "error") ||
                   (method == "Log.entryAdded" && event["params"]["entry"]["level"] == "error");
  if (bad) errors_.push_back(event["params"].dump());
}

}  // namespace adit
