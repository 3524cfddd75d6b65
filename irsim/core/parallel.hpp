// Loops whose turns share nothing, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace irsim {

/// Call `work(first, last)` for parts of 0 to `count`, each on a thread of its own. `work` throws nothing. Parts have
/// at least `least` turns, so that a thread is worth starting.
template <class Work>
void in_parts(std::size_t count, int threads, std::size_t least, const Work& work) {
  const std::size_t most = std::max<std::size_t>(1, std::min<std::size_t>(threads < 1 ? 1 : threads, count / least));
  std::vector<std::thread> helpers;
  std::size_t done = count / most;  // the first part is for this thread
  try {
    for (std::size_t t = 1; t < most; ++t) {
      const std::size_t last = count * (t + 1) / most;
      helpers.emplace_back(work, done, last);
      done = last;
    }
  } catch (const std::system_error&) {
    work(done, count);  // the system gives no more threads
  }
  work(std::size_t{0}, count / most);
  for (std::thread& helper : helpers) helper.join();
}

/// Call `work(k, thread)` for each k below `count`, on threads that each take the next one when they are free, because
/// turns take unequal times. The first thread, 0, is this one. An error of a turn is thrown after all threads have
/// ended.
template <class Work>
void one_by_one(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> errors(threads);
  const auto turns = [&](int thread) {
    try {
      for (std::size_t k = next++; k < count; k = next++) work(k, thread);
    } catch (...) {
      errors[thread] = std::current_exception();
    }
  };
  std::vector<std::thread> helpers;
  try {
    for (int t = 1; t < threads; ++t) helpers.emplace_back(turns, t);
  } catch (const std::system_error&) {
    // The system gives no more threads; those that were started do the work.
  }
  turns(0);
  for (std::thread& helper : helpers) helper.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace irsim
