#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace flies {

/// A topic as Foxglove and Lichtblick know it; messages are JSON.
struct FoxgloveChannel {
  std::string topic;
  std::string schema_name;  ///< "foxglove.LaserScan"
  std::string schema;       ///< JSON Schema
  bool is_kept = false;     ///< who subscribes gets the last 50 messages at once
};

/// A server of Foxglove's WebSocket protocol (subprotocol foxglove.websocket.v1), with a thread of its own. Only who
/// subscribed to a channel gets its messages; a client that is too slow misses some.
class FoxgloveServer {
 public:
  /// @param port 0: any that is free
  /// @throws InputError naming address and port when they cannot be had
  FoxgloveServer(const std::string& address, int port, std::vector<FoxgloveChannel> channels);
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  int port() const;

  /// Whether anyone wants it; else it need not be made.
  bool is_wanted(std::size_t channel) const;

  /// Hands a message to those who want it. From any thread; does not wait for them.
  /// @param time_ns since 1970
  void send(std::size_t channel, std::uint64_t time_ns, const std::string& message);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace flies
