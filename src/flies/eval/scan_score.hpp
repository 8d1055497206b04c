#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "flies/core/scan.hpp"
#include "flies/eval/estimate.hpp"
#include "flies/eval/scan_truth.hpp"

namespace flies {

/// How the judged sectors of some pairs came out.
struct ScanScore {
  int sectors = 0;                       ///< judged: something stands there
  int right = 0;                         ///< reported where it stands
  int blind = 0;                         ///< nothing or something farther is reported: one would drive into it
  int ghost = 0;                         ///< something nearer is reported
  int unknown = 0;                       ///< told to be unknown; the four add up to the sectors
  int near_sectors = 0, near_blind = 0;  ///< of what stands nearer than `near_range_m`
  int open_sectors = 0, open_ghost = 0;  ///< sectors without anything, and reports in them
  std::vector<double> range_errors;      ///< of the right ones, reported minus true, as part of the true range

  ScanScore& operator+=(const ScanScore& other);
};

/// Holds a scan against its truth. Sectors of the truth ask that sector of the scan in which their middle lies; where
/// there is none, the scan says unknown. `MatchOptions` say when two ranges agree.
ScanScore score_scan(const ScanTruth& truth, const Scan& scan, const MatchOptions& match = {},
                     const SectorOptions& options = {});

/// The scan with every obstacle less certain than `min_confidence` taken back: those sectors report nothing.
Scan with_min_confidence(Scan scan, double min_confidence);

/// Measures of some of the pairs; one that is named twice counts twice. Names: "right", "blind", "ghost", "unknown",
/// "near_blind", "open_ghost", "absolute_range_error", "range_error" (medians).
std::map<MeasureKey, double> scan_values(std::span<const ScanScore> scores, std::span<const std::size_t> frames);

}  // namespace flies
