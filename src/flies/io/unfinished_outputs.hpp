#pragma once

#include <filesystem>

namespace flies {

/// Files and folders that are being written and must not be left behind by a process that is made to end. Thread-safe.
/// @{
void note_unfinished_output(const std::filesystem::path& path);
void forget_unfinished_output(const std::filesystem::path& path) noexcept;

/// Removes them all. Call it when the process is about to end, from a thread of its own and not from a signal handler:
/// whoever notes or forgets one from now on is made to wait.
void remove_unfinished_outputs() noexcept;
/// @}

}  // namespace flies
