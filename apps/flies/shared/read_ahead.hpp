#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <utility>

/// Makes one item after another, each while the one before it is being used.
template <class Item>
class ReadAhead {
 public:
  using Make = std::function<Item(std::size_t)>;

  /// @param make      of the items 0 to `count - 1`; runs in another thread when `is_ahead`, one call at a time
  ReadAhead(std::size_t count, Make make, bool is_ahead)
      : count_(count), make_(std::move(make)), how_(is_ahead ? std::launch::async : std::launch::deferred) {
    start();
  }

  /// The next item; there must be one. Throws what making it threw.
  Item next() {
    auto made = std::move(next_);
    made.wait();
    start();
    return made.get();
  }

 private:
  void start() {
    if (started_ == count_) return;
    next_ = std::async(how_, [this, i = started_] { return make_(i); });
    ++started_;
  }

  std::size_t count_;
  Make make_;
  std::launch how_;
  std::size_t started_ = 0;
  std::future<Item> next_;
};
