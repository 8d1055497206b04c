// What tests of streams have in common.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "flies/video/frame_stream.hpp"

namespace flies::testing {

/// What was told, from any thread.
class Told {
 public:
  Tell tell() {
    return [this](const std::string& sentence) {
      const std::lock_guard lock(mutex_);
      sentences_.push_back(sentence);
    };
  }
  std::vector<std::string> sentences() const {
    const std::lock_guard lock(mutex_);
    return sentences_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> sentences_;
};

inline FrameStreamOptions file_options() {
  FrameStreamOptions options;
  options.name = "toy";
  return options;
}

}  // namespace flies::testing
