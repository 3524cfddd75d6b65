#include "parallel.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>

#if defined(_WIN32)
#include <process.h>
#else
#include <pthread.h>
#include <signal.h>
#include <unistd.h>
#endif
#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif

namespace irsim {
namespace {

/// Time for which a thread looks for work before it sleeps: longer than it takes to wake one.
constexpr std::chrono::microseconds kLook{100};
constexpr int kPauses = 50;  // looks between looks at the clock, after each of which another thread may have its turn

void pause() {
#if defined(__x86_64__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  asm volatile("yield");
#endif
}

/// Look for some time whether something has happened, and return whether it has.
template <class Happened>
bool look(const Happened& happened) {
  const auto end = std::chrono::steady_clock::now() + kLook;
  do {
    for (int k = 0; k < kPauses; ++k) {
      if (happened()) return true;
      pause();
    }
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < end);
  return happened();
}

long process_number() {
#if defined(_WIN32)
  return _getpid();
#else
  return getpid();
#endif
}

/// Leave signals to the threads of the program: one that sleeps here would not interrupt what they wait for.
void block_signals() {
#if !defined(_WIN32)
  sigset_t signals;
  sigfillset(&signals);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigdelset(&signals, own);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
#endif
}

}  // namespace

struct Crew::Post {
  std::mutex mutex;
  std::condition_variable begun, ended;
  std::atomic<unsigned> round{0};  // loops that were begun
  std::atomic<int> busy{0};        // helpers that have not ended the present one
  int threads = 0;                 // the threads that take part in it
  Call call = nullptr;
  const void* work = nullptr;
  bool over = false;
  const long process = process_number();
  std::vector<std::thread> helpers;

  void help(int thread, unsigned seen) {
    block_signals();
    const auto called = [&] { return round.load(std::memory_order_acquire) != seen; };
    for (;; ++seen) {
      if (!look(called)) {
        std::unique_lock<std::mutex> lock(mutex);
        begun.wait(lock, called);
      }
      if (over) return;
      if (thread < threads) call(work, thread);
      if (busy.fetch_sub(1, std::memory_order_acq_rel) == 1) {
        const std::lock_guard<std::mutex> lock(mutex);
        ended.notify_one();
      }
    }
  }

  void begin() {
    {
      const std::lock_guard<std::mutex> lock(mutex);  // no helper goes to sleep meanwhile
      round.fetch_add(1, std::memory_order_release);
    }
    begun.notify_all();
  }
};

Crew::~Crew() {
  abandon_after_fork();
  if (post_ == nullptr) return;
  post_->over = true;
  post_->begin();
  for (std::thread& helper : post_->helpers) helper.join();
  delete post_;
}

int Crew::hire(int wanted) {
  if (wanted < 2) return 1;
  abandon_after_fork();
  if (post_ == nullptr) post_ = new Post;
  std::vector<std::thread>& helpers = post_->helpers;
  try {
    while (static_cast<int>(helpers.size()) + 1 < wanted) {
      const int thread = static_cast<int>(helpers.size()) + 1;
      helpers.emplace_back([post = post_, thread, seen = post_->round.load()] { post->help(thread, seen); });
    }
  } catch (const std::system_error&) {
    // The system gives no more threads; the started ones do the work.
  }
  return std::min(wanted, static_cast<int>(helpers.size()) + 1);
}

void Crew::start(int threads, Call call, const void* work) {
  post_->threads = threads, post_->call = call, post_->work = work;
  post_->busy.store(static_cast<int>(post_->helpers.size()), std::memory_order_relaxed);
  post_->begin();
}

void Crew::finish() {
  const auto all = [&] { return post_->busy.load(std::memory_order_acquire) == 0; };
  if (look(all)) return;
  std::unique_lock<std::mutex> lock(post_->mutex);
  post_->ended.wait(lock, all);
}

void Crew::abandon_after_fork() {
  if (post_ != nullptr && post_->process != process_number()) post_ = nullptr;  // its threads are not in this process
}

}  // namespace irsim
