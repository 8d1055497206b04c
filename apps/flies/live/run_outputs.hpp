#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "channels/channel_sinks.hpp"
#include "channels/queued_sink.hpp"
#include "flies/video/pair_stream.hpp"
#include "live/film_sink.hpp"
#include "live/live_outputs.hpp"
#include "live/live_status.hpp"
#include "live/view.hpp"

/// Who is to get the results, as the command line asks for them; what is empty is not asked for.
struct OutputRequest {
  std::string json, record, video;  ///< files
  std::optional<int> view_port;     ///< of the page
  std::string view_address = "127.0.0.1";
  std::optional<int> foxglove_port;
  std::string foxglove_address = "127.0.0.1";
  bool is_patient = false;  ///< files wait for whoever is slow, and nothing is left out of them
};

/// Everyone who gets the results.
class RunOutputs {
 public:
  /// @throws flies::InputError of a file or a port that cannot be opened
  explicit RunOutputs(const OutputRequest& request);

  const std::vector<LiveSink*>& sinks() const { return sinks_; }
  View* view() { return view_ ? &*view_ : nullptr; }

  /// @throws flies::InputError of the first file that could not be written to its end; the others are closed well
  void finish(const flies::PairStreamCounts& source);

  /// Of a run that failed: what came until then is kept. Of one that could not even begin its lines, because another
  /// run is writing them say, there is no film.
  void close_files();

 private:
  void attempt(const std::function<void()>& close);
  void add_json(const std::string& path);
  void add_view(const flies::WebServerRequest& request);
  void add_foxglove(const std::string& address, int port);
  void add_record(const std::string& path);
  void add_film(const std::string& path);

  QueuedSink::Overflow overflow_;  ///< of what is written to files
  std::optional<JsonSink> json_;
  std::optional<QueuedSink> json_queue_;
  std::optional<TableSink> table_;
  std::optional<View> view_;
  std::optional<FoxgloveSink> foxglove_;
  std::optional<QueuedSink> picture_queue_;
  std::optional<RecordSink> record_;
  std::optional<QueuedSink> record_queue_;
  std::optional<FilmSink> film_;
  std::optional<QueuedSink> film_queue_;
  LiveStatus status_;
  std::vector<LiveSink*> sinks_;
  std::exception_ptr failure_;
};
