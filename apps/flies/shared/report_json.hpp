#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "flies/core/options.hpp"

/// A number with six decimals; what is not finite becomes null.
inline nlohmann::ordered_json rounded(double value) {
  constexpr double kDigits = 1e6;
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * kDigits) / kDigits + 0.0;  // + 0 turns -0 into 0
}

/// Options by their dotted names: numbers and truth values as such, names as texts.
template <class Options>
nlohmann::ordered_json json_of_options(const Options& options) {
  using Json = nlohmann::ordered_json;
  Json json = Json::object();
  for (const auto& listing : flies::list_options(options)) {
    Json value = Json::parse(listing.value, nullptr, false);
    json[listing.path] = value.is_discarded() ? Json(listing.value) : std::move(value);
  }
  return json;
}
