#include "live/run_outputs.hpp"

#include <cstdio>

#include "flies/web/open_address.hpp"
#include "shared/notes.hpp"

namespace {

constexpr std::size_t kMostPicturesForFoxglove = 2;  // pairs that wait to be sent: what is seen is to be new
constexpr std::size_t kMostForRecord = 60;           // and to be written, recorded or filmed: two seconds at 30 Hz

}  // namespace

RunOutputs::RunOutputs(const OutputRequest& request)
    : overflow_(request.is_patient ? QueuedSink::Overflow::waits : QueuedSink::Overflow::leaves_out),
      status_(!request.json.empty() && request.json != "-") {
  if (!request.json.empty()) add_json(request.json);
  if (request.view_port) add_view({request.view_address, *request.view_port});
  if (request.foxglove_port) add_foxglove(request.foxglove_address, *request.foxglove_port);
  if (!request.record.empty()) add_record(request.record);
  if (!request.video.empty()) add_film(request.video);
  if (sinks_.empty()) sinks_.push_back(&table_.emplace());
  sinks_.push_back(&status_);
}

void RunOutputs::finish(const flies::PairStreamCounts& source) {
  close_files();
  if (failure_) std::rethrow_exception(failure_);
  status_.finish(source);
}

void RunOutputs::close_files() {
  if (record_queue_) attempt([this] { record_queue_->finish(); });
  if (record_) attempt([this] { record_->close(); });
  if (json_queue_) attempt([this] { json_queue_->finish(); });  // late: whoever reads them may hang
  if (film_queue_) attempt([this] { film_queue_->finish(); });
  if (film_ && (!json_ || json_->has_begun())) attempt([this] { film_->finish(); });
}

/// What fails first is kept, to be told when all was tried.
void RunOutputs::attempt(const std::function<void()>& close) {
  try {
    close();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
  }
}

/// Whoever reads slowly, or a disk that hangs, holds up nobody else.
void RunOutputs::add_json(const std::string& path) {
  json_.emplace(path);
  sinks_.push_back(&json_queue_.emplace(*json_, kMostForRecord, QueuedSink::Haste::is_awaited, overflow_, [path] {
    say_notes({(path == "-" ? "standard output" : path) + ": cannot be written fast enough; some pairs are left out"});
  }));
}

void RunOutputs::add_view(const flies::WebServerRequest& request) {
  sinks_.push_back(&view_.emplace(request));
  std::fprintf(stderr, "flies: page at %s\n", view_->address().c_str());
}

void RunOutputs::add_foxglove(const std::string& address, int port) {
  foxglove_.emplace(address, port);
  // First of all and in the thread that has them: results leave at once, and do not wait for pictures to be encoded.
  // The other outputs wait for the messages of these results to be made.
  sinks_.insert(sinks_.begin(), &*foxglove_);
  sinks_.push_back(
      &picture_queue_.emplace(foxglove_->pictures(), kMostPicturesForFoxglove, QueuedSink::Haste::can_wait));
  std::fprintf(stderr, "flies: Foxglove at ws://%s:%d\n", flies::open_address(address).c_str(), foxglove_->port());
}

void RunOutputs::add_record(const std::string& path) {
  record_.emplace(path);
  sinks_.push_back(&record_queue_.emplace(*record_, kMostForRecord, QueuedSink::Haste::can_wait, overflow_, [path] {
    say_notes({path + ": this machine is too slow to record every pair; some are left out"});
  }));
}

void RunOutputs::add_film(const std::string& path) {
  film_.emplace(path);
  sinks_.push_back(&film_queue_.emplace(*film_, kMostForRecord, QueuedSink::Haste::can_wait, overflow_, [path] {
    say_notes({path + ": this machine is too slow to film every pair; some are left out"});
  }));
}
