#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "flies/foxglove/foxglove_server.hpp"
#include "flies/record/mcap_writer.hpp"
#include "live_frame.hpp"

/// Everything that `flies live` knows, for Foxglove and Lichtblick: `--foxglove`.
class FoxgloveSink final : public LiveSink {
 public:
  /// @throws flies::InputError when the port cannot be had
  FoxgloveSink(const std::string& address, int port);
  void take(const LiveFrame& frame) override;
  void note(const std::string& sentence) override;
  int port() const { return server_.port(); }

 private:
  std::uint64_t began_ns_;
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
  std::uint64_t began_ns_;
  double newest_s_ = 0.0;
  std::mutex mutex_;  ///< of the writer: notes come from any thread
  flies::McapWriter writer_;
};
