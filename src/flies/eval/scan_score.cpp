#include "flies/eval/scan_score.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/eval/measures.hpp"

namespace flies {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What the scan reports in a direction: a range, infinity for nothing; nothing where it is unknown.
std::optional<double> reported_range_m(const Scan& scan, double angle_rad) {
  if (scan.empty()) return std::nullopt;
  const auto sector = Bearings{scan.angle_min_rad, scan.angle_increment_rad, scan.size()}.sector_of(angle_rad);
  if (!sector || scan.states[*sector] == SectorState::unknown) return std::nullopt;
  return scan.states[*sector] == SectorState::obstacle ? scan.ranges_m[*sector] : kInfinity;
}

void judge(double true_m, std::optional<double> reported_m, const MatchOptions& match, const SectorOptions& options,
           ScanScore& score) {
  const bool is_near = true_m < options.near_range_m;
  ++score.sectors;
  score.near_sectors += is_near;
  if (!reported_m) {
    ++score.unknown;
  } else if (std::abs(*reported_m - true_m) <= match.radius_at_m(true_m)) {
    ++score.right;
    score.range_errors.push_back((*reported_m - true_m) / true_m);
  } else if (*reported_m > true_m) {
    ++score.blind;
    score.near_blind += is_near;
  } else {
    ++score.ghost;
  }
}

}  // namespace

ScanScore& ScanScore::operator+=(const ScanScore& other) {
  sectors += other.sectors;
  right += other.right;
  blind += other.blind;
  ghost += other.ghost;
  unknown += other.unknown;
  near_sectors += other.near_sectors;
  near_blind += other.near_blind;
  open_sectors += other.open_sectors;
  open_ghost += other.open_ghost;
  range_errors.insert(range_errors.end(), other.range_errors.begin(), other.range_errors.end());
  return *this;
}

ScanScore score_scan(const ScanTruth& truth, const Scan& scan, const MatchOptions& match,
                     const SectorOptions& options) {
  ScanScore score;
  for (std::size_t i = 0; i < truth.kinds.size(); ++i) {
    if (truth.kinds[i] == TrueSector::ignored) continue;
    const auto reported_m = reported_range_m(scan, truth.bearings.angle_rad(i));
    if (truth.kinds[i] == TrueSector::counted) {
      judge(truth.ranges_m[i], reported_m, match, options, score);
    } else {
      ++score.open_sectors;
      score.open_ghost += reported_m.value_or(kInfinity) < options.max_range_m;
    }
  }
  return score;
}

Scan with_min_confidence(Scan scan, double min_confidence) {
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.states[i] != SectorState::obstacle || !(scan.confidence[i] < min_confidence)) continue;
    scan.states[i] = SectorState::free;
    scan.ranges_m[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return scan;
}

std::map<MeasureKey, double> scan_values(std::span<const ScanScore> scores, std::span<const std::size_t> frames) {
  ScanScore sum;
  for (const std::size_t frame : frames) sum += scores[frame];
  std::map<MeasureKey, double> values;
  const auto add = [&](const char* name, std::optional<double> value) {
    if (value) values.emplace(MeasureKey{MeasureKey::Group::all, "", name}, *value);
  };
  add("right", Rate{sum.right, sum.sectors}.value());
  add("blind", Rate{sum.blind, sum.sectors}.value());
  add("ghost", Rate{sum.ghost, sum.sectors}.value());
  add("unknown", Rate{sum.unknown, sum.sectors}.value());
  add("near_blind", Rate{sum.near_blind, sum.near_sectors}.value());
  add("open_ghost", Rate{sum.open_ghost, sum.open_sectors}.value());
  add("range_error", median(sum.range_errors));
  for (double& error : sum.range_errors) error = std::abs(error);
  add("absolute_range_error", median(std::move(sum.range_errors)));
  return values;
}

}  // namespace flies
