#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "flies/io/gray_image.hpp"

namespace flies {

/// What one reading gives: a picture, or both of a pair.
struct SourceFrame {
  GrayPair images;                        ///< `right` is empty when the source gives single pictures
  double time_s = 0;                      ///< since the stream began
  double step_s = 0;                      ///< usual time between pictures of the source; 0: not known yet
  std::optional<double> own_time_s = {};  ///< of a file that says when: since its first frame
  std::optional<double> stamp_s = {};     ///< of a film's picture: since the film began, as far as it says
  std::optional<std::chrono::steady_clock::time_point> taken_at = {};  ///< of a living source that says when
  std::uint64_t skipped = 0;  ///< frames of the source so far that were thrown away for newer ones
  bool has_colors = false;    ///< where a mosaic was to come; it is grey, and no pair
  std::string left_name, right_name;
};

/// Something that is open and gives frames one after the other.
class FrameReader {
 public:
  virtual ~FrameReader() = default;
  /// Waits for the next frame and fills in images and names, and its own time, of a broken one too.
  /// @returns false when there is none any more
  /// @throws InputError when this frame is broken; the next may be well
  virtual bool read(SourceFrame& frame) = 0;
  virtual double rate_hz() const = 0;                 ///< frames a second as the source says; 0: it does not say
  virtual std::uint64_t frames() const { return 0; }  ///< of a film, as it says; 0: it does not say
  /// Of a film that ended earlier than it says: some containers only estimate how many pictures there are.
  virtual bool is_incomplete() const { return true; }
};

/// Opens the source, anew each time. @throws InputError when that fails
using OpenReader = std::function<std::unique_ptr<FrameReader>()>;

/// Called with a sentence for the user, from any thread.
using Tell = std::function<void(const std::string&)>;

struct FrameStreamOptions {
  std::string name;         ///< of the source, in what is told
  bool is_living = false;   ///< goes on by itself: frames have the time when they came, and it may come back
  bool is_looped = false;   ///< a file: begins again at its end
  bool is_patient = false;  ///< a file: no frame is ever thrown away, and none is waited for
  double rate_hz = 0.0;     ///< a file: frames a second; 0: its own
  double stuck_s = 5.0;     ///< without a frame for so long a living source is opened anew; longer when that is in vain
  double first_pause_s = 0.5, longest_pause_s = 5.0;  ///< between attempts to open it
};

struct FrameStreamCounts {
  std::uint64_t frames = 0;   ///< read
  std::uint64_t broken = 0;   ///< of them not usable
  std::uint64_t skipped = 0;  ///< thrown away because newer ones came
  std::uint64_t losses = 0;   ///< how often the source was gone or stuck
  double said_s = 0.0;        ///< how long a film says it is; 0: it does not say
  double given_s = 0.0;       ///< of such a film that has ended: how long it was
  double step_s = 0.0;        ///< between pictures of a film
};

/// Whether a film is so much shorter than it or another one says that it is no matter of counting: some containers say
/// only about how many pictures there are.
bool is_shorter(double length_s, double said_s, double step_s);

/// One source, read by a thread of its own. A file gives its frames in its own time. A living source gives the newest,
/// by its own stamps or as they come; when it goes away or is stuck, that is told once and it is opened anew, with
/// pauses, until it is back.
class FrameStream {
 public:
  /// @param began the moment from which times count
  /// @throws InputError when the source cannot be opened now
  FrameStream(OpenReader open, FrameStreamOptions options, Tell tell, std::chrono::steady_clock::time_point began);
  /// Does not wait for a source that is stuck.
  ~FrameStream();
  FrameStream(const FrameStream&) = delete;
  FrameStream& operator=(const FrameStream&) = delete;

  enum class Answer { frame, nothing_yet, ended };
  /// Waits for the next frame.
  Answer next(SourceFrame& frame, std::chrono::milliseconds timeout);

  /// A file begins again now, wherever it was. @param began the moment from which its times count now
  void restart(std::chrono::steady_clock::time_point began);

  FrameStreamCounts counts() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace flies
