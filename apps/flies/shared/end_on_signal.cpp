#include "shared/end_on_signal.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "flies/io/unfinished_outputs.hpp"

namespace {

/// Those that are not ignored, as SIGHUP is under nohup.
sigset_t ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  return signals;
}

using Clock = std::chrono::steady_clock;

/// A signal to the process and one to its group are one for the user.
constexpr std::chrono::milliseconds kSameSignal{300};

std::atomic<bool> asks_first = false, end_requested = false;

}  // namespace

// A signal handler may call next to nothing; a thread that waits for the signal may remove folders.
void end_cleanly_on_signals() {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int signal = 0;
    Clock::time_point asked;
    do {
      if (sigwait(&signals, &signal) != 0) return;
      if (!end_requested) asked = Clock::now();
    } while (asks_first && (!end_requested.exchange(true) || Clock::now() - asked < kSameSignal));
    flies::remove_unfinished_outputs();
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    std::raise(signal);
  }).detach();
}

void ask_before_ending_on_signals() { asks_first = true; }

bool is_end_requested() { return end_requested; }

void outlive_readers() { std::signal(SIGPIPE, SIG_IGN); }
