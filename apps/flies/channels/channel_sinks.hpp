#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "flies/foxglove/foxglove_server.hpp"
#include "flies/record/mcap_writer.hpp"
#include "live/live_frame.hpp"

/// Everything that `flies live` knows, for Foxglove and Lichtblick: `--foxglove`.
class FoxgloveSink final : public LiveSink {
 public:
  /// @throws flies::InputError when the port cannot be had
  FoxgloveSink(const std::string& address, int port);
  void take(const LiveFrame& frame) override;
  void note(const std::string& sentence) override;
  int port() const { return server_.port(); }

 private:
  flies::FoxgloveServer server_;
};

/// The same as a recording: `--record`.
class RecordSink final : public LiveSink {
 public:
  /// @throws flies::InputError when the file cannot be created
  explicit RecordSink(const std::string& path);
  void take(const LiveFrame& frame) override;
  void note(const std::string& sentence) override;
  /// @throws flies::InputError when the disk is full or the like
  void close();

 private:
  std::mutex mutex_;             ///< of what follows: notes come from any thread
  std::uint64_t newest_ns_ = 0;  ///< of the pairs; 0: none came yet
  flies::McapWriter writer_;
};
