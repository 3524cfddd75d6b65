// Loops whose turns share nothing, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <vector>

namespace irsim {

/// Threads that wait for the next loop, because to start one takes as long as a short loop. A thread that waits looks
/// for work for some microseconds, then it sleeps. One caller at a time. The copy of a crew in a forked process has no
/// threads and starts new ones.
class Crew {
 public:
  Crew() = default;
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Have `wanted` threads, the caller's among them, or as many as the system gives; return their number.
  int hire(int wanted);

  /// Call `work(thread)` for each thread below `threads`, which were hired, at the same time; 0 is the caller's. `work`
  /// throws nothing.
  template <class Work>
  void run(int threads, const Work& work) {
    if (threads < 2) {
      work(0);
      return;
    }
    start(threads, [](const void* given, int thread) { (*static_cast<const Work*>(given))(thread); }, &work);
    work(0);
    finish();
  }

 private:
  using Call = void (*)(const void* work, int thread);
  struct Post;

  void start(int threads, Call call, const void* work);
  void finish();
  void abandon_after_fork();

  Post* post_ = nullptr;
};

/// Call `work(first, last)` for parts of 0 to `count`, each on a thread of its own. `work` throws nothing. Parts have
/// at least `least` turns, so that a thread is worth waking.
template <class Work>
void in_parts(Crew& crew, std::size_t count, int threads, std::size_t least, const Work& work) {
  const std::size_t useful = std::max<std::size_t>(1, count / least);
  const int most = crew.hire(static_cast<int>(std::min<std::size_t>(std::max(threads, 1), useful)));
  crew.run(most, [&](int t) { work(count * t / most, count * (t + 1) / most); });
}

/// Call `work(first, last, thread)` for shares of 0 to `count` on `threads` that were hired. Each thread begins with
/// the same turns in every call, because their memory is then in the caches of its processor, and goes on with what
/// others have left. An error of a share is thrown after all threads have ended.
template <class Work>
void in_shares(Crew& crew, std::size_t count, int threads, const Work& work) {
  std::vector<std::atomic<std::size_t>> next(threads);
  for (int t = 0; t < threads; ++t) next[t] = count * t / threads;
  std::vector<std::exception_ptr> errors(threads);
  const std::size_t share = threads < 2 ? count : std::max<std::size_t>(1, count / (32 * threads));
  crew.run(threads, [&](int t) {
    try {
      for (int k = 0; k < threads; ++k) {
        const int part = (t + k) % threads;
        const std::size_t end = count * (part + 1) / threads;
        for (std::size_t first = next[part].fetch_add(share); first < end; first = next[part].fetch_add(share)) {
          work(first, std::min(first + share, end), t);
        }
      }
    } catch (...) {
      errors[t] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

/// Call `work(k, thread)` for each k below `count`, on threads that each take the next one when they are free, because
/// turns take unequal times. The first thread, 0, is this one. An error of a turn is thrown after all threads have
/// ended.
template <class Work>
void one_by_one(Crew& crew, std::size_t count, int threads, const Work& work) {
  const int most = crew.hire(threads);
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> errors(most);
  crew.run(most, [&](int thread) {
    try {
      for (std::size_t k = next++; k < count; k = next++) work(k, thread);
    } catch (...) {
      errors[thread] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace irsim
