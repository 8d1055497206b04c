#pragma once

#include <filesystem>

namespace flies {

/// Files and folders that are being written and must not be left behind by a process that is made to end. Thread-safe.
/// @{
void note_unfinished_output(const std::filesystem::path& path);
void forget_unfinished_output(const std::filesystem::path& path) noexcept;

/// A file of lines that follow each other and are each whole: what is written of it is worth keeping. It gets the name
/// `target` when the process is made to end, cut behind its last line.
void note_unfinished_lines(const std::filesystem::path& path, const std::filesystem::path& target);

/// Removes them all, but for lines. Call it when the process is about to end, from a thread of its own and not from a
/// signal handler: whoever notes or forgets one from now on is made to wait.
void remove_unfinished_outputs() noexcept;
/// @}

}  // namespace flies
