#pragma once

#include <string>

/// JSON Schemas of the message types that Foxglove and Lichtblick publish, as far as we fill them in.
std::string channel_schema(const std::string& name);
