#include "channels/queued_sink.hpp"

#include <utility>

#include "flies/core/background_thread.hpp"

QueuedSink::QueuedSink(LiveSink& sink, std::size_t most, Haste haste, Overflow overflow, std::function<void()> left_out)
    : sink_(sink), most_(most), haste_(haste), overflow_(overflow), left_out_(std::move(left_out)), thread_([this] {
        work();
      }) {}

QueuedSink::~QueuedSink() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void QueuedSink::take(const LiveFrame& frame) {
  std::function<void()> tell;
  {
    std::unique_lock lock(mutex_);
    if (overflow_ == Overflow::waits) changed_.wait(lock, [&] { return failure_ || !is_full(); });
    if (failure_) std::rethrow_exception(failure_);
    for (; is_full(); pop())
      if (left_out_) tell = std::exchange(left_out_, {});
    waiting_.push_back(frame);
    waiting_bytes_ += frame.picture_bytes();
  }
  changed_.notify_all();
  if (tell) tell();
}

bool QueuedSink::is_full() const {
  return waiting_.size() >= most_ || (waiting_.size() >= kFewest && waiting_bytes_ >= kMostBytes);
}

LiveFrame QueuedSink::pop() {
  LiveFrame frame = std::move(waiting_.front());
  waiting_.pop_front();
  waiting_bytes_ -= frame.picture_bytes();
  return frame;
}

void QueuedSink::work() {
  if (haste_ == Haste::can_wait) flies::yield_to_other_threads();
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const LiveFrame frame = pop();
    lock.unlock();
    changed_.notify_all();
    try {
      if (frame.snapshot->error.empty())
        sink_.take(frame);
      else
        sink_.pass_over(frame);
    } catch (...) {
      lock.lock();
      failure_ = std::current_exception();
      waiting_.clear();
      waiting_bytes_ = 0;
      changed_.notify_all();
      return;
    }
  }
}

void QueuedSink::finish() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}
