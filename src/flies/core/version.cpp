#include "flies/version.hpp"

namespace flies {

std::string_view library_version() { return FLIES_VERSION; }

}  // namespace flies
