// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace adit {
namespace {

// The arena has as many places as threads were asked for, also where the machine has fewer cores.
struct Crew {
  int size = tbb::info::default_concurrency();
  std::unique_ptr<tbb::global_control> limit;
  std::unique_ptr<tbb::task_arena> arena;
};

Crew& crew() {
  static Crew the_crew;
  return the_crew;
}

std::atomic<int> working{0}, most_working{0};

thread_local int depth = 0;  // of parallel calls nested on this thread

struct CountMe {
  CountMe() {
    if (depth++ > 0) return;
    const int now = ++working;
    int most = most_working.load();
    while (now > most && !most_working.compare_exchange_weak(most, now)) {
    }
  }
  ~CountMe() {
    if (--depth == 0) --working;
  }
};

#ifdef __SANITIZE_THREAD__

// The thread sanitizer does not see how oneTBB orders its threads: for it alone, plain threads that take turn after turn.
void spread(size_t turns, const std::function<void(size_t)>& f) {
  std::atomic<size_t> next{0};
  std::exception_ptr failure;
  std::once_flag failed;
  const auto work = [&] {
    const CountMe count;
    try {
      for (size_t k; (k = next++) < turns;) f(k);
    } catch (...) {
      next = turns;
      std::call_once(failed, [&] { failure = std::current_exception(); });
    }
  };
  std::vector<std::thread> others;
  if (depth == 0)
    for (int t = 1; t < crew().size; ++t) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

#else

// The turns on the threads of the crew.
void spread(size_t turns, const std::function<void(size_t)>& f) {
  const auto run = [&] {
    tbb::parallel_for(
        size_t{0}, turns,
        [&](size_t k) {
          const CountMe count;
          f(k);
        },
        tbb::simple_partitioner());
  };
  // A thread that waits for a loop within a loop helps with that loop alone: else it might begin another turn of the outer
  // one, and hold two at a time.
  const auto apart = [&] { depth > 0 ? tbb::this_task_arena::isolate(run) : run(); };
  if (crew().arena) {
    crew().arena->execute(apart);
  } else {
    apart();
  }
}

#endif

}  // namespace

void set_threads(int threads) {
  Crew& c = crew();
  c.size = threads > 0 ? threads : tbb::info::default_concurrency();
  c.arena.reset();
  c.limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, std::max(c.size, 1));
  c.arena = std::make_unique<tbb::task_arena>(c.size);
  most_working = 0;
}

int threads() {
  return crew().size;
}
int threads_seen() {
  return most_working;
}

void parallel_chunks(size_t n, size_t grain, const std::function<void(size_t, size_t)>& f) {
  if (n == 0) return;
  grain = std::max<size_t>(grain, 1);
  const size_t chunks = (n + grain - 1) / grain;
  spread(chunks, [&](size_t k) { f(k * grain, std::min(n, (k + 1) * grain)); });
}

void parallel_for(size_t n, const std::function<void(size_t)>& f, size_t grain) {
  parallel_chunks(n, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) f(i);
  });
}

double parallel_sum(size_t n, const std::function<double(size_t)>& f, size_t grain) {
  std::vector<double> part((n + grain - 1) / grain, 0.0);
  parallel_chunks(n, grain, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += f(i);
    part[begin / grain] = sum;
  });
  double total = 0;
  for (double p : part) total += p;
  return total;
}

}  // namespace adit
