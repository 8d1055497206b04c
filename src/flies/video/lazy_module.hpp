#pragma once

#include <string>

namespace flies {

/// A function of a shared module that is loaded when it is first asked for and stays loaded: for what brings large
/// libraries along that most runs do not need. Looked for in the folder that the environment's FLIES_MODULES names, or
/// in `lib/flies` beside the program's folder or one above it, in the installed and in the build tree.
/// @param module name of the file without its ending, e.g. "flies_video"
/// @returns never null
/// @throws InputError naming the module and why it cannot be loaded
void* module_function(const std::string& module, const std::string& function);

}  // namespace flies
