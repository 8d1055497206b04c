#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

/// What the thread sanitizer runs instead of oneTBB's loops (this folder comes before the system's headers where
/// FLIES_SANITIZE holds `thread`). Debian's libtbb is not built with the sanitizer, which therefore does not see that a
/// loop's tasks begin after their caller and end before it goes on, and would call every loop a race. Here each loop
/// starts its own std::thread's and waits for them: what the sanitizer reports is a race of the loop's own body.
namespace tbb::stand_in {

/// Threads that a loop runs on: more than one on any machine, so that the sanitizer has something to look at.
constexpr int kThreads = 3;

/// Threads that loops on this thread may use; an arena sets it, and a loop hands it on to its threads.
inline int& allowed_threads() {
  static thread_local int threads = kThreads;
  return threads;
}

/// Calls `run`(i) for all i in [0, `count`), the first on this thread, every other on a thread of its own, or all on
/// this one where only one is allowed. Throws again what the first of them to throw has thrown, once all have ended.
template <class Run>
void run_at_once(std::size_t count, const Run& run) {
  std::mutex mutex;
  std::exception_ptr thrown;
  const auto guarded = [&](std::size_t i) {
    try {
      run(i);
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (thrown == nullptr) thrown = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  const int allowed = allowed_threads();
  for (std::size_t i = 1; i < count && allowed > 1; ++i)
    others.emplace_back([&guarded, allowed, i] {
      allowed_threads() = allowed;
      guarded(i);
    });
  if (count > 0) guarded(0);
  for (std::size_t i = 1; i < count && allowed <= 1; ++i) guarded(i);
  for (auto& other : others) other.join();
  if (thrown != nullptr) std::rethrow_exception(thrown);
}

/// Calls `run`(part) for all parts in [0, `parts`), dealt out to the allowed threads like cards.
template <class Run>
void deal_out(std::size_t parts, const Run& run) {
  const std::size_t threads = std::min(parts, static_cast<std::size_t>(allowed_threads()));
  run_at_once(threads, [&](std::size_t thread) {
    for (std::size_t part = thread; part < parts; part += threads) run(part);
  });
}

}  // namespace tbb::stand_in
