#include "flies/draw/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "flies/core/base64.hpp"
#include "flies/io/image_codecs.hpp"

namespace flies {
const std::string_view kHtmlStyle = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 1280px; margin: 0 auto; padding: 1rem 1.5rem 4rem; }
h1 { line-height: 1.2; } h2 { margin-top: 3rem; border-top: 1px solid #ccc; padding-top: 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 1rem 0; font-size: .92rem; }
th, td { border: 1px solid #ccc; padding: .35rem .6rem; text-align: right; vertical-align: top; white-space: nowrap; }
th { background: #f3f3f3; } th:first-child, td:first-child { text-align: left; white-space: normal; min-width: 15rem; }
td.left { text-align: left; }
td small { color: #555; display: block; }
td.met { background: #e6f4e6; } td.missed { background: #fbe9e0; }
figure { margin: 1.5rem 0; } figure img { max-width: 100%; height: auto; border: 1px solid #ddd; }
figcaption { max-width: 60rem; } figcaption b { margin-right: .3em; }
pre { background: #f6f6f6; padding: .8rem; overflow-x: auto; font-size: .85rem; white-space: pre-wrap; }
)";

std::string html_text(std::string_view text) {
  std::string html;
  for (const char c : text) {
    if (c == '<')
      html += "&lt;";
    else if (c == '>')
      html += "&gt;";
    else if (c == '&')
      html += "&amp;";
    else if (c == '"')
      html += "&quot;";
    else
      html += c;
  }
  return html;
}

std::string html_image(const cv::Mat& picture, bool is_photo) {
  constexpr int kJpegQuality = 90;  // text in the picture stays sharp
  const auto bytes = is_photo ? encode_jpeg(picture, kJpegQuality) : encode_png(picture, true);
  return fmt::format("data:image/{};base64,{}", is_photo ? "jpeg" : "png", to_base64(bytes));
}

}  // namespace flies
