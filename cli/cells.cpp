// SPDX-License-Identifier: BSD-3-Clause
#include "cli/cells.h"

#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "cli/cell_keys.h"
#include "cli/peak_memory.h"
#include "cli/stages.h"
#include "eval/yardstick.h"

#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <tuple>

namespace adit {
namespace {

namespace fs = std::filesystem;

struct Job {
  Scenario scenario;
  CellKeys key;
};

// Something that several cells need: made once, by the first that comes.
template <class T>
struct Shared {
  size_t left = 0;  // cells that still need it
  bool making = false, made = false;
  std::shared_ptr<const T> value;  // or the reason why there is none
  std::string failure;
};

// A map as its files tell it, which is what is judged, and as it was made.
struct Mapped {
  Estimate judged;
  std::optional<Estimate> made;  // where the maps are kept
};

// What judges maps, and what of its arguments must outlive it.
struct Judge {
  std::shared_ptr<const World> world;
  std::shared_ptr<const Recording> recording;
  Yardstick yardstick;
};

struct Failure {
  std::string why;
};

// Error texts of a failure that belongs to one cell; what belongs to the machine goes on.
template <class Work>
std::string reason_of(const Work& work) {
  try {
    work();
    return "";
  } catch (const Failure& f) {
    return f.why;
  } catch (const Error& e) {
    if (e.fault() == Fault::file) throw;
    return e.what();
  } catch (const std::bad_alloc&) {
    throw Error("out of memory; fewer cells at once take less", Fault::file);
  } catch (const std::exception& e) {
    return std::string("internal error: ") + e.what();
  }
}

std::string host() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

// A cell's folder while it is being made: ".NAME.HOST.PID".
std::string temporary(const std::string& dir, const std::string& name) {
  return dir + "/." + name + "." + host() + "." + std::to_string(::getpid());
}

// What processes of this machine left that are no more.
void sweep(const std::string& dir) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(dir, failed)) {
    const std::string file = entry.path().filename().string(), middle = "." + host() + ".";
    const size_t at = file.find(middle);
    if (!file.starts_with(".") || at != 17) continue;
    const int pid = std::atoi(file.c_str() + at + middle.size());
    if (pid > 0 && pid != ::getpid() && ::kill(pid, 0) != 0) fs::remove_all(entry.path(), failed);
  }
}

class Kitchen {
 public:
  Kitchen(std::list<Job> pending, const CellsSettings& settings, const Progress& progress)
      : pending_(std::move(pending)), settings_(settings), progress_(progress), all_(pending_.size()) {
    for (const Job& job : pending_) {
      ++worlds_[job.key.world].left;
      ++drives_[job.key.drive].left;
      ++recordings_[job.key.recording].left;
      ++judges_[job.key.yardstick].left;
      ++maps_[job.key.map].left;
    }
  }

  // Until nothing is left; several threads may be at it.
  void work() {
    while (std::optional<Job> job = next()) {
      try {
        finish(*job);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!fault_) fault_ = std::current_exception();
      }
      leave(*job);
    }
  }

  void rethrow() const {
    if (fault_) std::rethrow_exception(fault_);
  }
  size_t failed() const { return failed_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Job> pending_;
  const CellsSettings& settings_;
  const Progress& progress_;
  size_t all_, done_ = 0, failed_ = 0, running_ = 0, most_ = 1;
  std::exception_ptr fault_;
  std::map<std::string, Shared<World>> worlds_;
  std::map<std::string, Shared<Drive>> drives_;
  std::map<std::string, Shared<Recording>> recordings_;
  std::map<std::string, Shared<Judge>> judges_;
  std::map<std::string, Shared<Mapped>> maps_;
  std::mutex h5_;  // HDF5 is for one thread
  PeakShares peaks_;

  // work(all of its kind, its key) for each thing that the cell shares with others.
  template <class Work>
  void each_shared(const Job& job, const Work& work) {
    work(worlds_, job.key.world), work(drives_, job.key.drive), work(recordings_, job.key.recording);
    work(judges_, job.key.yardstick), work(maps_, job.key.map);
  }

  bool ready(const Job& job) {
    bool making = false;
    each_shared(job, [&](auto& all, const std::string& key) { making = making || all[key].making; });
    return !making;
  }

  // By what the cells before it took.
  bool memory_left() const {
    return running_ == 0 || available_gib() > peaks_.highest_gib() / static_cast<double>(most_);
  }

  std::optional<Job> next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (fault_ || pending_.empty()) return {};
      const auto at = memory_left()
                          ? std::find_if(pending_.begin(), pending_.end(), [&](const Job& j) { return ready(j); })
                          : pending_.end();
      if (at == pending_.end()) {
        changed_.wait(lock);
        continue;
      }
      Job job = std::move(*at);
      pending_.erase(at);
      each_shared(job, [](auto& all, const std::string& key) { all[key].making = !all[key].made; });
      most_ = std::max(most_, ++running_);
      return job;
    }
  }

  void leave(const Job& job) {
    const std::lock_guard lock(mutex_);
    each_shared(job, [](auto& all, const std::string& key) {
      if (--all[key].left == 0)
        all.erase(key);
      else
        all[key].making = false;
    });
    --running_;
    progress_("cells", static_cast<double>(++done_), static_cast<double>(all_));
    changed_.notify_all();
  }

  // The thing of a key: as another cell made it, or made here. A Failure where it cannot be made.
  template <class T, class Make>
  std::shared_ptr<const T> had(std::map<std::string, Shared<T>>& all, const std::string& key, const Make& make) {
    Shared<T>* shared = nullptr;
    {
      const std::lock_guard lock(mutex_);
      shared = &all[key];  // stays where it is
    }
    if (!shared->made) {
      std::shared_ptr<const T> value;
      const std::string failure = reason_of([&] { value = std::make_shared<const T>(make()); });
      const std::lock_guard lock(mutex_);
      shared->value = value, shared->failure = failure, shared->made = true, shared->making = false;
      changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    if (!shared->value) throw Failure{shared->failure};
    return shared->value;
  }

  Score score_of(const Job& job, const std::string& at) {
    const Scenario& s = job.scenario;
    const auto seed = static_cast<std::uint64_t>(s.seed);
    const auto world = had(worlds_, job.key.world, [&] { return sound_world(s); });
    const auto drive = had(drives_, job.key.drive, [&] {
      Drive d = adit::drive(*world, plan_route(*world, s.route, seed), load_vehicle(s.vehicle), s.drive, seed);
      if (d.end != DriveEnd::finished) throw Failure{"drive " + drive_end_name(d.end) + ": " + d.cause};
      return d;
    });
    const auto recording = had(recordings_, job.key.recording, [&] {
      return record(*world, *drive, load_rig(s.sensors), load_vehicle(s.vehicle).hull, s.sensors, seed);
    });
    if (settings_.keep_recording) {
      const std::lock_guard lock(h5_);
      save_log(at + "/recording/log.h5", recording->log);
      save_truth(at + "/recording/truth.h5", recording->truth);
    }
    const auto judge = [&] {
      return had(judges_, job.key.yardstick, [&] {
        return Judge{world, recording, Yardstick(*world, recording->truth, recording->log.rig, s.score)};
      });
    };
    // First where others wait for it; else it would only lie there while the map is made.
    if (wanted_by_others(job.key.yardstick)) reason_of(judge);
    const auto mapped = had(maps_, job.key.map, [&] { return mapped_of(s, recording->log, at); });
    if (settings_.keep_map) save_estimate(at + "/map", *mapped->made);
    return score_map(judge()->yardstick, mapped->judged);
  }

  bool wanted_by_others(const std::string& yardstick) {
    const std::lock_guard lock(mutex_);
    return judges_[yardstick].left > 1;
  }

  Mapped mapped_of(const Scenario& s, const Log& log, const std::string& at) const {
    Estimate made = estimate_of(s, log, at);
    save_estimate(at + "/map", made);
    Mapped mapped{load_estimate(at + "/map"), {}};
    fs::remove_all(at + "/map");
    if (settings_.keep_map) mapped.made = std::move(made);
    return mapped;
  }

  static Estimate estimate_of(const Scenario& s, const Log& log, const std::string& at) {
    if (s.external.command.empty()) return make_map(log, s.map);
    ExternalRun run = run_external(s.external, log, s.seed, at + "/external");
    fs::remove_all(at + "/external");
    if (!run.estimate) throw Failure{"mapper failed: " + run.failure};
    return std::move(*run.estimate);
  }

  void finish(const Job& job) {
    const std::string at = temporary(settings_.dir, job.key.cell);
    const auto began = std::chrono::steady_clock::now();
    const PeakShares::Share memory(peaks_);
    fs::remove_all(at);
    write_text(at + "/scenario.toml", resolved_toml(job.scenario));
    try {
      const std::string failure = reason_of([&] { write_score(at + "/score.json", score_of(job, at)); });
      if (!failure.empty()) {
        for (const char* part : {"map", "recording", "external", "score.json"}) fs::remove_all(at + "/" + part);
        write_text(at + "/failure.txt", failure + "\n");
        const std::lock_guard lock(mutex_);
        ++failed_;
      }
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      write_text(at + "/timing.json",
                 nlohmann::ordered_json{{"seconds", seconds}, {"peak_gib", memory.peak_gib()}}.dump() + "\n");
    } catch (...) {
      std::error_code ignored;
      fs::remove_all(at, ignored);
      throw;
    }
    publish(at, settings_.dir + "/" + job.key.cell);
  }

  // Where another process was faster its cell stays: it holds the same bytes.
  static void publish(const std::string& at, const std::string& to) {
    std::error_code failed, ignored;
    fs::rename(at, to, failed);
    if (!failed) return;
    fs::remove_all(at, ignored);
    if (!fs::exists(to + "/scenario.toml", ignored))
      throw Error(to + ": cannot be put in place: " + failed.message(), Fault::file);
  }
};

}  // namespace

CellsRun run_cells(const std::vector<Scenario>& scenarios, const CellsSettings& settings, const Progress& progress) {
  if (settings.shards < 1 || settings.shard < 1 || settings.shard > settings.shards)
    throw Error("shard " + std::to_string(settings.shard) + "/" + std::to_string(settings.shards) +
                ": must be I/N with 1 <= I <= N");
  std::vector<Job> jobs;
  std::set<std::string> seen;
  for (const Scenario& s : scenarios) {
    Job job{bare(s), keys_of(s)};
    job.scenario.name = "cell";  // the same for all, since they share what bears it
    if (seen.insert(job.key.cell).second) jobs.push_back(std::move(job));
  }
  // Maps last: they are small beside what judges them.
  const auto order = [](const Job& j) {
    return std::tie(j.key.world, j.key.drive, j.key.recording, j.key.yardstick, j.key.map, j.key.cell);
  };
  std::sort(jobs.begin(), jobs.end(), [&](const Job& a, const Job& b) { return order(a) < order(b); });
  const auto part = [&](int n) { return jobs.size() * static_cast<size_t>(n) / static_cast<size_t>(settings.shards); };
  std::error_code failed;
  fs::create_directories(settings.dir, failed);
  if (failed) throw Error(settings.dir + ": cannot make this folder: " + failed.message(), Fault::file);
  sweep(settings.dir);
  CellsRun run;
  std::list<Job> pending;
  for (size_t i = part(settings.shard - 1); i < part(settings.shard); ++i) {
    ++run.asked;
    const std::string at = settings.dir + "/" + jobs[i].key.cell;
    if (!fs::exists(at)) {
      pending.push_back(std::move(jobs[i]));
      continue;
    }
    ++run.there;
    run.failed += fs::exists(at + "/failure.txt");
  }
  run.made = pending.size();
  Kitchen kitchen(std::move(pending), settings, progress);
  const int workers = std::min<int>(settings.at_once > 0 ? settings.at_once : threads(), static_cast<int>(run.made));
  if (workers > 0) parallel_for(static_cast<size_t>(workers), [&](size_t) { kitchen.work(); });
  kitchen.rethrow();
  run.failed += kitchen.failed();
  return run;
}

std::optional<Cell> load_cell(const std::string& dir, const std::string& name) {
  const std::string at = dir + "/" + name;
  if (!fs::exists(at)) return {};
  Cell cell;
  cell.name = name;
  if (fs::exists(at + "/failure.txt")) {
    cell.failure = read_text(at + "/failure.txt");
    while (cell.failure.ends_with('\n')) cell.failure.pop_back();
  } else {
    cell.score = read_score(at + "/score.json");
  }
  const nlohmann::json timing = nlohmann::json::parse(read_text(at + "/timing.json"));
  cell.seconds = timing.value("seconds", 0.0), cell.peak_gib = timing.value("peak_gib", 0.0);
  return cell;
}

}  // namespace adit
