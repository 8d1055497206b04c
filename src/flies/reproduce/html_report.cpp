#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "flies/core/options.hpp"
#include "flies/draw/html.hpp"
#include "flies/reproduce/report.hpp"

namespace flies {
namespace {

/// A cell beside the paper's number: `verdict` is "", "met" or "missed".
std::string cell(const std::string& median, const std::string& detail, const std::string& verdict) {
  return fmt::format("<td{}>{}{}</td>", verdict.empty() ? "" : " class=\"" + verdict + "\"", html_text(median),
                     detail.empty() ? "" : "<small>" + html_text(detail) + "</small>");
}

/// All measures are better when smaller.
std::string verdict(double value, std::optional<double> paper) {
  return !paper ? "" : value <= *paper ? "met" : "missed";
}

std::string measure_cell(const std::optional<Spread>& spread, int decimals, std::optional<double> paper = {}) {
  if (!spread) return cell("none", "", "");
  const std::string range =
      spread->count > 1 ? fmt::format("{:.{}f} to {:.{}f}", spread->min, decimals, spread->max, decimals) : "";
  return cell(fmt::format("{:.{}f}", spread->median, decimals), range, verdict(spread->median, paper));
}

/// What the paper says of time, in milliseconds.
struct TimeRow {
  Stage stage;
  const char* label;
  std::optional<double> paper_ms;
};
constexpr std::array<TimeRow, 3> kTimeRows = {{{Stage::evolve, "evolution, 3 generations", 150.0},
                                               {Stage::concentrate, "concentrating", std::nullopt},
                                               {Stage::classify, "classification", 10.0}}};

template <class Cell>
std::string row(const std::string& label, const std::string& unit, const std::string& paper,
                const std::vector<ReportSet>& sets, const Cell& make_cell) {
  std::string html = fmt::format("<tr><td>{}</td><td class=\"left\">{}</td><td>{}</td>", html_text(label),
                                 html_text(unit), html_text(paper));
  for (const auto& set : sets) html += make_cell(set);
  return html + "</tr>\n";
}

std::string table(const std::vector<ReportSet>& sets) {
  std::string html = "<div class=\"scroll\"><table>\n<tr><th>what</th><th>unit</th><th>paper</th>";
  for (const auto& set : sets) html += fmt::format("<th>{}</th>", html_text(set.title));
  html += "</tr>\n";
  for (std::size_t i = 0; i < experiment_rows().size(); ++i) {
    const ExperimentRow& measure = experiment_rows()[i];
    html += row(std::string(measure.label), std::string(measure.unit),
                measure.paper ? fmt::format("{:.{}f}", *measure.paper, measure.decimals) : "-", sets,
                [&](const ReportSet& set) {
                  return measure_cell(set.result.rows[i], measure.decimals,
                                      measure.smaller_is_better ? measure.paper : std::nullopt);
                });
  }
  for (const auto& time : kTimeRows)
    html += row(time.label, "ms", time.paper_ms ? fmt::format("<= {:g}", *time.paper_ms) : "-", sets,
                [&](const ReportSet& set) {
                  const double ms = set.result.timing.median_ms[static_cast<std::size_t>(time.stage)];
                  return cell(fmt::format("{:.1f}", ms), "", verdict(ms, time.paper_ms));
                });
  html += row("fitness evaluations a frame", "", "-", sets,
              [](const ReportSet& set) { return cell(fmt::format("{}", set.result.timing.evaluations), "", ""); });
  html += row("people measured, in frames", "", "1, in 1", sets, [](const ReportSet& set) {
    return cell(fmt::format("{}, in {}", set.result.people.size(), set.frames.size()), "", "");
  });
  return html + "</table></div>\n";
}

std::string person_row(const ReportSet& set, const MeasuredPerson& measured) {
  constexpr std::array<std::string_view, 5> kShown = {"rms_eq2_m", "rms_eq1_m", "rms_ratio", "evolved_sample_error_m",
                                                      "evolved_shift_error_m"};
  const auto& e = measured.experiment;
  std::string html =
      fmt::format("<tr><td>{}: {}</td><td>{:.2f}</td><td>{:.2f}</td>", html_text(set.frames[measured.frame]),
                  html_text(e.person.name), e.person.near.x_m, e.person.near.y_m);
  for (const auto& measure : experiment_rows()) {
    if (std::find(kShown.begin(), kShown.end(), measure.key) == kShown.end()) continue;
    std::vector<std::optional<double>> values;
    for (const auto& run : e.runs) values.push_back(measure.value(e.person, run));
    html += measure_cell(spread_of(values), measure.decimals);
  }
  const auto missed =
      std::count_if(e.runs.begin(), e.runs.end(), [](const PersonRun& run) { return !run.obstacle_range_m; });
  return html +
         fmt::format("<td>{} of {}</td></tr>\n", e.runs.size() - static_cast<std::size_t>(missed), e.runs.size());
}

std::string people_table(const ReportSet& set) {
  std::string html =
      "<details><summary>Every person: median over the seeds, smallest to largest</summary><div class=\"scroll\">"
      "<table>\n<tr><th>person</th><th>x, m</th><th>y, m</th><th>RMS Eq. (2), m</th><th>RMS Eq. (1), m</th>"
      "<th>ratio</th><th>after sampling, m</th><th>after mean shift, m</th><th>runs with an OOI</th></tr>\n";
  for (const auto& person : set.result.people) html += person_row(set, person);
  return html + "</table></div></details>\n";
}

std::string figures(const ReportSet& set) {
  std::string html;
  for (const auto& figure : set.figures)
    html +=
        fmt::format("<figure><img alt=\"Figure {}\" src=\"{}\"><figcaption><b>Figure {}.</b>{}</figcaption></figure>\n",
                    html_text(figure.number), html_image(figure.picture, figure.is_photo), html_text(figure.number),
                    html_text(figure.caption));
  return html;
}

std::string origin(const std::vector<ReportSet>& sets, const PersonOptions& options, const ReportContext& context) {
  std::string text =
      fmt::format("command   {}\nversion   {}\nCPU       {}\nseeds     {} to {}\n", context.command, context.version,
                  context.cpu, options.first_seed, options.first_seed + static_cast<std::uint64_t>(options.seeds) - 1);
  for (const auto& set : sets)
    text += fmt::format("timed     {}: {}, median of {} runs, {} thread{}\n", set.title, set.result.timing.frame,
                        set.result.timing.runs,
                        set.result.timing.threads == 0 ? "all" : fmt::format("{}", set.result.timing.threads),
                        set.result.timing.threads == 1 ? "" : "s");
  std::string listing;
  for (const auto& option : list_options(options.method)) listing += fmt::format("{}: {}\n", option.path, option.value);
  return fmt::format(
      "<h2>What made these numbers</h2>\n<pre>{}</pre>\n<details><summary>All options of the method "
      "(preset paper)</summary><pre>{}</pre></details>\n",
      html_text(text), html_text(listing));
}

constexpr std::string_view kIntroduction =
    "<p>The experiments of section V of Li, Toulminet, Nashashibi, <i>An improved &quot;flies&quot; method for stereo "
    "vision: application to pedestrian detection</i>, 2010 (hal-00477430), repeated with the preset <code>paper</code> "
    "on every labelled person. Numbers are as measured.</p>\n";

constexpr std::string_view kReading =
    "<p>Each number is the median over the seeds of the median over people; below it the smallest and the largest of "
    "the seeds. Smaller is better. Green: at most the paper's number; orange: more.</p>\n<ul>\n"
    "<li>The view-angle is one of those of histogram sampling, which are turned so that it is centred on the person. "
    "All flies in it count, "
    "also those that sit rightly on a wall or car behind the person; the paper's pedestrian stood nearly alone.</li>\n"
    "<li><i>Not evolved</i>: flies as they are spread, as in the paper's figure 3. <i>Evolved</i>: after the "
    "generations of the preset; the paper does not say which of the two its errors of 1.02 m and 0.09 m are.</li>\n"
    "<li><i>Flies at other things left out</i>: those near lidar returns (in synthetic scenes: near visible surfaces) "
    "of something else than the person, and not near the person.</li>\n"
    "<li>Distances and errors are on the ground, against the person's near point: where the nearest tenth of what is "
    "seen of it lies. The paper does not say which point of the pedestrian its ground truth is.</li>\n"
    "<li>The sample point is the fullest interval of the person's view-angle. When something behind the person is "
    "fitter, it is a sample point of that; the person may still be found from a view-angle beside it.</li>\n</ul>\n";

}  // namespace

std::string spread_text(const std::optional<Spread>& spread, int decimals) {
  if (!spread) return "none";
  if (spread->count == 1) return fmt::format("{:.{}f}", spread->median, decimals);
  return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", spread->median, decimals, spread->min, decimals, spread->max,
                     decimals);
}

std::string text_table(const std::vector<ReportSet>& sets) {
  std::string text = fmt::format("{:<56}{:>8}", "median (smallest to largest over the seeds)", "paper");
  for (const auto& set : sets) text += fmt::format("{:>24}", set.title);
  text += "\n";
  for (std::size_t i = 0; i < experiment_rows().size(); ++i) {
    const ExperimentRow& measure = experiment_rows()[i];
    const std::string label =
        measure.unit.empty() ? std::string(measure.label) : fmt::format("{}, {}", measure.label, measure.unit);
    text += fmt::format("{:<56}{:>8}", label,
                        measure.paper ? fmt::format("{:.{}f}", *measure.paper, measure.decimals) : "-");
    for (const auto& set : sets) text += fmt::format("{:>24}", spread_text(set.result.rows[i], measure.decimals));
    text += "\n";
  }
  for (const auto& time : kTimeRows) {
    text += fmt::format("{:<56}{:>8}", fmt::format("{}, ms", time.label),
                        time.paper_ms ? fmt::format("<= {:g}", *time.paper_ms) : "-");
    for (const auto& set : sets)
      text += fmt::format("{:>24.1f}", set.result.timing.median_ms[static_cast<std::size_t>(time.stage)]);
    text += "\n";
  }
  return text;
}

std::string html_report(const std::vector<ReportSet>& sets, const PersonOptions& options,
                        const ReportContext& context) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>flies: the paper's "
      "figures</title><style>{}</style></head>"
      "<body>\n<h1>The paper's figures and numbers, measured again</h1>\n",
      kHtmlStyle);
  html += kIntroduction;
  html += table(sets);
  html += kReading;
  html += origin(sets, options, context);
  for (const auto& set : sets)
    html += fmt::format("<h2>{}</h2>\n<p>{}</p>\n{}{}", html_text(set.title), html_text(set.description), figures(set),
                        people_table(set));
  return html + "</body></html>\n";
}

}  // namespace flies
