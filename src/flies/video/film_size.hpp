#pragma once

#include <string>

namespace flies {

/// Whether a film's file is shorter than its own head says, or ends in nothing but zeros, as downloads do that were not
/// finished. Told for AVI, MP4 (MOV) and Matroska (WebM); other files pass.
bool lacks_its_end(const std::string& path);

}  // namespace flies
