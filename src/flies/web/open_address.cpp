#include "flies/web/open_address.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <array>
#include <cstring>
#include <memory>

namespace flies {
namespace {

/// The address as text; empty when it is of another family, or holds for one link only.
std::string text_of(const sockaddr* address, int family) {
  if (address == nullptr || address->sa_family != family) return {};
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, address, sizeof v6);
    if (!IN6_IS_ADDR_LINKLOCAL(&v6.sin6_addr)) inet_ntop(family, &v6.sin6_addr, text.data(), text.size());
  } else {
    sockaddr_in v4{};
    std::memcpy(&v4, address, sizeof v4);
    inet_ntop(family, &v4.sin_addr, text.data(), text.size());
  }
  return text.data();
}

}  // namespace

std::string open_address(const std::string& address) {
  const bool is_v6 = address == "::";
  if (address != "0.0.0.0" && !is_v6) return address;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) list = nullptr;
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, [](ifaddrs* all) {
    if (all != nullptr) freeifaddrs(all);
  });
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if ((entry->ifa_flags & IFF_UP) == 0 || (entry->ifa_flags & IFF_LOOPBACK) != 0) continue;
    if (auto text = text_of(entry->ifa_addr, is_v6 ? AF_INET6 : AF_INET); !text.empty()) return text;
  }
  return is_v6 ? "::1" : "127.0.0.1";
}

}  // namespace flies
