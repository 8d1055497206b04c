#pragma once

#include <string_view>

#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Whether a value is what OpenCV's FileStorage writes with `WRITE_BASE64`: `!!binary` in YAML, `type_id="binary"` in
/// XML, "$base64$..." in JSON.
/// @param type the tag of the node in YAML, its `type_id` in XML
bool is_opencv_base64(std::string_view text, std::string_view type);

/// Its numbers; a word where they are of several types at once, or damaged.
void append_opencv_base64(std::string_view text, NumberEntry& entry);

}  // namespace flies::detail
