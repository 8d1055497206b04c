#include "run_flies.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

std::string quoted(const std::string& word) {
  std::string text(1, '\'');
  for (const char c : word) {
    if (c == '\'') text.append("'\\'");  // closes, quotes the quote, and it opens again
    text.push_back(c);
  }
  text.push_back('\'');
  return text;
}

fs::path new_folder(const std::string& purpose) {
  std::string name = (fs::temp_directory_path() / ("flies-" + purpose + "-XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder for the test");
  return name;
}

}  // namespace

RunResult run_flies(const fs::path& folder, const std::vector<std::string>& arguments, const std::string& prefix,
                    const std::string& suffix) {
  const fs::path log = new_folder("log");  // outside `folder`, whose content tests look at
  std::string words = quoted(FLIES_BINARY);
  for (const auto& argument : arguments) words.append(" ").append(quoted(argument));
  const std::string command =
      fmt::format("cd {} && {{ {} {} {}; }} > {} 2> {} < /dev/null", quoted(folder.string()), prefix, words, suffix,
                  quoted((log / "out").string()), quoted((log / "err").string()));
  const int status = std::system(command.c_str());
  RunResult result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(log / "out"),
                   read_text(log / "err")};
  fs::remove_all(log);
  return result;
}

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

TestFolder::TestFolder() : path_(new_folder("test")) {}

TestFolder::~TestFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> TestFolder::listing() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(path_))
    names.push_back(fs::relative(entry.path(), path_).string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace flies::testing
