// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace adit {

/// Sets how many threads the process works with, once, before any work; 0 = all cores. Only cli/ and tests call it.
void set_threads(int threads);
int threads();
/// The greatest number of threads that were seen working at once since set_threads; for the test that they really ran.
int threads_seen();

/// f(i) for i in [0, n), in any order, on all threads; f writes slot i alone. Chunks of `grain` run on one thread.
/// The first exception thrown is thrown again here.
void parallel_for(size_t n, const std::function<void(size_t)>& f, size_t grain = 1);
/// f(begin, end) over the chunks [k * grain, (k + 1) * grain): the chunks are the same on any number of threads.
void parallel_chunks(size_t n, size_t grain, const std::function<void(size_t begin, size_t end)>& f);
/// Sum of f(i), the same bits on any number of threads (fixed chunks, summed in order).
double parallel_sum(size_t n, const std::function<double(size_t)>& f, size_t grain = 4096);

}  // namespace adit
