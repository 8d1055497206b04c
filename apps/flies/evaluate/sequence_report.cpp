#include "evaluate/sequence_report.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <vector>

#include "evaluate/evaluation_report.hpp"
#include "evaluate/report_style.hpp"
#include "flies/core/quantile.hpp"
#include "shared/report_json.hpp"

namespace {

using flies::MeasureKey;
using Group = MeasureKey::Group;
using Json = nlohmann::ordered_json;

/// How values lie: their number, median and the value that 90 % do not exceed.
struct Spread {
  std::size_t count = 0;
  std::optional<double> median, most;
};

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  constexpr double kMost = 0.9;
  const double most = flies::quantile(values, kMost);
  const std::size_t count = values.size();
  return {count, flies::median(std::move(values)), most};
}

std::optional<double> mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Of squared normalised errors of two numbers, the share within what 95 % should keep to.
std::optional<double> share_within(const std::vector<double>& nees) {
  constexpr double kChiSquared95 = 5.991;
  const auto within = std::count_if(nees.begin(), nees.end(), [](double value) { return value <= kChiSquared95; });
  return flies::Rate{static_cast<int>(within), static_cast<int>(nees.size())}.value();
}

std::string sequence_line(const std::string& label, const std::string& text) {
  return fmt::format("  {:<{}} {}\n", label, kLabelWidth, text);
}

std::string text_of(const Spread& spread, const Style& style) {
  if (!spread.median) return "-";
  return fmt::format("{}, {}  ({})", number(*spread.median, style), number(*spread.most, style), spread.count);
}

std::string text_of(int hits, int total) {
  if (total == 0) return "-";
  return fmt::format("{:.3f}  ({} of {})", static_cast<double>(hits) / total, hits, total);
}

std::string nees_text(const std::vector<double>& nees) {
  if (nees.empty()) return "-";
  return fmt::format("{:.2f}, {:.3f}  ({})", *mean_of(nees), *share_within(nees), nees.size());
}

std::map<MeasureKey, double> scan_values_of(const std::vector<flies::ScanScore>& scores) {
  std::vector<std::size_t> all(scores.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return flies::scan_values(scores, all);
}

std::string scan_text(const std::vector<flies::ScanScore>& scores) {
  const auto values = scan_values_of(scores);
  std::string text;
  for (const char* measure : {"right", "blind", "ghost", "unknown"}) {
    const auto found = values.find({Group::all, "", measure});
    if (found == values.end()) return "-";
    text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", found->second);
  }
  return text;
}

Json json_or_null(const std::optional<double>& value) { return value ? rounded(*value) : Json(nullptr); }

Json json_of(const Spread& spread) {
  return {{"count", spread.count}, {"median", json_or_null(spread.median)}, {"most_90", json_or_null(spread.most)}};
}

Json nees_json(const std::vector<double>& nees) {
  return {
      {"count", nees.size()}, {"mean", json_or_null(mean_of(nees))}, {"within_95", json_or_null(share_within(nees))}};
}

Json scan_json(const std::vector<flies::ScanScore>& scores) {
  Json json = Json::object();
  for (const auto& [key, value] : scan_values_of(scores)) json[key.measure] = rounded(value);
  return json;
}

}  // namespace

nlohmann::ordered_json sequence_json(const flies::SequenceResult& sequence) {
  const auto& t = sequence.tracks;
  return {{"pairs", sequence.pairs},
          {"duration_s", rounded(sequence.duration_s)},
          {"objects", t.objects},
          {"found", t.found},
          {"recall", json_or_null(flies::Rate{t.found, t.objects}.value())},
          {"identity_switches", t.identity_switches},
          {"fragments", t.fragments},
          {"moving_velocity_error_mps", json_of(spread_of(t.moving_errors_mps))},
          {"standing_velocity_error_mps", json_of(spread_of(t.standing_errors_mps))},
          {"standing", t.standing},
          {"standing_reported_moving", t.false_motion},
          {"unlabelled", t.unlabelled},
          {"unlabelled_reported_moving", t.unlabelled_moving},
          {"first_report_s", json_of(spread_of(t.first_report_s))},
          {"never_reported", t.never_reported},
          {"first_velocity_s", json_of(spread_of(t.first_velocity_s))},
          {"never_with_velocity", t.never_with_velocity},
          {"position_nees", nees_json(t.position_nees)},
          {"velocity_nees", nees_json(t.velocity_nees)},
          {"ego",
           {{"pairs", sequence.ego.pairs},
            {"lost", sequence.ego.lost},
            {"speed_error", json_of(spread_of(sequence.ego.speed_errors))},
            {"yaw_rate_error_rps", json_of(spread_of(sequence.ego.yaw_rate_errors_rps))}}},
          {"scan", scan_json(sequence.scan)},
          {"single_pair_scan", scan_json(sequence.single_scan)},
          {"time_ms", json_of(spread_of(sequence.times_ms))}};
}

std::string sequence_table(const flies::SequenceResult& sequence, const EvaluationContext& context) {
  const auto& t = sequence.tracks;
  std::string text = fmt::format(
      "sequence: {} pairs, {:.1f} s, followed from images alone, one run; objects from {:g} to {:g} m\n",
      sequence.pairs, sequence.duration_s, context.measuring.match.min_range_m, context.measuring.match.max_range_m);
  text += sequence_line("recall by tracks", text_of(t.found, t.objects));
  text += sequence_line("identity switches, fragments", fmt::format("{}, {}", t.identity_switches, t.fragments));
  text += "  medians, what 90 % do not exceed (how many)\n";
  text += sequence_line("velocity error, moving [m/s]", text_of(spread_of(t.moving_errors_mps), kMetres));
  text += sequence_line("velocity error, standing [m/s]", text_of(spread_of(t.standing_errors_mps), kMetres));
  const auto never = [](int count) { return count > 0 ? fmt::format(", never: {}", count) : std::string{}; };
  text += sequence_line("in view to first track [s]",
                        text_of(spread_of(t.first_report_s), kMetres) + never(t.never_reported));
  text += sequence_line("in view to right velocity [s]",
                        text_of(spread_of(t.first_velocity_s), kMetres) + never(t.never_with_velocity));
  text += sequence_line("ego speed error [%]", text_of(spread_of(sequence.ego.speed_errors), kPercent));
  constexpr Style kRates{1.0, 4, false};
  text += sequence_line("ego yaw rate error [rad/s]", text_of(spread_of(sequence.ego.yaw_rate_errors_rps), kRates));
  text += sequence_line("time to the tracks [ms]", text_of(spread_of(sequence.times_ms), kCount));
  text += "  shares\n";
  text += sequence_line("standing, said to move", text_of(t.false_motion, t.standing));
  text += sequence_line("on no label, said to move", text_of(t.unlabelled_moving, t.unlabelled));
  text += sequence_line("ego-motion lost", text_of(sequence.ego.lost, sequence.ego.pairs));
  text += "  errors squared over their covariance: mean (2 is right), share within 95 % (how many)\n";
  text += sequence_line("position", nees_text(t.position_nees));
  text += sequence_line("velocity", nees_text(t.velocity_nees));
  text += "  scan: right, blind, ghost, unknown\n";
  text += sequence_line("with memory", scan_text(sequence.scan));
  text += sequence_line("pair by pair", scan_text(sequence.single_scan));
  return text;
}
