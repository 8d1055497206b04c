#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "flies/core/error.hpp"
#include "shared/commands.hpp"

namespace {

constexpr std::string_view kFlag = "--network";

/// In the folder of this program.
std::filesystem::path trainer() {
  std::error_code error;  // an empty path then, beside which nothing is
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "flies-train-network";
}

}  // namespace

bool is_network_training(int argc, char** argv) {
  return argc > 2 && std::string_view(argv[1]) == "train" && std::find(argv + 2, argv + argc, kFlag) != argv + argc;
}

void become_network_trainer(int argc, char** argv) {
  const std::filesystem::path program = trainer();
  std::error_code error;
  if (!std::filesystem::exists(program, error))
    throw flies::InputError(
        "command line", std::string(kFlag),
        fmt::format("needs the program flies-train-network beside flies, and there is no {}; it is built from flies' "
                    "sources with libtorch (Debian: libtorch-dev) by cmake -DFLIES_TRAIN_NETWORK=ON",
                    program.string()));
  std::vector<char*> arguments = {argv[0]};
  std::copy_if(argv + 2, argv + argc, std::back_inserter(arguments), [](const char* word) { return word != kFlag; });
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  throw flies::InputError(program.string(), "", std::string("cannot be started: ") + std::strerror(errno));
}
