#include "flies/video/capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <thread>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/waiting.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/placeholder.hpp"
#include "flies/video/lazy_module.hpp"

namespace flies {
namespace {

std::string complaint(SourceKind kind) {
  switch (kind) {
    case SourceKind::device:
      return "no camera that can be opened; is it plugged in, does another program use it, do you have permission to "
             "read it?";
    case SourceKind::stream:
      return "cannot be opened; does it play with gst-launch-1.0 or ffplay?";
    case SourceKind::file:
      break;
  }
  return "cannot be read as a film";
}

/// Openings that nobody waits for any more. They cannot be ended, so there must not be ever more of them.
std::atomic<int> abandoned_openings = 0;
constexpr int kMostAbandoned = 4;

/// Opens in a thread of its own. @throws InputError when that takes too long
std::unique_ptr<Capture> open_in_time(OpenCaptureFunction open, const CaptureRequest& request, SourceKind kind) {
  if (abandoned_openings >= kMostAbandoned)
    throw InputError(request.source, "", "earlier attempts to open it have not ended yet");
  auto promise = std::make_shared<std::promise<std::unique_ptr<Capture>>>();
  auto opened = promise->get_future();
  // Whoever comes second, the opening or the end of patience, knows of the other.
  enum class State { pending, done, abandoned };
  const auto state = std::make_shared<std::atomic<State>>(State::pending);
  std::thread([open, request, kind, promise, state] {
    promise->set_value(std::unique_ptr<Capture>(open(request, kind)));
    if (state->exchange(State::done) == State::abandoned) --abandoned_openings;
  }).detach();
  if (opened.wait_for(detail::bounded_wait(std::chrono::duration<double>(request.patience_s))) ==
      std::future_status::ready)
    return opened.get();
  ++abandoned_openings;
  if (state->exchange(State::abandoned) == State::done) {
    --abandoned_openings;
    return opened.get();
  }
  throw InputError(request.source, "",
                   fmt::format("was not open after {:g} s; {}", request.patience_s, complaint(kind)));
}

}  // namespace

SourceKind source_kind(const std::string& source) {
  const bool is_number =
      !source.empty() && source.size() <= 3 && std::ranges::all_of(source, [](char c) { return c >= '0' && c <= '9'; });
  if (is_number || source.starts_with("/dev/")) return SourceKind::device;
  if (source.find('!') != std::string::npos || source.find("://") != std::string::npos) return SourceKind::stream;
  return SourceKind::file;
}

std::unique_ptr<Capture> open_capture(const CaptureRequest& request) {
  const SourceKind kind = source_kind(request.source);
  if (request.source.empty()) throw InputError("source", "", "is empty");
  if (kind == SourceKind::file && !detail::is_there(request.source))
    throw InputError(request.source, "", "does not exist");
  if (kind == SourceKind::file)
    if (const auto fault = detail::placeholder_fault_of_file(request.source); !fault.empty())
      throw InputError(request.source, "", fault);
  const auto open = reinterpret_cast<OpenCaptureFunction>(module_function("flies_video", kOpenCaptureName));
  auto capture = open_in_time(open, request, kind);
  if (!capture) throw InputError(request.source, "", complaint(kind));
  return capture;
}

}  // namespace flies
