#pragma once

#include <fmt/format.h>

#include <string>

/// How the tables of an evaluation are written.
inline constexpr int kLabelWidth = 34, kColumnWidth = 30;

/// How a measure is written.
struct Style {
  double scale = 1.0;
  int decimals = 3;
  bool has_sign = false;
};
inline constexpr Style kShare{1.0, 3, false};
inline constexpr Style kPercent{100.0, 2, false};
inline constexpr Style kSignedPercent{100.0, 2, true};
inline constexpr Style kMetres{1.0, 2, false};
inline constexpr Style kSignedMetres{1.0, 2, true};
inline constexpr Style kCount{1.0, 1, false};

inline std::string number(double value, const Style& style) {
  const double scaled = value * style.scale;
  return style.has_sign ? fmt::format("{:+.{}f}", scaled, style.decimals)
                        : fmt::format("{:.{}f}", scaled, style.decimals);
}
