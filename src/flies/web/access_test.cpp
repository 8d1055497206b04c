#include "flies/web/access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/web/open_address.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;

constexpr int kPort = 8090;

WebRequest request_with(const std::string& host, const std::string& method = "GET") {
  WebRequest request;
  request.method = method;
  request.path = "/";
  request.host = host;
  return request;
}

TEST(Access, OtherSitesCannotReachThePageOfThisMachine) {
  const Access access("127.0.0.1", kPort, "");
  EXPECT_FALSE(access.refuse(request_with("127.0.0.1:8090")));
  EXPECT_FALSE(access.refuse(request_with("localhost:8090")));
  for (const char* host : {"", "evil.example:8090", "127.0.0.1:80", "127.0.0.1.evil.example:8090"})
    EXPECT_EQ(access.refuse(request_with(host))->status, 403) << host;
}

TEST(Access, WhoMaySeeAPageMayAskForItsHeadToo) {
  const Access access("127.0.0.1", kPort, "");
  EXPECT_FALSE(access.refuse(request_with("127.0.0.1:8090", "HEAD")));
  EXPECT_EQ(access.refuse(request_with("127.0.0.1:8090", "PUT"))->status, 403);
}

TEST(Access, OrdersCarryTheHeaderOfThePage) {
  const Access access("127.0.0.1", kPort, "");
  auto order = request_with("127.0.0.1:8090", "POST");
  EXPECT_EQ(access.refuse(order)->status, 403);
  order.page_header = "1";
  EXPECT_FALSE(access.refuse(order));
}

TEST(Access, TokenIsAskedForInAddressOrCookie) {
  const std::string token = random_token();
  const Access access("192.0.2.1", kPort, token);
  auto request = request_with("192.0.2.1:8090");
  EXPECT_EQ(access.refuse(request)->status, 403);
  request.parameters["token"] = token + "x";
  EXPECT_EQ(access.refuse(request)->status, 403);
  request.parameters["token"] = token;
  EXPECT_FALSE(access.refuse(request));
  request.parameters.clear();
  request.cookie = "other=1; flies_8090=" + token + "; more=2";
  EXPECT_FALSE(access.refuse(request));
  request.cookie = "flies_8091=" + token;
  EXPECT_EQ(access.refuse(request)->status, 403);
  EXPECT_THAT(access.headers().at("Set-Cookie"), HasSubstr("flies_8090=" + token + "; HttpOnly; SameSite=Strict"));
}

TEST(Access, TokensDiffer) {
  EXPECT_EQ(random_token().size(), 32U);
  EXPECT_NE(random_token(), random_token());
}

TEST(Access, AllAddressesAreOpenedAtOneOfThem) {
  for (const std::string all : {"0.0.0.0", "::"}) {
    const std::string one = open_address(all);
    EXPECT_NE(one, all);
    EXPECT_EQ(one.find(':') != std::string::npos, all == "::") << one;
  }
  for (const char* one : {"127.0.0.1", "::1", "192.0.2.1", "localhost"}) EXPECT_EQ(open_address(one), one);
}

TEST(Access, LoopbackIsKnown) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_FALSE(is_loopback("192.0.2.1"));
}

}  // namespace
}  // namespace flies
