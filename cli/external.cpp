// SPDX-License-Identifier: BSD-3-Clause
#include "cli/external.h"

#include "base/error.h"
#include "base/files.h"
#include "cli/convert.h"
#include "cli/estimate_parts.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace adit {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double gib = 1024.0 * 1024.0 * 1024.0;

double seconds_since(Clock::time_point began) {
  return std::chrono::duration<double>(Clock::now() - began).count();
}

// The words of the command with their placeholders filled; logs that they name are written.
std::vector<std::string> filled(const std::vector<std::string>& command, const Log& log, int seed,
                                const fs::path& dir) {
  std::vector<std::string> words;
  for (const std::string& given : command) {
    std::string word;
    for (size_t at = 0; at < given.size();) {
      const size_t open = given.find('{', at), close = given.find('}', open);
      word += given.substr(at, open == std::string::npos ? open : open - at);
      if (open == std::string::npos) break;
      const std::string name = given.substr(open + 1, close == std::string::npos ? close : close - open - 1);
      if (close == std::string::npos || (name != "out" && name != "seed" && !name.starts_with("log.")))
        throw Error("map.external.command: '" + given + "': '{" + name +
                    "}' is no placeholder; there are {out}, {seed} and {log.ENDING}, as {log.h5} or {log.clf}");
      if (name == "out") word += (dir / "out").string();
      if (name == "seed") word += std::to_string(seed);
      if (name.starts_with("log.")) {
        const std::string file = (dir / "work" / name).string();
        if (!fs::exists(file)) write_any_log(file, log);
        word += file;
      }
      at = close + 1;
    }
    // It runs in a folder of its own: what names a file from here must go on naming it.
    const bool is_file = word == given && word.find('/') != std::string::npos && fs::exists(word);
    words.push_back(is_file ? fs::absolute(word).string() : word);
  }
  return words;
}

// A program of its own group, so that all that it starts ends with it.
pid_t started(const std::vector<std::string>& words, const fs::path& dir) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (dir / "log.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND,
                                   0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&files, (dir / "work").c_str());
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&how, 0);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  pid_t child = -1;
  const int failed = posix_spawnp(&child, argv[0], &files, &how, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&how);
  if (failed != 0)
    throw Error("map.external.command: '" + words[0] + "' cannot be started: " + std::strerror(failed) +
                "; a name without '/' is looked for on the PATH");
  return child;
}

// Resident memory of all processes of a group (proc(5), stat: 5 pgrp, 24 rss).
double resident_gib(pid_t group) {
  double pages = 0;
  std::error_code gone;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc", gone)) {
    if (!std::isdigit(static_cast<unsigned char>(entry.path().filename().string()[0]))) continue;
    std::ifstream stat(entry.path() / "stat");
    std::string text;
    std::getline(stat, text, '\0');  // all of it, or nothing of a process that ends meanwhile
    const size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) continue;
    std::istringstream rest(text.substr(name_end + 1));
    std::string word, rss;
    long pgrp = -1;
    for (int k = 3; k <= 24 && rest >> word; ++k) {
      if (k == 5) pgrp = std::stol(word);
      if (k == 24) rss = word;
    }
    if (pgrp == group && !rss.empty()) pages += std::stod(rss);
  }
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / gib;
}

double size_gib(const fs::path& dir) {
  double bytes = 0;
  std::error_code gone;
  for (auto it = fs::recursive_directory_iterator(dir, gone); it != fs::recursive_directory_iterator();
       it.increment(gone)) {
    if (gone) break;
    std::error_code vanished;
    if (it->is_regular_file(vanished)) bytes += static_cast<double>(it->file_size(vanished));
  }
  return bytes / gib;
}

struct Ended {
  int status = 0;
  std::string limit;  // that it broke, or empty
  double seconds = 0, peak_gib = 0;
};

// Waits for the program, watching over what it takes.
Ended watched(pid_t child, const ExternalSettings& s, const fs::path& dir, const Progress& progress) {
  const auto began = Clock::now();
  const double before_gib = size_gib(dir);  // the log that it was given
  Ended end;
  rusage usage{};
  for (int look = 0;; ++look) {
    const pid_t got = wait4(child, &end.status, end.limit.empty() ? WNOHANG : 0, &usage);
    end.seconds = seconds_since(began);
    if (got == child) break;
    const double now_gib = resident_gib(child);
    end.peak_gib = std::max(end.peak_gib, now_gib);
    const auto over = [&](const char* key, double most, const char* unit) {
      std::ostringstream words;
      words << "it went over its limit of " << most << " " << unit << " (map.external." << key << ")";
      end.limit = words.str();
    };
    if (end.seconds > s.limit_s) over("limit_s", s.limit_s, "s");
    if (now_gib > s.limit_gib) over("limit_gib", s.limit_gib, "GiB of memory");
    if (look % 10 == 0 && size_gib(dir) - before_gib > s.limit_out_gib)
      over("limit_out_gib", s.limit_out_gib, "GiB of files");
    if (!end.limit.empty()) {
      kill(-child, SIGKILL);
      continue;
    }
    if (look % 20 == 0) progress("map: " + s.command[0], std::min(end.seconds, s.limit_s), s.limit_s);
    std::this_thread::sleep_for(std::chrono::milliseconds(look < 50 ? 10 : 50));
  }
  kill(-child, SIGKILL);  // what it may have left running
  for (int wait = 0; wait < 200 && resident_gib(child) > 0; ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  end.peak_gib = std::max(end.peak_gib, static_cast<double>(usage.ru_maxrss) * 1024 / gib);
  return end;
}

std::string last_words(const fs::path& file) {
  const std::string text = read_text(file.string());
  const size_t end = text.find_last_not_of(" \n\r\t");
  if (end == std::string::npos) return "it said nothing";
  const size_t begin = text.find_last_of("\n\r", end);
  return "its last words: " +
         text.substr(begin == std::string::npos ? 0 : begin + 1,
                     std::min<size_t>(300, end - (begin == std::string::npos ? 0 : begin + 1) + 1));
}

std::string failure_of(const Ended& end, const fs::path& dir) {
  std::string what = end.limit;
  if (what.empty() && WIFSIGNALED(end.status))
    what =
        "it was ended by signal " + std::to_string(WTERMSIG(end.status)) + " (" + strsignal(WTERMSIG(end.status)) + ")";
  if (what.empty() && WEXITSTATUS(end.status) != 0)
    what = "it ended with exit status " + std::to_string(WEXITSTATUS(end.status));
  return what.empty() ? "" : what + "; " + last_words(dir / "log.txt") + "; see " + (dir / "log.txt").string();
}

}  // namespace

Fields fields(ExternalSettings& s) {
  return {{"command", &s.command,
           "a mapper of others instead of adit's: words with {log.ENDING}, {out}, {seed}; run without a shell"},
          {"name", &s.name, "how scores call it; empty: its first word"},
          {"laser", &s.laser, "whose path it tells; empty: the body's"},
          {"limit_s", &s.limit_s, "it is ended after so long", 0.1, 1e7},
          {"limit_gib", &s.limit_gib, "or when it takes more memory", 0.001, 1e4},
          {"limit_out_gib", &s.limit_out_gib, "or writes more files", 0.001, 1e4}};
}

ExternalRun run_external(const ExternalSettings& s, const Log& log, int seed, const std::string& dir,
                         const Progress& progress) {
  ADIT_CHECK(!s.command.empty());
  const fs::path at = fs::absolute(dir);
  std::error_code failed;
  fs::remove_all(at, failed);
  fs::create_directories(at / "out", failed);
  fs::create_directories(at / "work", failed);
  if (failed) throw Error(dir + ": cannot be made: " + failed.message(), Fault::file);
  write_text((at / "log.txt").string(), "");
  const std::vector<std::string> words = filled(s.command, log, seed, at);
  const Ended end = watched(started(words, at), s, at, progress);
  for (const fs::directory_entry& entry : fs::directory_iterator(at / "work"))  // it can be written again
    if (entry.path().filename().string().starts_with("log.")) fs::remove_all(entry.path(), failed);
  ExternalRun run{{}, failure_of(end, at), end.seconds, end.peak_gib};
  if (!run.failure.empty()) return run;
  const EstimateParts parts = [&] {
    EstimateParts p = parts_in((at / "out").string());
    p.laser = s.laser;
    return p;
  }();
  if (parts.trajectory.empty()) {
    run.failure = "it left no " + (at / "out" / "trajectory.tum").string() + "; " + last_words(at / "log.txt");
    return run;
  }
  try {
    run.estimate = load_parts(parts, &log);
  } catch (const Error& e) {
    run.failure = std::string("its result cannot be read: ") + e.what();
    return run;
  }
  run.estimate->method = s.name.empty() ? fs::path(s.command[0]).filename().string() : s.name;
  return run;
}

}  // namespace adit
