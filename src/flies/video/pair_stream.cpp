#include "flies/video/pair_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/core/waiting.hpp"
#include "flies/video/film_size.hpp"
#include "flies/video/pair_folder.hpp"

namespace flies {
namespace {

using Answer = FrameStream::Answer;

constexpr std::size_t kSkewsToJudge = 30;
constexpr double kSkewMatters_s = 0.002;
constexpr std::uint64_t kUnpairedToTell = 10;
// More than half: pictures half a step apart are not to change partners with every little delay.
constexpr double kMostSkewInSteps = 0.6;

/// Pictures of one film, device or pipeline.
class CaptureReader final : public FrameReader {
 public:
  CaptureReader(std::unique_ptr<Capture> capture, std::string name, std::optional<BayerPattern> bayer)
      : capture_(std::move(capture)), name_(std::move(name)), bayer_(bayer) {}
  bool read(SourceFrame& frame) override {
    frame.left_name = frame.right_name = name_;
    if (!capture_->read(frame.images.left)) return false;
    frame.taken_at = capture_->taken_at();
    frame.stamp_s = capture_->stamp_s();
    frame.has_colors = bayer_ && capture_->has_colors();
    if (bayer_ && !frame.has_colors) frame.images.left = demosaiced(std::move(frame.images.left), *bayer_);
    return true;
  }
  double rate_hz() const override { return capture_->rate_hz(); }
  std::uint64_t frames() const override { return capture_->pictures(); }
  bool is_incomplete() const override { return lacks_its_end(name_); }

 private:
  std::unique_ptr<Capture> capture_;
  std::string name_;
  std::optional<BayerPattern> bayer_;
};

bool is_living_source(const std::string& source) { return is_living(source_kind(source)); }

/// Whether it is a film or a camera shows when it is open.
bool is_web_address(const std::string& source) {
  return source_kind(source) == SourceKind::stream && source.starts_with("http");
}

/// Gives what is open already, and opens it anew from the second time on.
OpenReader opener_after(std::unique_ptr<FrameReader> opened, OpenReader open) {
  const auto first = std::make_shared<std::unique_ptr<FrameReader>>(std::move(opened));
  return [first, open = std::move(open)] { return *first ? std::move(*first) : open(); };
}

FrameStreamOptions stream_options(const PairStreamRequest& request, const std::string& name, bool lives,
                                  bool is_looped) {
  FrameStreamOptions options;
  options.name = name;
  options.is_living = lives;
  options.is_looped = is_looped;
  options.is_patient = request.is_patient;
  options.rate_hz = request.rate_hz;
  options.stuck_s = request.stuck_s;
  options.first_pause_s = request.first_pause_s;
  return options;
}

OpenReader folder_opener(const PairStreamRequest& request) {
  constexpr double kUsualRate_hz = 10.0;
  return [pairs = request.folder, reading = request.reading, times_s = request.times_s,
          rate_hz = request.rate_hz > 0.0 ? request.rate_hz : kUsualRate_hz] {
    return std::make_unique<PairFolder>(pairs, reading, rate_hz, times_s);
  };
}

OpenReader capture_opener(const PairStreamRequest& request, const std::string& source) {
  return [capture = CaptureRequest{.source = source,
                                   .width_px = request.width_px,
                                   .height_px = request.height_px,
                                   .rate_hz = request.rate_hz},
          bayer = request.reading.bayer] {
    return std::make_unique<CaptureReader>(open_capture(capture), capture.source, bayer);
  };
}

std::vector<OpenReader> openers(const PairStreamRequest& request) {
  if (!request.folder.empty()) return {folder_opener(request)};
  std::vector<OpenReader> result;
  for (const auto& source : request.sources) result.push_back(capture_opener(request, source));
  return result;
}

/// The next picture of its source is due nearer to the later one, `skew_s` after this.
bool has_nearer_successor(const SourceFrame& earlier, double skew_s) {
  return earlier.step_s > 0.0 && skew_s > kMostSkewInSteps * earlier.step_s;
}

GrayImage part(const GrayImage& image, int u, int v, int width, int height) {
  GrayImage result{width, height, {}};
  result.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row)
    std::memcpy(result.pixels.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width),
                image.pixels.data() + static_cast<std::size_t>(v + row) * static_cast<std::size_t>(image.width_px) + u,
                static_cast<std::size_t>(width));
  return result;
}

}  // namespace

GrayPair split_picture(const GrayImage& both, PairLayout layout, const std::string& source) {
  const bool is_beside = layout == PairLayout::side_by_side;
  const int whole = is_beside ? both.width_px : both.height_px;
  if (whole % 2 != 0 || whole == 0)
    throw InputError(source, is_beside ? "width" : "height",
                     fmt::format("found {} px, expected an even number: both pictures {}", whole,
                                 is_beside ? "side by side" : "one above the other"));
  const int width = is_beside ? whole / 2 : both.width_px, height = is_beside ? both.height_px : whole / 2;
  GrayPair pair;
  pair.left = part(both, 0, 0, width, height);
  pair.right = part(both, is_beside ? width : 0, is_beside ? 0 : height, width, height);
  return pair;
}

std::optional<std::string> skew_note(const std::vector<double>& skews_s) {
  const double median_s = upper_median(skews_s);
  if (median_s < kSkewMatters_s) return std::nullopt;
  return fmt::format(
      "left and right pictures are {:.1f} ms apart (median of {}): things that move, and everything when the camera "
      "moves, get wrong ranges; trigger both cameras together",
      1e3 * median_s, skews_s.size());
}

PairStream::PairStream(const PairStreamRequest& request, const Tell& tell)
    : PairStream(request, openers(request), tell) {}

PairStream::PairStream(const PairStreamRequest& request, const std::vector<OpenReader>& readers, const Tell& tell)
    : request_(request), tell_(tell), began_(std::chrono::steady_clock::now()) {
  if (readers.empty() || readers.size() > 2)
    throw InputError("sources", "", fmt::format("found {}, expected one or two", readers.size()));
  const bool is_folder = !request.folder.empty();
  std::vector<OpenReader> openers = readers;
  std::vector<bool> lives;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    lives.push_back(!is_folder && is_living_source(request.sources[i]));
    if (!lives[i] || !is_web_address(request.sources[i])) continue;
    auto reader = readers[i]();
    lives[i] = reader->frames() == 0;
    openers[i] = opener_after(std::move(reader), readers[i]);
  }
  is_living_ = std::ranges::find(lives, true) != lives.end();
  is_looped_together_ = request.is_looped && readers.size() == 2 && !is_living_;
  const bool is_looped = request.is_looped && !is_looped_together_;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    const std::string& name = is_folder ? request.folder.front().left : request.sources[i];
    streams_.push_back(
        std::make_unique<FrameStream>(openers[i], stream_options(request, name, lives[i], is_looped), tell, began_));
  }
}

Answer PairStream::next(StereoFrame& frame, std::chrono::milliseconds timeout) {
  const Answer answer = streams_.size() == 1 ? next_of_one(frame, timeout) : next_of_two(frame, timeout);
  if (answer != Answer::frame) return answer;
  if (!accept(frame)) return Answer::nothing_yet;
  ++counts_.pairs;
  return Answer::frame;
}

Answer PairStream::next_of_one(StereoFrame& frame, std::chrono::milliseconds timeout) {
  SourceFrame read;
  const Answer answer = streams_[0]->next(read, timeout);
  if (answer != Answer::frame) return answer;
  if (is_refused(read)) return Answer::nothing_yet;
  frame.time_s = read.time_s;
  frame.skew_s = 0.0;
  frame.skipped = read.skipped;
  try {
    frame.images = read.images.right.pixels.empty() ? split_picture(read.images.left, request_.layout, read.left_name)
                                                    : std::move(read.images);
  } catch (const InputError& error) {
    if (width_px_ == 0) throw;
    leave_out(error.what());
    return Answer::nothing_yet;
  }
  frame.left_name = std::move(read.left_name);
  frame.right_name = std::move(read.right_name);
  return Answer::frame;
}

Answer PairStream::next_of_two(StereoFrame& frame, std::chrono::milliseconds timeout) {
  const auto until = std::chrono::steady_clock::now() + detail::bounded_wait(timeout);
  const auto fill = [&](FrameStream& stream, std::optional<SourceFrame>& place) {
    if (place) return Answer::frame;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    SourceFrame read;
    const Answer answer = stream.next(read, std::max(left, std::chrono::milliseconds(0)));
    if (answer != Answer::frame) return answer;
    if (is_refused(read)) return Answer::nothing_yet;
    place = std::move(read);
    return answer;
  };
  while (true) {
    const Answer left = fill(*streams_[0], left_), right = fill(*streams_[1], right_);
    if (left == Answer::ended || right == Answer::ended) {
      if (left != right) tell_shorter();
      if (!begin_next_round()) return Answer::ended;
      continue;
    }
    if (left != Answer::frame || right != Answer::frame) return Answer::nothing_yet;
    const double skew_s = right_->time_s - left_->time_s;
    const bool is_too_far = std::abs(skew_s) > request_.max_skew_s;
    auto& earlier = skew_s > 0.0 ? left_ : right_;
    if (!is_too_far && !has_nearer_successor(*earlier, std::abs(skew_s))) break;
    earlier.reset();
    ++counts_.unpaired;
    if (is_too_far) tell_unpaired(skew_s);
  }
  unpaired_in_a_row_ = 0;
  frame.time_s = offset_s_ + std::max(left_->time_s, right_->time_s);
  round_end_s_ = frame.time_s + std::max(left_->step_s, right_->step_s);
  frame.skew_s = right_->time_s - left_->time_s;
  frame.skipped = left_->skipped + right_->skipped;
  frame.images.left = std::move(left_->images.left);
  frame.images.right = std::move(right_->images.left);
  frame.left_name = left_->left_name;
  frame.right_name = right_->left_name;
  left_.reset();
  right_.reset();
  watch_skew(frame.skew_s);
  return Answer::frame;
}

/// Two films begin again together, as pictures of different rounds are no pair.
/// @returns false when they do not, or when this round had no pair
bool PairStream::begin_next_round() {
  if (!is_looped_together_ || round_end_s_ <= offset_s_) return false;
  began_ += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(round_end_s_ - offset_s_));
  offset_s_ = round_end_s_;
  left_.reset();
  right_.reset();
  for (const auto& stream : streams_) stream->restart(began_);
  return true;
}

/// Colours where a mosaic was to come are no mosaic.
/// @throws InputError before the first pair
bool PairStream::is_refused(const SourceFrame& frame) {
  if (!frame.has_colors) return false;
  const InputError fault(frame.left_name, "pixels", "found colours, expected the grey levels of a mosaic (--bayer)");
  if (width_px_ == 0) throw InputError(fault);
  leave_out(fault.what());
  return true;
}

/// Pictures that change their size are broken.
bool PairStream::accept(StereoFrame& frame) {
  const auto& [left, right] = std::pair(frame.images.view().left, frame.images.view().right);
  if (width_px_ == 0) {
    check_pair({left, right}, frame.left_name, frame.right_name);
    width_px_ = left.width_px;
    height_px_ = left.height_px;
  }
  const auto fits = [&](const GrayView& image) { return image.width_px == width_px_ && image.height_px == height_px_; };
  if (fits(left) && fits(right)) return true;
  const bool is_left = !fits(left);
  const GrayView& other = is_left ? left : right;
  leave_out(fmt::format("{}: size: found {} x {} px, expected {} x {} px as before",
                        is_left ? frame.left_name : frame.right_name, other.width_px, other.height_px, width_px_,
                        height_px_));
  return false;
}

void PairStream::leave_out(const std::string& why) {
  ++counts_.broken;
  if (!std::exchange(size_told_, true)) tell_(why + "; it is left out, and so are all others like it");
}

void PairStream::watch_skew(double skew_s) {
  if (skew_told_) return;
  skews_s_.push_back(std::abs(skew_s));
  if (skews_s_.size() < kSkewsToJudge) return;
  const auto note = skew_note(std::exchange(skews_s_, {}));
  if (!note) return;
  skew_told_ = true;
  tell_(*note);
}

/// Of two films one has ended.
void PairStream::tell_shorter() {
  if (shorter_told_) return;
  for (const std::size_t i : {0U, 1U}) {
    const auto ended = streams_[i]->counts(), other = streams_[1 - i]->counts();
    if (ended.given_s <= 0.0 || !is_shorter(ended.given_s, other.said_s, other.step_s)) continue;
    shorter_told_ = true;
    tell_(fmt::format(
        "{}: ends after {:.2f} s, while {} is {:.2f} s long: later pictures of that have no partner (if one "
        "film began later than the other, cut both to the same beginning)",
        request_.sources[i], ended.given_s, request_.sources[1 - i], other.said_s));
    return;
  }
}

void PairStream::tell_unpaired(double skew_s) {
  if (++unpaired_in_a_row_ < kUnpairedToTell || std::exchange(unpaired_told_, true)) return;
  tell_(
      fmt::format("{} and {}: pictures are {:.0f} ms apart and make no pair; at most {:g} ms are allowed (--max-skew)",
                  request_.sources[0], request_.sources[1], 1e3 * std::abs(skew_s), 1e3 * request_.max_skew_s));
}

PairStreamCounts PairStream::counts() const {
  PairStreamCounts counts = counts_;
  for (const auto& stream : streams_) {
    const auto own = stream->counts();
    counts.broken += own.broken;
    counts.skipped += own.skipped;
    counts.losses += own.losses;
  }
  return counts;
}

}  // namespace flies
