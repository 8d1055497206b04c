#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "learning.hpp"
#include "windows.hpp"

namespace flies {

/// Keeps the state of a network's training in a folder, so that it can go on after an interruption, as `Checkpoint`
/// does for the other machines.
class NetworkCheckpoint {
 public:
  /// @param folder made when there is something to keep
  /// @param fingerprint from `fingerprint_of_learning`
  NetworkCheckpoint(std::filesystem::path folder, std::string fingerprint);

  /// Goes on from the state, where there is one.
  /// @throws InputError naming the folder when it holds the state of another training, or the state file when it is
  ///         damaged
  void restore(Learning& learning) const;

  /// @throws InputError when the folder cannot be made or the state cannot be written
  void save(Learning& learning) const;

  /// Removes the state, and the folder when it holds nothing else.
  void remove() const;

 private:
  std::filesystem::path folder_, file_;
  std::string fingerprint_;
};

/// The same for the same pictures (pixels, labels, proposals), options, shape of the network and version of libtorch.
std::string fingerprint_of_learning(std::span<const Picture> pictures, const LearningOptions& options,
                                    const std::string& shape);

}  // namespace flies
