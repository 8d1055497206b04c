#include "evaluate/classifier_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "flies/draw/curves.hpp"
#include "flies/draw/html.hpp"
#include "shared/report_json.hpp"

namespace {

using flies::DetectionRate;
using Json = nlohmann::ordered_json;

constexpr int kLabelWidth = 30, kColumnWidth = 24;

std::size_t count(const std::vector<std::vector<double>>& lists) {
  std::size_t sum = 0;
  for (const auto& list : lists) sum += list.size();
  return sum;
}

std::size_t people(const flies::WindowScores& scores, const std::string& set) {
  std::size_t sum = 0;
  for (const auto& positives : scores.positives)
    if (set.empty() || positives.set == set) sum += positives.scores.size();
  return sum;
}

/// "70.8 (66.4..75.2)", in per cent.
std::string percent(const DetectionRate& rate) {
  if (!rate.is_measured) return "-";
  std::string text = fmt::format("{:.1f}", 100.0 * rate.rate);
  if (rate.low && rate.high) text += fmt::format(" ({:.1f}..{:.1f})", 100.0 * *rate.low, 100.0 * *rate.high);
  return text;
}

std::string row_label(const DetectionRate& rate) {
  return fmt::format("  at {:g} a window", rate.false_positives_per_window);
}

std::string set_label(const flies::WindowScores& scores, const std::string& set) {
  return fmt::format("{}, {} people", set.empty() ? "all sets" : set, people(scores, set));
}

/// Every row of the table: `heading(text)` before each set, then `row(label, index)` with the index of its rate. All
/// models have the same rows, for they saw the same windows.
template <class Heading, class Row>
void for_each_row(const ClassifierResult& first, const Heading& heading, const Row& row) {
  for (std::size_t i = 0; i < first.rates.size(); ++i) {
    if (i == 0 || first.rates[i].set != first.rates[i - 1].set) heading(set_label(first.scores, first.rates[i].set));
    row(row_label(first.rates[i]), i);
  }
}

std::string summary(std::span<const ClassifierResult> results, const ClassifierContext& context) {
  const auto& scores = results.front().scores;
  return fmt::format("{}: {} windows with people, {} without from {} pictures, at least {:g} px high, seed {}",
                     context.folder, people(scores, ""), count(scores.negatives), scores.negatives.size(),
                     context.sampling.min_height_px, context.sampling.seed);
}

std::string intervals(const ClassifierContext& context) {
  return fmt::format("people found in per cent ({:g} % interval) at so many false positives a window",
                     100.0 * context.estimate.confidence);
}

/// What "-" stands for; empty where there is none.
std::string remark_on_unmeasured(const ClassifierResult& first) {
  const auto unmeasured = std::ranges::find(first.rates, false, &DetectionRate::is_measured);
  if (unmeasured == first.rates.end()) return "";
  return fmt::format("-: {} windows without people are too few to tell; {:g} a window needs {:.0f} at least",
                     count(first.scores.negatives), unmeasured->false_positives_per_window,
                     1.0 / unmeasured->false_positives_per_window);
}

std::string trimmed(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

flies::ScorePlot score_plot(const ClassifierResult& result) {
  flies::ScorePlot plot{result.model, {}, {}, {}};
  for (const auto& set : result.scores.positives)
    plot.positives.insert(plot.positives.end(), set.scores.begin(), set.scores.end());
  for (const auto& picture : result.scores.negatives)
    plot.negatives.insert(plot.negatives.end(), picture.begin(), picture.end());
  return plot;
}

Json reliability_json(const flies::Reliability& reliability) {
  Json bins = Json::array();
  for (const auto& bin : reliability.bins)
    bins.push_back({{"from", rounded(bin.from)},
                    {"to", rounded(bin.to)},
                    {"people", bin.people},
                    {"others", bin.others},
                    {"mean_probability", rounded(bin.mean_probability)},
                    {"people_share", rounded(bin.people_share)}});
  return bins;
}

cv::Mat reliability_curves(std::span<const ClassifierResult> results) {
  std::vector<flies::ReliabilityCurve> curves;
  for (const auto& result : results) {
    curves.push_back({result.model, {}});
    for (const auto& bin : result.reliability.bins)
      if (bin.people + bin.others > 0) curves.back().points.emplace_back(bin.mean_probability, bin.people_share);
  }
  return flies::draw_reliability(curves);
}

std::string html_table(std::span<const ClassifierResult> results) {
  std::string html = "<div class=\"scroll\"><table>\n<tr><th></th>";
  for (const auto& result : results) html += fmt::format("<th>{}</th>", flies::html_text(result.model));
  html += "</tr>\n";
  for_each_row(
      results.front(),
      [&](const std::string& set) {
        html += fmt::format("<tr><th colspan=\"{}\">{}</th></tr>\n", results.size() + 1, flies::html_text(set));
      },
      [&](const std::string& label, std::size_t i) {
        html += fmt::format("<tr><td>{}</td>", label);
        for (const auto& result : results) html += fmt::format("<td>{}</td>", percent(result.rates[i]));
        html += "</tr>\n";
      });
  html += "<tr><td>calibration error</td>";
  for (const auto& result : results) html += fmt::format("<td>{:.4f}</td>", result.reliability.calibration_error);
  html += "</tr>\n<tr><td>time, microseconds a window</td>";
  for (const auto& result : results) html += fmt::format("<td>{:.0f}</td>", result.us_per_window);
  html += "</tr>\n</table></div>\n";
  if (const auto remark = remark_on_unmeasured(results.front()); !remark.empty())
    html += fmt::format("<p>{}</p>\n", remark);
  return html;
}

}  // namespace

std::string classifier_table(std::span<const ClassifierResult> results, const ClassifierContext& context) {
  std::string text = summary(results, context) + "\n" + intervals(context) + "\n";
  std::string head = fmt::format("{:<{}}", "", kLabelWidth);
  for (const auto& result : results) head += fmt::format(" {:<{}}", result.model, kColumnWidth);
  text += trimmed(head);
  for_each_row(
      results.front(), [&](const std::string& set) { text += set + "\n"; },
      [&](const std::string& label, std::size_t i) {
        std::string line = fmt::format("{:<{}}", label, kLabelWidth);
        for (const auto& result : results) line += fmt::format(" {:<{}}", percent(result.rates[i]), kColumnWidth);
        text += trimmed(line);
      });
  const auto add = [&](const char* label, const auto& number) {
    std::string line = fmt::format("{:<{}}", label, kLabelWidth);
    for (const auto& result : results) line += fmt::format(" {:<{}}", number(result), kColumnWidth);
    text += trimmed(line);
  };
  add("calibration error", [](const auto& r) { return fmt::format("{:.4f}", r.reliability.calibration_error); });
  add("time, microseconds a window", [](const auto& r) { return fmt::format("{:.0f}", r.us_per_window); });
  if (const auto remark = remark_on_unmeasured(results.front()); !remark.empty()) text += remark + "\n";
  return text;
}

std::string classifier_json(std::span<const ClassifierResult> results, const ClassifierContext& context) {
  const auto& scores = results.front().scores;
  Json json = {{"data", context.folder},
               {"people", people(scores, "")},
               {"windows_without_people", count(scores.negatives)},
               {"pictures_without_people", scores.negatives.size()},
               {"sampling", json_of_options(context.sampling)},
               {"estimate", json_of_options(context.estimate)},
               {"models", Json::array()}};
  for (const auto& result : results) {
    Json rates = Json::array();
    for (const auto& rate : result.rates) {
      Json entry = {{"set", rate.set.empty() ? Json(nullptr) : Json(rate.set)},
                    {"people", people(result.scores, rate.set)},
                    {"false_positives_per_window", rate.false_positives_per_window},
                    {"detection_rate", rate.is_measured ? rounded(rate.rate) : Json(nullptr)},
                    {"threshold", rate.is_measured ? rounded(rate.threshold) : Json(nullptr)}};
      if (rate.is_measured && rate.low && rate.high) {
        entry["low"] = rounded(*rate.low);
        entry["high"] = rounded(*rate.high);
      }
      rates.push_back(std::move(entry));
    }
    json["models"].push_back({{"model", result.model},
                              {"us_per_window", rounded(result.us_per_window)},
                              {"rates", rates},
                              {"calibration_error", rounded(result.reliability.calibration_error)},
                              {"reliability", reliability_json(result.reliability)}});
  }
  constexpr int kIndent = 2;
  return json.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}

cv::Mat classifier_curves(std::span<const ClassifierResult> results) {
  std::vector<flies::ErrorCurve> curves;
  for (const auto& result : results) curves.push_back({result.model, flies::error_points(result.scores), {}});
  return flies::draw_error_curves(curves);
}

std::string classifier_html(std::span<const ClassifierResult> results, const ClassifierContext& context) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>flies evaluate-classifier</title>\n"
      "<style>{}</style></head><body>\n<h1>People classifiers</h1>\n<p>{}; {}.</p>\n<pre>{}</pre>\n",
      flies::kHtmlStyle, flies::html_text(summary(results, context)), flies::html_text(intervals(context)),
      flies::html_text(context.command));
  html += html_table(results);
  html += fmt::format(
      "<figure><img src=\"{}\" alt=\"miss rate over false positives a window\"><figcaption>Detection error trade-off: "
      "share of people missed over false positives a window.</figcaption></figure>\n",
      flies::html_image(classifier_curves(results)));
  html += fmt::format(
      "<figure><img src=\"{}\" alt=\"share of people over probability\"><figcaption>Reliability: share of people among "
      "windows over their probability, as if one window in ten showed a person.</figcaption></figure>\n",
      flies::html_image(reliability_curves(results)));
  for (const auto& result : results)
    html += fmt::format(
        "<figure><img src=\"{}\" alt=\"histogram of scores\"><figcaption>Scores of windows with and without people, "
        "{}.</figcaption></figure>\n",
        flies::html_image(flies::draw_score_histograms(score_plot(result))), flies::html_text(result.model));
  return html + "</body></html>\n";
}
