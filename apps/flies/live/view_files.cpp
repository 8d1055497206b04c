#include "live/view_files.hpp"

#include <array>

// The assembler copies the files. FLIES_PAGE is the folder, set by CMake.
// NOLINTBEGIN(bugprone-macro-parentheses): names, not expressions
#define FLIES_EMBED(name, file)                                                                           \
  asm(".pushsection .rodata\n.hidden " #name "\n.hidden " #name "_end\n.global " #name "\n.global " #name \
      "_end\n" #name ":\n.incbin \"" FLIES_PAGE "/" file "\"\n" #name "_end:\n.popsection\n");            \
  extern "C" const char name[], name##_end[]
// NOLINTEND(bugprone-macro-parentheses)

FLIES_EMBED(flies_page_html, "index.html");
FLIES_EMBED(flies_page_js, "page.js");
FLIES_EMBED(flies_page_draw, "draw.js");
FLIES_EMBED(flies_page_css, "page.css");
FLIES_EMBED(flies_page_icon, "icon.svg");

#undef FLIES_EMBED

std::span<const PageFile> page_files() {
  const auto between = [](const char* begin, const char* end) {
    return std::string_view(begin, static_cast<std::size_t>(end - begin));
  };
  static const std::array<PageFile, 5> kFiles = {{
      {"/", "text/html; charset=utf-8", between(flies_page_html, flies_page_html_end)},
      {"/page.js", "text/javascript; charset=utf-8", between(flies_page_js, flies_page_js_end)},
      {"/draw.js", "text/javascript; charset=utf-8", between(flies_page_draw, flies_page_draw_end)},
      {"/page.css", "text/css; charset=utf-8", between(flies_page_css, flies_page_css_end)},
      {"/icon.svg", "image/svg+xml", between(flies_page_icon, flies_page_icon_end)},
  }};
  return kFiles;
}
