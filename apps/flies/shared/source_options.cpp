#include "shared/source_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flies/core/error.hpp"
#include "flies/video/capture.hpp"

void refuse_idle_source_options(const std::vector<std::string>& sources, flies::Split split, bool has_size) {
  if (split != flies::Split::none && sources.size() > 1)
    throw flies::InputError("SOURCE", sources[1], "is not needed: with --split one source holds both images");
  if (has_size && std::ranges::find(sources, flies::SourceKind::device, flies::source_kind) == sources.end())
    throw flies::InputError("command line", "--size",
                            fmt::format("is asked of cameras (0, /dev/video0), and {} is none", sources.front()));
}
