#pragma once

#include <exception>
#include <functional>
#include <thread>
#include <utility>

#include "tbb/stand_in.hpp"

namespace tbb {

/// Runs one task on a thread of its own; where only one thread is allowed, on the one that waits for it.
class task_group {
 public:
  template <class Task>
  void run(Task task) {
    const auto guarded = [this, task = std::move(task)] {
      try {
        task();
      } catch (...) {
        thrown_ = std::current_exception();
      }
    };
    const int allowed = stand_in::allowed_threads();
    if (allowed <= 1)
      waiting_ = guarded;
    else
      thread_ = std::thread([guarded, allowed] {
        stand_in::allowed_threads() = allowed;
        guarded();
      });
  }

  void wait() {
    if (thread_.joinable()) thread_.join();
    if (const auto task = std::exchange(waiting_, {})) task();
    if (const auto thrown = std::exchange(thrown_, {})) std::rethrow_exception(thrown);
  }

 private:
  std::thread thread_;
  std::function<void()> waiting_;
  std::exception_ptr thrown_;
};

}  // namespace tbb
