#pragma once

#include <string>
#include <string_view>

namespace flies::detail {

/// What stands where a file should be: a pointer of Git LFS, git-annex or DVC, a symbolic link that became a text, a
/// page of a failed download, nothing but zeros.
/// @returns what `bytes` are and what to do about it, empty when they are none of these
std::string placeholder_fault(std::string_view bytes);

/// The same of a small file that others read. @returns nothing for what is no file, or a large one
std::string placeholder_fault_of_file(const std::string& path);

/// What to say of a symbolic link that leads nowhere. @returns nothing for other paths
std::string dead_link_fault(const std::string& path);

}  // namespace flies::detail
