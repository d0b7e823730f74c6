// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/parallel.h"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace adit {

/// Makes values on a thread of its own and uses them here, in their order; where the process works with one thread, by
/// turns. An exception on either side ends both and is thrown here, that of the maker first.
/// @param make   calls the function that it is given with each value, which waits while `ahead` of them lie unused
template <class T>
void relay(size_t ahead, const std::function<void(const std::function<void(T&&)>& give)>& make,
           const std::function<void(T&&)>& use) {
  if (threads() == 1) return make(use);
  struct Stopped {};
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<T> lying;
  bool over = false, stopped = false;
  std::exception_ptr failure;
  const auto end = [&](bool& flag) {
    const std::lock_guard lock(mutex);
    flag = true;
    changed.notify_all();
  };
  std::thread maker([&] {
    try {
      make([&](T&& value) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return lying.size() < ahead || stopped; });
        if (stopped) throw Stopped{};
        lying.push_back(std::move(value));
        changed.notify_all();
      });
    } catch (const Stopped&) {
    } catch (...) {
      failure = std::current_exception();
    }
    end(over);
  });
  try {
    for (;;) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return !lying.empty() || over; });
      if (lying.empty()) break;
      T value = std::move(lying.front());
      lying.pop_front();
      changed.notify_all();
      lock.unlock();
      use(std::move(value));
    }
  } catch (...) {
    end(stopped);
    maker.join();
    throw;
  }
  maker.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace adit
