#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "flies/web/access.hpp"
#include "flies/web/web_server.hpp"
#include "live/live_frame.hpp"
#include "live/live_run.hpp"

/// The page of `flies live --view`: what is seen, from the side and from above, with controls.
class View final : public LiveSink {
 public:
  /// @throws flies::InputError when the port cannot be had
  explicit View(const flies::WebServerRequest& request);
  ~View() override;

  /// From now on until `release` the page steers this run.
  void control(LiveRun& run);
  void release();

  std::string address() const;  ///< where a browser finds it, with the token when there is one

  void take(const LiveFrame& frame) override;
  void note(const std::string& sentence) override;

 private:
  struct Sample {
    std::chrono::steady_clock::time_point time;
    double latency_ms = 0.0;
  };

  flies::WebAnswer answer(const flies::WebRequest& request);
  flies::WebAnswer answer_allowed(const flies::WebRequest& request);
  flies::WebAnswer state(const flies::WebRequest& request);
  flies::WebAnswer picture(const flies::WebRequest& request);
  flies::WebAnswer flies_of(const flies::WebRequest& request);
  flies::WebAnswer report(const flies::WebRequest& request);
  flies::WebAnswer order(const flies::WebRequest& request);
  std::optional<LiveFrame> frame_of(const flies::WebRequest& request);

  flies::WebServerRequest request_;
  std::string token_;
  const std::string run_id_;
  std::mutex mutex_;  ///< of all below but the last
  std::condition_variable changed_;
  std::deque<LiveFrame> recent_;  ///< the newest last
  std::deque<Sample> samples_;
  std::deque<std::string> notes_;                ///< the newest last
  std::chrono::steady_clock::time_point asked_;  ///< when a page asked for something
  std::uint64_t changes_ = 0;                    ///< of what the page shows beside pairs
  LiveRun* run_ = nullptr;
  bool is_ending_ = false;
  std::optional<flies::Access> access_;
  std::unique_ptr<flies::WebServer> server_;  ///< last: its threads use all of the above
};
