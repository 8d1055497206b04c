#include "flies/video/pair_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/video/pair_folder.hpp"

namespace flies {
namespace {

using Answer = FrameStream::Answer;

constexpr std::size_t kSkewsToJudge = 30;
constexpr double kSkewMatters_s = 0.002;
constexpr std::uint64_t kUnpairedToTell = 10;

/// Pictures of one film, device or pipeline.
class CaptureReader final : public FrameReader {
 public:
  CaptureReader(std::unique_ptr<Capture> capture, std::string name, std::optional<BayerPattern> bayer)
      : capture_(std::move(capture)), name_(std::move(name)), bayer_(bayer) {}
  bool read(SourceFrame& frame) override {
    frame.left_name = frame.right_name = name_;
    if (!capture_->read(frame.images.left)) return false;
    if (bayer_) frame.images.left = demosaiced(std::move(frame.images.left), *bayer_);
    return true;
  }
  double rate_hz() const override { return capture_->rate_hz(); }

 private:
  std::unique_ptr<Capture> capture_;
  std::string name_;
  std::optional<BayerPattern> bayer_;
};

FrameStreamOptions stream_options(const PairStreamRequest& request, const std::string& name, bool is_living_source) {
  FrameStreamOptions options;
  options.name = name;
  options.is_living = is_living_source;
  options.is_looped = request.is_looped;
  options.is_patient = request.is_patient;
  options.rate_hz = request.rate_hz;
  options.stuck_s = request.stuck_s;
  options.first_pause_s = request.first_pause_s;
  return options;
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

PairStream::PairStream(const PairStreamRequest& request, const Tell& tell) : request_(request), tell_(tell) {
  const auto began = std::chrono::steady_clock::now();
  if (!request.folder.empty()) {
    constexpr double kUsualRate_hz = 10.0;
    const auto open = [pairs = request.folder, reading = request.reading,
                       rate_hz = request.rate_hz > 0.0 ? request.rate_hz : kUsualRate_hz] {
      return std::make_unique<PairFolder>(pairs, reading, rate_hz);
    };
    streams_.push_back(
        std::make_unique<FrameStream>(open, stream_options(request, request.folder.front().left, false), tell, began));
    return;
  }
  if (request.sources.empty() || request.sources.size() > 2)
    throw InputError("sources", "", fmt::format("found {}, expected one or two", request.sources.size()));
  for (const auto& source : request.sources) {
    const auto open = [capture = CaptureRequest{.source = source,
                                                .width_px = request.width_px,
                                                .height_px = request.height_px,
                                                .rate_hz = request.rate_hz},
                       bayer = request.reading.bayer] {
      return std::make_unique<CaptureReader>(open_capture(capture), capture.source, bayer);
    };
    const bool living = is_living(source_kind(source));
    streams_.push_back(std::make_unique<FrameStream>(open, stream_options(request, source, living), tell, began));
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
  frame.time_s = read.time_s;
  frame.skew_s = 0.0;
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
  const auto until = std::chrono::steady_clock::now() + timeout;
  const auto fill = [&](FrameStream& stream, std::optional<SourceFrame>& place) {
    if (place) return Answer::frame;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    SourceFrame read;
    const Answer answer = stream.next(read, std::max(left, std::chrono::milliseconds(0)));
    if (answer == Answer::frame) place = std::move(read);
    return answer;
  };
  while (true) {
    const Answer left = fill(*streams_[0], left_), right = fill(*streams_[1], right_);
    if (left == Answer::ended || right == Answer::ended) return Answer::ended;
    if (left != Answer::frame || right != Answer::frame) return Answer::nothing_yet;
    const double skew_s = right_->time_s - left_->time_s;
    if (std::abs(skew_s) <= request_.max_skew_s) break;
    (skew_s > 0.0 ? left_ : right_).reset();
    ++counts_.unpaired;
    tell_unpaired(skew_s);
  }
  unpaired_in_a_row_ = 0;
  frame.time_s = std::max(left_->time_s, right_->time_s);
  frame.skew_s = right_->time_s - left_->time_s;
  frame.images.left = std::move(left_->images.left);
  frame.images.right = std::move(right_->images.left);
  frame.left_name = left_->left_name;
  frame.right_name = right_->left_name;
  left_.reset();
  right_.reset();
  watch_skew(frame.skew_s);
  return Answer::frame;
}

/// Pictures that change their size are broken.
bool PairStream::accept(StereoFrame& frame) {
  const auto& [left, right] = std::pair(frame.images.view().left, frame.images.view().right);
  if (width_px_ == 0) {
    check_pair({left, right}, frame.left_name, frame.right_name);
    width_px_ = left.width_px;
    height_px_ = left.height_px;
  }
  if (left.width_px == width_px_ && left.height_px == height_px_ && right.width_px == width_px_ &&
      right.height_px == height_px_)
    return true;
  leave_out(fmt::format("{}: size: found {} x {} px, expected {} x {} px as before", frame.left_name, left.width_px,
                        left.height_px, width_px_, height_px_));
  return false;
}

void PairStream::leave_out(const std::string& why) {
  ++counts_.broken;
  if (!std::exchange(size_told_, true)) tell_(why + "; left out, as all such pictures will be");
}

void PairStream::watch_skew(double skew_s) {
  if (first_skews_s_.size() >= kSkewsToJudge) return;
  first_skews_s_.push_back(skew_s);
  if (first_skews_s_.size() < kSkewsToJudge) return;
  std::vector<double> sizes_s;
  for (const double first_s : first_skews_s_) sizes_s.push_back(std::abs(first_s));
  const double median_s = upper_median(std::move(sizes_s));
  if (median_s < kSkewMatters_s) return;
  tell_(
      fmt::format("left and right pictures are {:.1f} ms apart (median of {}): what moves, and all when the camera "
                  "moves, gets a wrong range; a common trigger helps",
                  1e3 * median_s, kSkewsToJudge));
}

void PairStream::tell_unpaired(double skew_s) {
  if (++unpaired_in_a_row_ < kUnpairedToTell || std::exchange(unpaired_told_, true)) return;
  tell_(
      fmt::format("{} and {}: pictures are {:.0f} ms apart and make no pair, at most {:g} ms are allowed (--max-skew)",
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
