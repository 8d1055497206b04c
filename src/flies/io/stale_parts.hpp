#pragma once

#include <filesystem>

namespace flies {

/// Removes what processes that were killed left of a file or folder they had begun beside `target`: names
/// `<target>.part-<process>` or `<target>.part-<process>-<number>`, whose process is no more. Never throws: what cannot
/// be removed does no harm. A folder is looked through once a process.
void remove_stale_parts(const std::filesystem::path& target) noexcept;

}  // namespace flies
