#include "flies/foxglove/foxglove_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>
#include <websocketpp/config/asio_no_tls.hpp>
#include <websocketpp/server.hpp>

#include "flies/core/error.hpp"
#include "flies/core/little_endian.hpp"

namespace flies {
namespace {

using Json = nlohmann::json;
using Server = websocketpp::server<websocketpp::config::asio>;
using Connection = websocketpp::connection_hdl;

constexpr const char* kProtocol = "foxglove.websocket.v1";
constexpr std::size_t kMostKept = 50;           // messages of a channel
constexpr std::size_t kMostWaiting = 8U << 20;  // bytes: a client that far behind misses messages
constexpr std::uint8_t kMessageData = 1;

// This file is C++17: see CMakeLists.txt.
bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

/// A browser page of another site must not read along: it says where it comes from.
bool is_allowed_origin(const std::string& origin) {
  if (origin.empty()) return true;  // no browser
  for (const char* site : {"https://app.foxglove.dev", "https://studio.foxglove.dev"})
    if (origin == site) return true;
  for (const char* program : {"file://", "app://"})
    if (starts_with(origin, program)) return true;
  for (const char* host : {"http://localhost", "http://127.0.0.1"})
    if (origin == host || starts_with(origin, std::string(host) + ":")) return true;
  return false;
}

/// A message of the protocol, without the subscription that it answers.
struct TimedMessage {
  std::uint64_t time_ns = 0;
  std::string text;

  std::string bytes_for(std::uint32_t subscription) const {
    std::string bytes;
    bytes.reserve(1 + 4 + 8 + text.size());
    put_number(bytes, kMessageData, 1);
    put_number(bytes, subscription, 4);
    put_number(bytes, time_ns, 8);
    return bytes += text;
  }
};

}  // namespace

struct FoxgloveServer::State {
  std::vector<FoxgloveChannel> channels;
  Server server;
  int port = 0;
  std::thread thread;

  mutable std::mutex mutex;  ///< of what follows
  /// Subscriptions of each client: number of its own, and channel.
  std::map<Connection, std::map<std::uint32_t, std::size_t>, std::owner_less<Connection>> clients;
  std::map<std::size_t, std::deque<TimedMessage>> kept;  ///< of the channels that keep some, the newest last

  std::string server_info() const {
    return Json{{"op", "serverInfo"},
                {"name", "flies"},
                {"capabilities", Json::array()},
                {"supportedEncodings", {"json"}},
                {"metadata", Json::object()}}
        .dump();
  }

  std::string advertisement() const {
    Json list = Json::array();
    for (std::size_t i = 0; i < channels.size(); ++i)
      list.push_back({{"id", i + 1},
                      {"topic", channels[i].topic},
                      {"encoding", "json"},
                      {"schemaName", channels[i].schema_name},
                      {"schemaEncoding", "jsonschema"},
                      {"schema", channels[i].schema}});
    return Json{{"op", "advertise"}, {"channels", list}}.dump();
  }

  bool validate(const Connection& client) {
    const auto connection = server.get_con_from_hdl(client);
    const auto& offered = connection->get_requested_subprotocols();
    const bool knows = std::find(offered.begin(), offered.end(), kProtocol) != offered.end();
    if (!knows || !is_allowed_origin(connection->get_request_header("Origin"))) return false;
    connection->select_subprotocol(kProtocol);
    return true;
  }

  void open(const Connection& client) {
    {
      const std::lock_guard lock(mutex);
      clients[client];
    }
    server.send(client, server_info(), websocketpp::frame::opcode::text);
    server.send(client, advertisement(), websocketpp::frame::opcode::text);
  }

  void receive(const Connection& client, const std::string& text) {
    const Json order = Json::parse(text, nullptr, false);
    if (!order.is_object() || !order.contains("op")) return;
    std::vector<std::string> earlier;
    obey(client, order, earlier);
    for (const auto& bytes : earlier) send_to(client, bytes);
  }

  /// @param earlier gets the messages that were kept for new subscribers
  void obey(const Connection& client, const Json& order, std::vector<std::string>& earlier) {
    const std::lock_guard lock(mutex);
    auto& subscriptions = clients[client];
    if (order["op"] == "subscribe") {
      for (const auto& wanted : order.value("subscriptions", Json::array())) {
        const auto channel = wanted.value("channelId", std::uint64_t{0});
        if (channel < 1 || channel > channels.size()) continue;
        const auto id = wanted.value("id", std::uint32_t{0});
        const auto index = static_cast<std::size_t>(channel - 1);
        subscriptions[id] = index;
        for (const auto& message : kept[index]) earlier.push_back(message.bytes_for(id));
      }
    } else if (order["op"] == "unsubscribe") {
      for (const auto& id : order.value("subscriptionIds", Json::array()))
        if (id.is_number_unsigned()) subscriptions.erase(id.get<std::uint32_t>());
    }
  }

  void close(const Connection& client) {
    const std::lock_guard lock(mutex);
    clients.erase(client);
  }

  void send_to(const Connection& client, const std::string& bytes) {
    websocketpp::lib::error_code error;
    const auto connection = server.get_con_from_hdl(client, error);
    if (error || connection->get_buffered_amount() > kMostWaiting) return;
    connection->send(bytes.data(), bytes.size(), websocketpp::frame::opcode::binary);
  }

  /// Serves until the server is stopped. A client that leaves while it is answered makes the library throw, which must
  /// end neither the service of the others nor the program.
  void run() {
    for (bool is_stopped = false; !is_stopped;) {
      try {
        server.run();
        is_stopped = true;
      } catch (const std::exception&) {
      }
    }
  }

  void set_up() {
    server.clear_access_channels(websocketpp::log::alevel::all);
    server.clear_error_channels(websocketpp::log::elevel::all);
    server.init_asio();
    server.set_reuse_addr(true);
    constexpr std::size_t kLargestOrder = 1U << 20;
    server.set_max_message_size(kLargestOrder);
    // A message leaves at once and does not wait for the client to confirm the one before.
    server.set_tcp_post_init_handler([this](const Connection& client) {
      websocketpp::lib::error_code error;
      const auto connection = server.get_con_from_hdl(client, error);
      websocketpp::lib::asio::error_code ignored;
      if (!error) connection->get_raw_socket().set_option(websocketpp::lib::asio::ip::tcp::no_delay(true), ignored);
    });
    server.set_validate_handler([this](const Connection& client) { return validate(client); });
    server.set_open_handler([this](const Connection& client) { open(client); });
    server.set_close_handler([this](const Connection& client) { close(client); });
    server.set_fail_handler([this](const Connection& client) { close(client); });
    server.set_message_handler([this](const Connection& client, const Server::message_ptr& message) {
      try {
        receive(client, message->get_payload());
      } catch (const Json::exception&) {  // something else than the protocol's types
      }
    });
  }
};

FoxgloveServer::FoxgloveServer(const std::string& address, int port, std::vector<FoxgloveChannel> channels)
    : state_(std::make_unique<State>()) {
  state_->channels = std::move(channels);
  state_->set_up();
  const std::string place = fmt::format("{}:{}", address, port);
  websocketpp::lib::error_code error;
  websocketpp::lib::asio::error_code address_error;
  const auto ip = websocketpp::lib::asio::ip::make_address(address, address_error);
  if (address_error) throw InputError(place, "", "is no IP address");
  state_->server.listen(websocketpp::lib::asio::ip::tcp::endpoint(ip, static_cast<std::uint16_t>(port)), error);
  if (error)
    throw InputError(place, "",
                     "cannot be listened on: does another program use it, or is it not an address of this machine?");
  state_->port = state_->server.get_local_endpoint(address_error).port();
  state_->server.start_accept(error);
  if (error) throw InputError(place, "", "cannot be listened on: " + error.message());
  state_->thread = std::thread([state = state_.get()] { state->run(); });
}

FoxgloveServer::~FoxgloveServer() {
  state_->server.get_io_service().post([state = state_.get()] {
    websocketpp::lib::error_code ignored;
    state->server.stop_listening(ignored);
    std::vector<Connection> clients;
    {
      const std::lock_guard lock(state->mutex);
      for (const auto& [client, subscriptions] : state->clients) clients.push_back(client);
    }
    for (const auto& client : clients)
      state->server.close(client, websocketpp::close::status::going_away, "flies ends", ignored);
    // Who does not answer the farewell is not waited for.
    state->server.set_timer(500, [state](const websocketpp::lib::error_code&) { state->server.stop(); });
  });
  state_->thread.join();
}

int FoxgloveServer::port() const { return state_->port; }

bool FoxgloveServer::is_wanted(std::size_t channel) const {
  const std::lock_guard lock(state_->mutex);
  for (const auto& [client, subscriptions] : state_->clients)
    for (const auto& [id, wanted] : subscriptions)
      if (wanted == channel) return true;
  return false;
}

void FoxgloveServer::send(std::size_t channel, std::uint64_t time_ns, const std::string& message) {
  const TimedMessage timed{time_ns, message};
  std::vector<std::pair<Connection, std::uint32_t>> receivers;
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->channels[channel].is_kept) {
      auto& kept = state_->kept[channel];
      kept.push_back(timed);
      if (kept.size() > kMostKept) kept.pop_front();
    }
    for (const auto& [client, subscriptions] : state_->clients)
      for (const auto& [id, wanted] : subscriptions)
        if (wanted == channel) receivers.emplace_back(client, id);
  }
  for (const auto& [client, id] : receivers) state_->send_to(client, timed.bytes_for(id));
}

}  // namespace flies
