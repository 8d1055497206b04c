#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flies/io/gray_image.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/video/capture.hpp"
#include "flies/video/frame_stream.hpp"

namespace flies {

/// Where the two pictures are in one that holds both.
enum class PairLayout { side_by_side, top_bottom };

struct PairStreamRequest {
  std::vector<std::string> sources = {};         ///< films, devices, pipelines: one of both pictures, or left and right
  std::vector<PairPaths> folder = {};            ///< instead of them, image files
  std::vector<double> times_s = {};              ///< of these, ascending; none: they come at an even rate
  PairLayout layout = PairLayout::side_by_side;  ///< of one source; the left picture comes first
  PairReading reading = {};                      ///< how image files hold pairs; `bayer` also of films and devices
  int width_px = 0, height_px = 0;               ///< asked of devices; 0: what they do by themselves
  double rate_hz = 0.0;                          ///< of files and devices; 0: their own
  bool is_looped = false;                        ///< files begin again at their end, two films when the shorter ends
  bool is_patient = false;                       ///< no pair of a file is thrown away, and none is waited for
  double max_skew_s = 0.02;                      ///< pictures of two sources farther apart in time are no pair
  double stuck_s = 5.0, first_pause_s = 0.5;     ///< see FrameStreamOptions
};

/// A pair of a living source or a film.
struct StereoFrame {
  GrayPair images;
  double time_s = 0.0;        ///< of the later of both pictures, since the stream began
  double skew_s = 0.0;        ///< of the right picture after the left one
  std::uint64_t skipped = 0;  ///< pictures so far that were thrown away because newer ones came
  std::string left_name, right_name;
};

struct PairStreamCounts {
  std::uint64_t pairs = 0;
  std::uint64_t broken = 0;    ///< pictures that could not be used
  std::uint64_t skipped = 0;   ///< pictures thrown away because newer ones came
  std::uint64_t unpaired = 0;  ///< pictures of two sources without a partner
  std::uint64_t losses = 0;    ///< how often a source was gone or stuck
};

/// Halves of a picture that holds both.
/// @throws InputError naming `source` when they would differ in size
GrayPair split_picture(const GrayImage& both, PairLayout layout, const std::string& source);

/// What is told of pairs whose pictures are typically too far apart in time for what moves; nothing where they are not.
/// @param skews_s without sign; at least one
std::optional<std::string> skew_note(const std::vector<double>& skews_s);

/// Pairs of whatever gives them, as they come: see `FrameStream` for what happens to sources that fail. Use it from one
/// thread.
class PairStream {
 public:
  /// @throws InputError when a source cannot be opened now
  PairStream(const PairStreamRequest& request, const Tell& tell);
  /// @param readers open the sources of the request, one each
  PairStream(const PairStreamRequest& request, const std::vector<OpenReader>& readers, const Tell& tell);

  /// Waits for the next pair.
  FrameStream::Answer next(StereoFrame& frame, std::chrono::milliseconds timeout);

  PairStreamCounts counts() const;
  bool is_living() const { return is_living_; }  ///< one of its sources at least is

 private:
  FrameStream::Answer next_of_one(StereoFrame& frame, std::chrono::milliseconds timeout);
  FrameStream::Answer next_of_two(StereoFrame& frame, std::chrono::milliseconds timeout);
  bool begin_next_round();
  bool accept(StereoFrame& frame);
  void leave_out(const std::string& why);
  void watch_skew(double skew_s);
  void tell_unpaired(double skew_s);
  void tell_shorter();
  bool is_refused(const SourceFrame& frame);

  PairStreamRequest request_;
  Tell tell_;
  std::vector<std::unique_ptr<FrameStream>> streams_;
  std::optional<SourceFrame> left_, right_;      ///< wait for their partner
  std::chrono::steady_clock::time_point began_;  ///< of the round
  double offset_s_ = 0.0, round_end_s_ = 0.0;    ///< what the rounds before took, and this one as well
  bool is_living_ = false, is_looped_together_ = false;
  PairStreamCounts counts_;
  int width_px_ = 0, height_px_ = 0;  ///< of the first pair
  std::vector<double> skews_s_;       ///< without sign, of the pairs since they were judged
  std::uint64_t unpaired_in_a_row_ = 0;
  bool unpaired_told_ = false, size_told_ = false, skew_told_ = false, shorter_told_ = false;
};

}  // namespace flies
