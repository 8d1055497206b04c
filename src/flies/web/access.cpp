#include "flies/web/access.hpp"

#include <fmt/format.h>

#include <random>
#include <utility>

namespace flies {
namespace {

/// Takes the same time wherever two texts of equal length differ.
bool are_same(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

/// Cookies do not know ports: one for each, so that two pages of one machine do not disturb each other.
std::string cookie_name(int port) { return fmt::format("flies_{}", port); }

std::string cookie_value(const std::string& cookies, const std::string& name) {
  const std::string key = name + "=";
  for (std::size_t start = 0; start < cookies.size();) {
    const std::size_t end = std::min(cookies.find(';', start), cookies.size());
    const std::size_t first = cookies.find_first_not_of(' ', start);
    if (first < end && cookies.compare(first, key.size(), key) == 0)
      return cookies.substr(first + key.size(), end - first - key.size());
    start = end + 1;
  }
  return {};
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

Access::Access(std::string address, int port, std::string token)
    : address_(std::move(address)), token_(std::move(token)), port_(port) {}

std::optional<WebAnswer> Access::refuse(const WebRequest& request) const {
  if (token_.empty()) {
    const std::string port = fmt::format(":{}", port_);
    const auto& host = request.host;
    if (host != "localhost" + port && host != "127.0.0.1" + port && host != "[::1]" + port && host != address_ + port)
      return WebAnswer{.status = 403, .body = "This page is for this machine only.\n"};
  } else {
    const auto given = request.parameters.find("token");
    const bool is_given = given != request.parameters.end() && are_same(given->second, token_);
    if (!is_given && !are_same(cookie_value(request.cookie, cookie_name(port_)), token_))
      return WebAnswer{.status = 403,
                       .body = "This page needs a token: open the address that flies printed when it started.\n"};
  }
  if (request.method != "GET" && request.method != "HEAD" && request.page_header.empty())
    return WebAnswer{.status = 403, .body = "Commands are accepted from the page itself only.\n"};
  return std::nullopt;
}

std::map<std::string, std::string> Access::headers() const {
  std::map<std::string, std::string> headers = {
      {"Content-Security-Policy", "default-src 'self'; img-src 'self' blob:; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cache-Control", "no-store"}};
  if (!token_.empty())
    headers["Set-Cookie"] = fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", cookie_name(port_), token_);
  return headers;
}

}  // namespace flies
