#pragma once

#include <string_view>

namespace flies {

/// The text of models/people_48x96.json, which is part of the library.
std::string_view shipped_kernel_model_text();

/// The same of models/people_48x96_network.json.
std::string_view shipped_network_model_text();

/// The same of models/people_48x96_linear.json.
std::string_view shipped_linear_model_text();

}  // namespace flies
