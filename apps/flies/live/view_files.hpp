#pragma once

#include <span>
#include <string_view>

/// A file of the page of `flies live --view`.
struct PageFile {
  std::string_view path;  ///< "/page.js"
  std::string_view type;
  std::string_view bytes;
};
std::span<const PageFile> page_files();
