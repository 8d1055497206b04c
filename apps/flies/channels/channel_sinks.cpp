#include "channels/channel_sinks.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>
#include <vector>

#include "channels/channel_schemas.hpp"
#include "channels/channels.hpp"
#include "flies/core/error.hpp"

namespace {

constexpr auto kLog = static_cast<std::size_t>(Channel::log);

std::uint64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

template <class Described>
std::vector<Described> described_channels() {
  std::vector<Described> channels;
  for (const auto& [topic, name] : kChannels)
    channels.push_back({std::string(topic), std::string(name), channel_schema(std::string(name))});
  return channels;
}

constexpr bool leaves_once(Channel channel) {
  const auto times = std::ranges::count(kResultChannels, channel) + std::ranges::count(kPictureChannels, channel);
  return times == (channel == Channel::log ? 0 : 1);
}

/// To those who subscribed.
void send_wanted(flies::FoxgloveServer& server, std::span<const Channel> channels, const LiveFrame& frame) {
  const std::uint64_t time_ns = time_ns_of(frame);
  for (const Channel channel : channels) {
    const auto i = static_cast<std::size_t>(channel);
    if (server.is_wanted(i)) server.send(i, time_ns, channel_message(channel, frame));
  }
}

/// Notes are told mostly in the first second, before anybody is there to read them.
std::vector<flies::FoxgloveChannel> served_channels() {
  auto channels = described_channels<flies::FoxgloveChannel>();
  channels[kLog].is_kept = true;
  return channels;
}
static_assert(
    [] {
      for (std::size_t i = 0; i < kChannels.size(); ++i)
        if (!leaves_once(static_cast<Channel>(i))) return false;
      return true;
    }(),
    "every channel of pairs leaves once");

}  // namespace

FoxgloveSink::FoxgloveSink(const std::string& address, int port)
    : server_(address, port, served_channels()), pictures_(server_) {}

void FoxgloveSink::take(const LiveFrame& frame) { send_wanted(server_, kResultChannels, frame); }

void FoxgloveSink::Pictures::take(const LiveFrame& frame) { send_wanted(server_, kPictureChannels, frame); }

void FoxgloveSink::note(const std::string& sentence) {
  const std::uint64_t time_ns = now_ns();
  server_.send(kLog, time_ns, log_message(sentence, time_ns));
}

void RecordSink::open() {
  writer_.emplace(path_, described_channels<flies::McapChannel>());
  for (const auto& [time_ns, message] : early_notes_) writer_->write(kLog, time_ns, message);
  early_notes_.clear();
}

void RecordSink::take(const LiveFrame& frame) {
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    const auto channel = static_cast<Channel>(i);
    if (channel == Channel::log) continue;
    const std::string message = channel_message(channel, frame);
    const std::lock_guard lock(mutex_);
    newest_ns_ = time_ns_of(frame);
    if (!writer_) open();
    writer_->write(i, newest_ns_, message);
  }
}

void RecordSink::note(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t time_ns = newest_ns_ == 0 ? now_ns() : newest_ns_;
  std::string message = log_message(sentence, time_ns);
  if (!writer_) {
    early_notes_.emplace_back(time_ns, std::move(message));
    return;
  }
  try {
    writer_->write(kLog, time_ns, message);
  } catch (const flies::InputError&) {  // the writer throws it again, to a thread that can end the run
  }
}

void RecordSink::close() {
  const std::lock_guard lock(mutex_);
  if (writer_) writer_->close();
}
