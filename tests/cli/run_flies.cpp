#include "run_flies.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

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

/// Starts the command with its streams in files of `log`. @returns its process
pid_t start_flies(const fs::path& folder, const std::vector<std::string>& arguments, const fs::path& log) {
  const fs::path out = log / "out", err = log / "err";
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), "flies");
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t process = ::fork();
  if (process != 0) return process;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  const int flags = O_WRONLY | O_CREAT;
  if (::dup2(::open("/dev/null", O_RDONLY), 0) == 0 && ::dup2(::open(out.c_str(), flags, 0600), 1) == 1 &&
      ::dup2(::open(err.c_str(), flags, 0600), 2) == 2 && ::chdir(folder.c_str()) == 0)
    ::execv(FLIES_BINARY, pointers.data());
  ::_exit(127);
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

RunResult interrupt_flies(const fs::path& folder, const std::vector<std::string>& arguments, int signal,
                          const std::function<bool()>& is_time) {
  constexpr std::chrono::minutes kPatience{1};
  constexpr std::chrono::milliseconds kPause{5};
  const fs::path log = new_folder("log");
  const pid_t process = start_flies(folder, arguments, log);
  if (process < 0) throw std::runtime_error("cannot start a process for the test");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!is_time() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kPause);
  EXPECT_TRUE(is_time()) << read_text(log / "err");
  EXPECT_EQ(::kill(process, signal), 0);
  int status = 0;
  EXPECT_EQ(::waitpid(process, &status, 0), process);
  RunResult result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(log / "out"),
                   read_text(log / "err")};
  fs::remove_all(log);
  return result;
}

bool are_written(const fs::path& folder, const std::string& name, std::size_t count) {
  return std::ranges::any_of(fs::directory_iterator(folder), [&](const fs::directory_entry& entry) {
    return entry.path().filename().string().starts_with(name) &&
           static_cast<std::size_t>(std::ranges::count(read_text(entry.path()), '\n')) >= count;
  });
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
