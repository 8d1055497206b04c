#pragma once

#include <optional>
#include <string>

#include "flies/web/web_server.hpp"

namespace flies {

/// An address of this machine that no other machine reaches.
bool is_loopback(const std::string& address);

/// 128 random bits as text.
std::string random_token();

/// Who may see and steer the page. On a loopback address everyone on this machine, but no page of another site in his
/// browser: requests must name this machine as their host, and orders carry a header that other sites cannot set.
/// Elsewhere only who knows the token, from the address at first and from a cookie afterwards.
class Access {
 public:
  /// @param token empty: none is asked for
  Access(std::string address, int port, std::string token);

  /// @returns what to answer when the request is refused
  std::optional<WebAnswer> refuse(const WebRequest& request) const;

  /// Headers that every answer has; with a token the cookie that keeps it.
  std::map<std::string, std::string> headers() const;

 private:
  std::string address_, token_;
  int port_;
};

}  // namespace flies
