#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/foxglove/foxglove_server.hpp"
#include "flies/record/mcap_writer.hpp"
#include "live/live_frame.hpp"

/// Everything that `flies live` knows, for Foxglove and Lichtblick: `--foxglove`.
class FoxgloveSink final : public LiveSink {
 public:
  /// @throws flies::InputError when the port cannot be had
  FoxgloveSink(const std::string& address, int port);
  /// Sends results, without pictures and flies.
  void take(const LiveFrame& frame) override;
  void note(const std::string& sentence) override;
  LiveSink& pictures() { return pictures_; }  ///< sends these; for a thread of its own
  int port() const { return server_.port(); }

 private:
  class Pictures final : public LiveSink {
   public:
    explicit Pictures(flies::FoxgloveServer& server) : server_(server) {}
    void take(const LiveFrame& frame) override;

   private:
    flies::FoxgloveServer& server_;
  };

  flies::FoxgloveServer server_;
  Pictures pictures_;
};

/// The same as a recording: `--record`. A run that has no result leaves a file of an earlier one alone.
class RecordSink final : public LiveSink {
 public:
  explicit RecordSink(std::string path) : path_(std::move(path)) {}
  /// @throws flies::InputError when the file cannot be created, the disk is full or the like
  void take(const LiveFrame& frame) override;
  /// What goes wrong here is told by the next `take` or `close`.
  void note(const std::string& sentence) override;
  /// @throws flies::InputError when the disk is full or the like
  void close();

 private:
  void open();

  std::string path_;
  std::mutex mutex_;                                                ///< of what follows: notes come from any thread
  std::uint64_t newest_ns_ = 0;                                     ///< of the pairs; 0: none came yet
  std::vector<std::pair<std::uint64_t, std::string>> early_notes_;  ///< time and message, before there is a file
  std::optional<flies::McapWriter> writer_;                         ///< from the first result on
};
