// The module flies_web: cpp-httplib behind `serve_web`.
#include <httplib.h>

#include <exception>
#include <memory>
#include <thread>
#include <utility>

#include "flies/core/background_thread.hpp"
#include "flies/web/web_server.hpp"

namespace {

constexpr std::size_t kThreads = 16;  // a page that waits for news holds one
constexpr std::size_t kLargestBody = 64 * 1024;

class HttplibServer final : public flies::WebServer {
 public:
  explicit HttplibServer(flies::WebHandler handler) : handler_(std::move(handler)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server_.set_tcp_nodelay(true);
    server_.set_keep_alive_max_count(1000000);
    server_.set_keep_alive_timeout(2);
    server_.set_payload_max_length(kLargestBody);
    // Not httplib's SO_REUSEPORT: two programs would share a port without knowing.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const auto answer = [this](const httplib::Request& request, httplib::Response& response) {
      answer_one(request, response);
    };
    // httplib would wait for the end of a body without a length, which HTTP says is none.
    server_.set_pre_routing_handler([answer](const httplib::Request& request, httplib::Response& response) {
      const bool has_body = request.has_header("Content-Length") || request.has_header("Transfer-Encoding");
      if (request.method != "POST" || has_body) return httplib::Server::HandlerResponse::Unhandled;
      answer(request, response);
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Get(".*", answer);
    server_.Post(".*", answer);
  }
  ~HttplibServer() override {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  HttplibServer(const HttplibServer&) = delete;
  HttplibServer& operator=(const HttplibServer&) = delete;

  bool start(const flies::WebServerRequest& request) {
    if (request.port == 0)
      port_ = server_.bind_to_any_port(request.address);
    else
      port_ = server_.bind_to_port(request.address, request.port) ? request.port : -1;
    if (port_ <= 0) return false;
    thread_ = std::thread([this] {
      flies::yield_to_other_threads();  // pictures are encoded while pages wait; results are not to wait for that
      server_.listen_after_bind();
    });
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  }

  int port() const override { return port_; }

 private:
  void answer_one(const httplib::Request& request, httplib::Response& response) {
    flies::WebRequest asked;
    asked.method = request.method;
    asked.path = request.path;
    for (const auto& [name, value] : request.params) asked.parameters[name] = value;
    asked.body = request.body;
    asked.host = request.get_header_value("Host");
    asked.cookie = request.get_header_value("Cookie");
    asked.page_header = request.get_header_value("X-Flies");
    flies::WebAnswer answer;
    try {
      answer = handler_(asked);
    } catch (const std::exception& error) {
      answer = {.status = 500, .body = std::string("internal error: ") + error.what() + "\n"};
    }
    response.status = answer.status;
    for (const auto& [name, value] : answer.headers) response.set_header(name, value);
    response.set_content(answer.body, answer.type);
  }

  flies::WebHandler handler_;
  httplib::Server server_;
  std::thread thread_;
  int port_ = -1;
};

}  // namespace

extern "C" flies::WebServer* flies_serve_web(const flies::WebServerRequest& request, flies::WebHandler handler) {
  auto server = std::make_unique<HttplibServer>(std::move(handler));
  return server->start(request) ? server.release() : nullptr;
}
