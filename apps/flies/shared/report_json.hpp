#pragma once

#include <nlohmann/json.hpp>

#include "flies/core/options.hpp"
#include "flies/io/json_values.hpp"

using flies::rounded;

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
