#include "flies/web/web_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "flies/core/error.hpp"
#include "flies/video/lazy_module.hpp"

namespace flies {

std::unique_ptr<WebServer> serve_web(const WebServerRequest& request, WebHandler handler) {
  const auto serve = reinterpret_cast<ServeWebFunction>(module_function("flies_web", kServeWebName));
  std::unique_ptr<WebServer> server(serve(request, std::move(handler)));
  if (!server)
    throw InputError(fmt::format("{}:{}", request.address, request.port), "",
                     "cannot be listened on: does another program use it, or is it not an address of this machine?");
  return server;
}

}  // namespace flies
