#pragma once

#include <string>

namespace flies {

/// Where what listens at `address` can be opened: of 0.0.0.0 and ::, which stand for all addresses of this machine, one
/// that other machines reach, or the loopback where there is none; of any other itself.
std::string open_address(const std::string& address);

}  // namespace flies
