#include "flies/video/lazy_module.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "flies/core/error.hpp"

namespace fs = std::filesystem;

namespace flies {
namespace {

/// Where the module may be, the likeliest first.
std::vector<fs::path> candidates(const std::string& file) {
  if (const char* folder = std::getenv("FLIES_MODULES"); folder != nullptr && *folder != '\0')
    return {fs::path(folder) / file};
  std::vector<fs::path> paths;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  fs::path folder = program.parent_path().parent_path();
  for (int level = 0; level < 2 && folder.has_relative_path(); ++level, folder = folder.parent_path())
    for (const char* libraries : {FLIES_LIBRARY_FOLDER, "lib"}) paths.push_back(folder / libraries / "flies" / file);
  return paths;
}

}  // namespace

void* module_function(const std::string& module, const std::string& function) {
  const std::string file = module + ".so";
  for (const auto& path : candidates(file)) {
    std::error_code error;
    if (!fs::exists(path, error)) continue;
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw InputError(path.string(), "", std::string("cannot be loaded: ") + dlerror());
    void* symbol = dlsym(library, function.c_str());
    if (symbol == nullptr) throw InputError(path.string(), function, "is not in this module; it is of another version");
    return symbol;
  }
  throw InputError(
      file, "",
      "is missing; it belongs in lib/flies beside the program's folder (or in the folder that FLIES_MODULES names)");
}

}  // namespace flies
