#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>

#include "flies/core/error.hpp"

namespace flies::testing {

/// Gives up the super-user's rights, who may read and write every folder, as long as it lives. Files made before it
/// lives are not its user's.
class OrdinaryUser {
 public:
  OrdinaryUser() {
    constexpr ::uid_t kNobody = 65534;
    if (was_ == 0 && ::seteuid(kNobody) != 0) std::abort();
  }
  ~OrdinaryUser() {
    if (::seteuid(was_) != 0) std::abort();
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  ::uid_t was_ = ::geteuid();
};

/// A fresh folder, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "flies-io-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return file(name);
  }
  std::size_t count() const {
    const std::filesystem::directory_iterator entries(path_);
    return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_all(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The message of the InputError that `call` throws; "no error" when it throws none.
inline std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// YAML that names `leaf` and lists of it, each list `width` times the one before: little text that unfolds without
/// end.
inline std::string nested_aliases(const std::string& leaf, bool as_maps, int levels = 9, int width = 30) {
  const auto list_of = [&](const std::string& item) {
    std::string list(1, as_maps ? '{' : '[');
    for (int i = 0; i < width; ++i) {
      if (i > 0) list += ", ";
      if (as_maps) list += "k" + std::to_string(i) + ": ";
      list += item;
    }
    return list + (as_maps ? '}' : ']');
  };
  std::string text = "a0: &a0 " + list_of(leaf) + "\n";
  for (int level = 1; level < levels; ++level) {
    const std::string name = "a" + std::to_string(level), before = "*a" + std::to_string(level - 1);
    text += name + ": &" + name + " " + list_of(before) + "\n";
  }
  return text;
}

}  // namespace flies::testing
