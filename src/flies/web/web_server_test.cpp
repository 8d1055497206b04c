#include "flies/web/web_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "flies/core/error.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct WebServerTest : ::testing::Test {
  WebServerTest() { setenv("FLIES_MODULES", FLIES_MODULES, 1); }
};

TEST_F(WebServerTest, HandsRequestsToTheHandler) {
  const auto server = serve_web({}, [](const WebRequest& request) {
    if (request.path == "/fault") throw std::runtime_error("oops");
    return WebAnswer{.status = request.path == "/none" ? 404 : 200,
                     .type = "text/x-test",
                     .body = request.method + request.path + request.parameters.at("a") + request.body +
                             request.page_header + request.cookie,
                     .headers = {{"X-Test", "yes"}}};
  });
  ASSERT_GT(server->port(), 0);
  httplib::Client client("127.0.0.1", server->port());
  const auto got = client.Get("/page?a=%20b");
  ASSERT_TRUE(got);
  EXPECT_EQ(got->status, 200);
  EXPECT_EQ(got->body, "GET/page b");
  EXPECT_EQ(got->get_header_value("Content-Type"), "text/x-test");
  EXPECT_EQ(got->get_header_value("X-Test"), "yes");
  EXPECT_EQ(client.Get("/none?a=")->status, 404);
  const auto posted = client.Post("/order?a=1", {{"X-Flies", "page"}, {"Cookie", "c=2"}}, "body", "text/plain");
  EXPECT_EQ(posted->body, "POST/order1bodypagec=2");
  const auto fault = client.Get("/fault?a=");
  EXPECT_EQ(fault->status, 500);
  EXPECT_THAT(fault->body, HasSubstr("oops"));
}

/// What the server answers to these bytes, until it says nothing more for a second.
std::string answer_to(int port, const std::string& bytes) {
  const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  constexpr timeval kPatience{.tv_sec = 1, .tv_usec = 0};
  ::setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  EXPECT_EQ(::send(connection, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  std::string answer;
  std::array<char, 4096> some{};
  for (ssize_t count = 0; (count = ::recv(connection, some.data(), some.size(), 0)) > 0;)
    answer.append(some.data(), static_cast<std::size_t>(count));
  ::close(connection);
  return answer;
}

TEST_F(WebServerTest, TakesARequestWithoutALengthForOneWithoutABody) {
  const auto server = serve_web({}, [](const WebRequest& request) {
    return WebAnswer{.body = request.method + request.path + "[" + request.body + request.page_header + "]"};
  });
  const std::string answer = answer_to(server->port(), "POST /pause HTTP/1.1\r\nHost: localhost\r\nX-Flies: 1\r\n\r\n");
  EXPECT_THAT(answer, HasSubstr("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("POST/pause[1]"));
}

TEST_F(WebServerTest, PortThatIsTakenIsTold) {
  const auto handler = [](const WebRequest&) { return WebAnswer{}; };
  const auto first = serve_web({}, handler);
  EXPECT_THAT([&] { serve_web({.address = "127.0.0.1", .port = first->port()}, handler); },
              ThrowsMessage<InputError>(HasSubstr("cannot be listened on")));
}

}  // namespace
}  // namespace flies
