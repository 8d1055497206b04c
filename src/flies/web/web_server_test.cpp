#include "flies/web/web_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <cstdlib>
#include <stdexcept>

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

TEST_F(WebServerTest, PortThatIsTakenIsTold) {
  const auto handler = [](const WebRequest&) { return WebAnswer{}; };
  const auto first = serve_web({}, handler);
  EXPECT_THAT([&] { serve_web({.address = "127.0.0.1", .port = first->port()}, handler); },
              ThrowsMessage<InputError>(HasSubstr("cannot be listened on")));
}

}  // namespace
}  // namespace flies
