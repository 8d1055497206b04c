#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace flies {

/// What a browser asks for.
struct WebRequest {
  std::string method;                             ///< "GET", "HEAD" or "POST"
  std::string path;                               ///< "/page.js"
  std::map<std::string, std::string> parameters;  ///< of the address, after the question mark
  std::string body;
  std::string host, cookie, page_header;  ///< headers Host, Cookie and X-Flies
};

struct WebAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::map<std::string, std::string> headers = {};
};

/// Answers one request; called from several threads at once.
using WebHandler = std::function<WebAnswer(const WebRequest&)>;

struct WebServerRequest {
  std::string address = "127.0.0.1";
  int port = 0;  ///< 0: any that is free
};

/// A small HTTP server with threads of its own, until it is destroyed.
class WebServer {
 public:
  virtual ~WebServer() = default;
  virtual int port() const = 0;
};

/// Starts a server; the module that has it is loaded.
/// @throws InputError naming address and port when they cannot be had
std::unique_ptr<WebServer> serve_web(const WebServerRequest& request, WebHandler handler);

/// What the module `flies_web` gives: null when address and port cannot be had.
using ServeWebFunction = WebServer* (*)(const WebServerRequest& request, WebHandler handler);
inline constexpr const char* kServeWebName = "flies_serve_web";

}  // namespace flies
