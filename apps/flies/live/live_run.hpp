#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/diagnose/pair_watch.hpp"
#include "flies/io/calibration.hpp"
#include "flies/pipeline/engine.hpp"
#include "flies/video/pair_stream.hpp"
#include "live/live_frame.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/method_arguments.hpp"
#include "shared/run_diagnosis.hpp"

struct LiveRequest {
  flies::PairStreamRequest stream;
  std::string calib;
  CameraArguments camera;
  RunCorrections corrections;
  MethodArguments method;
  flies::TrackerOptions following;
  std::shared_ptr<const flies::PeopleClassifier> classifier;
  std::uint64_t max_pairs = 0;  ///< ends after so many; 0: when the source does
};

/// From a living source to its sinks: reads pairs, rectifies them, has an engine work on them, hands results on.
/// `run` in one thread; the rest may be called from any.
class LiveRun {
 public:
  /// @throws flies::InputError when the source cannot be opened
  LiveRun(LiveRequest request, std::vector<LiveSink*> sinks);
  ~LiveRun();

  /// Until the source ends, `max_pairs` came, or the user asks for the end.
  /// @throws flies::InputError when calibration and pictures do not go together, or a sink cannot write
  void run();

  void pause(bool is_paused);
  void step();  ///< one pair more while paused
  bool is_paused() const;

  /// From the next pair on. Following begins anew then.
  /// @throws flies::InputError when there is no such option or its value is not allowed
  void set_option(const std::string& path, const std::string& text);
  flies::DetectorOptions options() const;
  flies::TrackerOptions following() const;

  flies::PairStreamCounts source_counts() const;

 private:
  void say(const std::string& sentence);
  bool wait_for_pair(flies::StereoFrame& frame);
  std::shared_ptr<const flies::RunRecord> record_of(const flies::DetectorOptions& options) const;
  bool begin(std::vector<flies::StereoFrame>& first);
  void calibrate(const flies::StereoFrame& frame);
  std::shared_ptr<LivePair> prepare(flies::StereoFrame frame);
  void submit(std::shared_ptr<LivePair> pair, bool is_awaited);
  void renew_engine_if_asked();
  void hand_on();
  void hand_on_results(const std::shared_ptr<flies::Engine>& engine, std::uint64_t& last);
  std::shared_ptr<const LivePair> pair_at(double time_s);
  void rethrow_failure();
  void finish();

  LiveRequest request_;
  std::vector<LiveSink*> sinks_;
  std::unique_ptr<flies::PairStream> stream_;
  std::optional<flies::Calibration> calibration_;
  RunDiagnosis diagnosis_;
  flies::PairWatch watch_;
  std::uint64_t next_number_ = 0;
  std::uint64_t began_ns_ = 0;

  mutable std::mutex mutex_;  ///< of all below
  std::condition_variable changed_;
  std::shared_ptr<flies::Engine> engine_;
  flies::DetectorOptions options_;                      ///< as the user set them, then fitted to the camera
  std::string preset_;                                  ///< name of what the user set, without what fits the camera
  std::shared_ptr<const flies::RunRecord> run_record_;  ///< of the present engine
  flies::TrackerOptions following_;
  bool options_changed_ = false;
  bool is_paused_ = false, is_ending_ = false;
  int steps_ = 0;
  std::vector<std::shared_ptr<const LivePair>> recent_;  ///< the newest last
  std::uint64_t handed_on_ = 0;                          ///< results of the present engine
  flies::PairStreamCounts source_counts_;
  std::exception_ptr failure_;
  bool error_told_ = false;  ///< this and the next are of the handing thread
  GroundPose pose_;
};
