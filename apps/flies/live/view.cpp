#include "live/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/web/open_address.hpp"
#include "live/live_outputs.hpp"
#include "live/view_files.hpp"
#include "live/view_state.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::size_t kRecent = 20;              // a page that is slow asks for pictures of a while ago
constexpr std::size_t kRecentBytes = 32U << 20;  // of their pictures, but for a few
constexpr std::size_t kFewestRecent = 4;
constexpr std::chrono::seconds kPageIsThere{10};  // after it asked for something
constexpr std::size_t kMostNotes = 50;
constexpr std::chrono::milliseconds kPatience{1000};
constexpr std::chrono::seconds kRateOver{2};

flies::WebAnswer json_answer(const Json& json) {
  constexpr int kOneLine = -1;
  return {.type = "application/json", .body = json.dump(kOneLine, ' ', false, Json::error_handler_t::replace)};
}

flies::WebAnswer fault(int status, const std::string& why) { return {.status = status, .body = why + "\n"}; }

std::optional<std::uint64_t> number_in(const flies::WebRequest& request, const std::string& name) {
  const auto found = request.parameters.find(name);
  constexpr std::size_t kMostDigits = 18;
  if (found == request.parameters.end() || found->second.empty() || found->second.size() > kMostDigits ||
      !std::ranges::all_of(found->second, [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  return std::stoull(found->second);
}

struct RunOptions {
  flies::DetectorOptions detector;
  flies::TrackerOptions following;

  std::vector<flies::OptionListing> listings() const {
    auto all = flies::list_options(detector);
    for (auto& listing : flies::list_options(following)) all.push_back(std::move(listing));
    return all;
  }
};

}  // namespace

View::View(const flies::WebServerRequest& request) : request_(request), run_id_(flies::random_token()) {
  if (!flies::is_loopback(request.address)) token_ = flies::random_token();
  // Requests that come before the port is known wait for it.
  const std::lock_guard lock(mutex_);
  server_ = flies::serve_web(request, [this](const flies::WebRequest& asked) { return answer(asked); });
  request_.port = server_->port();
  access_.emplace(request_.address, request_.port, token_);
}

View::~View() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  server_.reset();
}

void View::control(LiveRun& run) {
  const std::lock_guard lock(mutex_);
  run_ = &run;
}

void View::release() {
  const std::lock_guard lock(mutex_);
  run_ = nullptr;
}

std::string View::address() const {
  const std::string host = flies::open_address(request_.address);
  const bool is_v6 = host.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/{}{}", is_v6 ? "[" : "", host, is_v6 ? "]" : "", request_.port,
                     token_.empty() ? "" : "?token=", token_);
}

void View::take(const LiveFrame& frame) {
  const auto now = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    if (recent_.empty() || recent_.back().options != frame.options) ++changes_;
    recent_.push_back(frame);
    const std::size_t fitting = std::max(kFewestRecent, kRecentBytes / frame.picture_bytes());
    const std::size_t most = now - asked_ < kPageIsThere ? std::min(kRecent, fitting) : 1;
    while (recent_.size() > most) recent_.pop_front();
    samples_.push_back({now, frame.snapshot->latency_ms});
    while (now - samples_.front().time > kRateOver) samples_.pop_front();
  }
  changed_.notify_all();
}

void View::note(const std::string& sentence) {
  {
    const std::lock_guard lock(mutex_);
    notes_.push_back(sentence);
    if (notes_.size() > kMostNotes) notes_.pop_front();
    ++changes_;
  }
  changed_.notify_all();
}

flies::WebAnswer View::answer(const flies::WebRequest& request) {
  {
    const std::lock_guard lock(mutex_);  // the constructor may still be at it
    asked_ = Clock::now();
  }
  auto refusal = access_->refuse(request);
  flies::WebAnswer answer = refusal ? *refusal : answer_allowed(request);
  if (!refusal) answer.headers.merge(access_->headers());
  return answer;
}

flies::WebAnswer View::answer_allowed(const flies::WebRequest& request) {
  if (request.method == "POST") return order(request);
  for (const auto& file : page_files())
    if (file.path == request.path) return {.type = std::string(file.type), .body = std::string(file.bytes)};
  if (request.path == "/api/state") return state(request);
  if (request.path == "/api/left.jpg") return picture(request);
  if (request.path == "/api/flies") return flies_of(request);
  if (request.path == "/api/report.zip") return report(request);
  return fault(404, "There is no such page.");
}

/// The newest pair and all else, as soon as something differs from what the page has (`after`, `changes`).
flies::WebAnswer View::state(const flies::WebRequest& request) {
  const auto after = number_in(request, "after");
  const auto changes = number_in(request, "changes");
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [&] {
    return is_ending_ || changes != changes_ || (!recent_.empty() && recent_.back().pair->number != after);
  });
  Json state = {{"run", run_id_}, {"changes", changes_}, {"notes", notes_}};
  state["is_paused"] = run_ != nullptr && run_->is_paused();
  std::optional<RunOptions> options;  // listed when nobody waits for the lock
  if (run_ != nullptr && changes != changes_) options = {run_->options(), run_->following()};
  const auto list_options = [&] {
    if (options) state["options"] = view_options(options->listings());
  };
  if (recent_.empty()) {
    lock.unlock();
    list_options();
    return json_answer(state);
  }
  const LiveFrame frame = recent_.back();
  std::vector<double> latencies;
  for (const auto& sample : samples_) latencies.push_back(sample.latency_ms);
  const std::chrono::duration<double> over = samples_.back().time - samples_.front().time;
  ViewRates rates;
  if (over.count() > 0.0) rates.pairs_hz = static_cast<double>(samples_.size() - 1) / over.count();
  rates.latency_ms = *flies::median(latencies);
  rates.latency_p99_ms = flies::quantile(latencies, 0.99);
  const auto source = run_ != nullptr ? run_->source_counts() : flies::PairStreamCounts{};
  lock.unlock();
  list_options();
  state.update(view_frame(frame));
  state["rates"] = {
      {"pairs_hz", rates.pairs_hz}, {"latency_ms", rates.latency_ms}, {"latency_p99_ms", rates.latency_p99_ms},
      {"dropped", frame.dropped},   {"skipped", frame.pair->skipped}, {"broken", source.broken},
      {"losses", source.losses}};
  flies::WebAnswer answer = json_answer(state);
  answer.body.back() = ',';
  answer.body += R"("record":)" + json_line(frame) + "}";
  return answer;
}

std::optional<LiveFrame> View::frame_of(const flies::WebRequest& request) {
  const auto number = number_in(request, "number");
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(
      recent_, number, [](const LiveFrame& frame) { return std::optional<std::uint64_t>(frame.pair->number); });
  return found == recent_.end() ? std::nullopt : std::optional(*found);
}

flies::WebAnswer View::picture(const flies::WebRequest& request) {
  const auto frame = frame_of(request);
  if (!frame) return fault(404, "This pair is no longer available.");
  const auto& bytes = left_jpeg(*frame);
  return {.type = "image/jpeg", .body = std::string(bytes.begin(), bytes.end())};
}

flies::WebAnswer View::flies_of(const flies::WebRequest& request) {
  const auto frame = frame_of(request);
  return frame ? json_answer(view_flies(*frame)) : fault(404, "This pair is no longer available.");
}

flies::WebAnswer View::report(const flies::WebRequest& request) {
  const auto frame = frame_of(request);
  if (!frame) return fault(404, "This pair is no longer available.");
  std::vector<std::string> notes;
  {
    const std::lock_guard lock(mutex_);
    notes.assign(notes_.begin(), notes_.end());
  }
  return {.type = "application/zip",
          .body = view_report(*frame, notes),
          .headers = {
              {"Content-Disposition", fmt::format("attachment; filename=\"flies-pair-{}.zip\"", frame->pair->number)}}};
}

flies::WebAnswer View::order(const flies::WebRequest& request) {
  const Json body = Json::parse(request.body, nullptr, false);
  const auto text = [&](const char* key) {
    if (!body.is_object() || !body.contains(key)) return std::string();
    return body[key].is_string() ? body[key].get<std::string>() : body[key].dump();
  };
  const std::lock_guard lock(mutex_);
  if (run_ == nullptr) return fault(409, "The run has ended.");
  if (request.path == "/api/pause") {
    run_->pause(true);
  } else if (request.path == "/api/resume") {
    run_->pause(false);
  } else if (request.path == "/api/step") {
    run_->step();
  } else if (request.path == "/api/option") {
    try {
      run_->set_option(text("path"), text("value"));
    } catch (const flies::InputError& error) {
      return fault(400, error.what());
    }
  } else {
    return fault(404, "There is no such command.");
  }
  ++changes_;
  changed_.notify_all();
  return json_answer({{"is_paused", run_->is_paused()}});
}
