#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "flies/core/options.hpp"
#include "live/live_frame.hpp"

/// What the page is told beside the record of a pair.
struct ViewRates {
  double pairs_hz = 0.0, latency_ms = 0.0, latency_p99_ms = 0.0;  ///< of the newest pairs
  std::uint64_t dropped = 0, broken = 0, losses = 0;
};

/// What the page shows beside the record of `flies live --json`: the pose, and the ground that was seen free: `free_m`,
/// a polygon around the vehicle, and `free_px`, polygons in the left image.
nlohmann::ordered_json view_frame(const LiveFrame& frame);

/// The flies: their places in the left image and on the ground, and their fitness as a share of the highest.
nlohmann::ordered_json view_flies(const LiveFrame& frame);

/// The options that the page has a control for.
nlohmann::ordered_json view_options(const std::vector<flies::OptionListing>& listings);

/// Everything that a report of a fault needs, as a ZIP archive.
std::string view_report(const LiveFrame& frame, const std::vector<std::string>& notes);
