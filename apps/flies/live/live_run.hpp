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
#include "flies/ego/shift_watch.hpp"
#include "flies/io/calibration.hpp"
#include "flies/pipeline/engine.hpp"
#include "flies/video/pair_stream.hpp"
#include "live/later_diagnosis.hpp"
#include "live/live_frame.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/listed_options.hpp"
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

  /// From the next pair on. Following begins anew then. What is set while the camera is not known yet counts more than
  /// what fits the camera.
  /// @throws flies::InputError when there is no such option or its value is not allowed
  void set_option(const std::string& path, const std::string& text);
  flies::DetectorOptions options() const;  ///< fitted to the camera once it is known
  flies::TrackerOptions following() const;

  flies::PairStreamCounts source_counts() const;

 private:
  /// An engine and what it was made with.
  struct Worker {
    std::unique_ptr<flies::Engine> engine;
    std::shared_ptr<const flies::DetectorOptions> options;
    std::shared_ptr<const flies::TrackerOptions> following;
    std::string preset;
    std::shared_ptr<const flies::RunRecord> record;
    flies::StereoCamera camera;
    std::shared_ptr<const flies::DiagnosisRecord> diagnosis;
    std::uint64_t submitted_before = 0;  ///< pairs, to the workers before
  };

  /// A pair that no worker gets, and why.
  struct PassedOver {
    std::shared_ptr<const LivePair> pair;
    std::string fault;
  };

  void say(const std::string& sentence);
  flies::PairStreamCounts counted() const;
  bool wait_for_pair(flies::StereoFrame& frame);
  std::shared_ptr<const Worker> new_worker(const flies::DetectorOptions& options, const std::string& preset,
                                           const flies::TrackerOptions& following,
                                           std::uint64_t submitted_before) const;
  std::vector<std::string> fit_options();
  void diagnose_later(const flies::GrayPair& images, double time_s);
  void take_up(LaterDiagnosis::Finding found);
  bool begin(std::vector<flies::StereoFrame>& first);
  void calibrate(const flies::StereoFrame& frame);
  void check_not_halved(const flies::StereoFrame& frame) const;
  void fit_calibration(const flies::StereoFrame& frame);
  std::shared_ptr<LivePair> prepare(flies::StereoFrame frame);
  std::string fault_of(const LivePair& pair);
  void submit(std::shared_ptr<LivePair> pair, bool is_awaited);
  void forget_the_one_before(const LivePair& pair);
  void renew_worker_if_asked(std::uint64_t number);
  void hand_on();
  std::shared_ptr<const Worker> worker_unless_ending();
  void go_on_with(std::shared_ptr<const Worker> worker);
  void hand_on_results();
  void pass_over(const std::shared_ptr<const LivePair>& pair, const std::string& fault);
  void take(const std::shared_ptr<const LivePair>& pair, const std::shared_ptr<const flies::Snapshot>& snapshot);
  void check_that_pairs_were_used() const;
  std::uint64_t oldest_awaited() const;
  void hand_on_passed_over(std::optional<std::uint64_t> before);
  LiveFrame frame_of(std::shared_ptr<const LivePair> pair, std::shared_ptr<const flies::Snapshot> snapshot) const;
  std::shared_ptr<const flies::Snapshot> continued(const std::shared_ptr<const flies::Snapshot>& snapshot) const;
  std::shared_ptr<const LivePair> pair_at(double time_s);
  void rethrow_failure();
  void finish();

  LiveRequest request_;
  std::vector<LiveSink*> sinks_;
  std::unique_ptr<flies::PairStream> stream_;
  std::optional<flies::Calibration> calibration_;
  RunDiagnosis diagnosis_;
  std::optional<LaterDiagnosis> later_;  ///< where the first pairs left something to be found
  flies::PairWatch watch_;
  std::uint64_t next_number_ = 0;
  std::uint64_t submitted_ = 0;            ///< pairs, to all workers
  std::uint64_t passed_while_paused_ = 0;  ///< pictures
  std::uint64_t began_ns_ = 0;

  mutable std::mutex mutex_;  ///< of all below
  std::condition_variable changed_;
  std::shared_ptr<const Worker> worker_;  ///< none until the camera is known
  flies::DetectorOptions options_;        ///< as the user set them, then fitted to the camera
  Overrides settings_;                    ///< by `set_option`, the latest of each option
  std::string preset_;                    ///< name of what the user set, without what fits the camera
  flies::TrackerOptions following_;
  bool options_changed_ = false;
  bool is_paused_ = false, is_ending_ = false;
  int steps_ = 0;
  std::vector<std::shared_ptr<const LivePair>> recent_;  ///< the newest last
  std::vector<PassedOver> passed_over_;                  ///< not handed on yet, the newest last
  std::uint64_t awaited_from_ = 0;                       ///< number of the first pair whose result may still come
  std::uint64_t handed_on_ = 0;                          ///< results of the present worker
  flies::PairStreamCounts source_counts_;
  std::exception_ptr failure_;

  std::shared_ptr<const Worker> handing_worker_;   ///< this and the next are of the handing thread
  std::uint64_t last_result_ = 0;                  ///< of that worker
  std::uint64_t last_dropped_ = 0;                 ///< pairs, by that worker up to that result
  std::uint64_t results_ = 0;                      ///< of all workers
  std::uint64_t dropped_before_ = 0;               ///< pairs, by the workers before
  std::uint64_t overtaken_ = 0;                    ///< results that newer ones pushed out before they were handed on
  std::uint64_t ids_before_ = 0, highest_id_ = 0;  ///< of tracks
  std::string first_refusal_;                      ///< of a pair, by an engine
  bool has_results_ = false;                       ///< of pairs that could be used
  flies::DisparityShiftWatch shift_watch_;
  GroundPose pose_;
};
