#include "network_report.hpp"

#include <fmt/format.h>

namespace flies {
namespace {

std::string epochs_table(std::span<const EpochSummary> epochs) {
  std::string html =
      "<h2>Epochs</h2>\n<div class=\"scroll\"><table><tr><th>epoch</th><th>mean loss</th><th>hard windows without "
      "people "
      "known then</th></tr>\n";
  for (std::size_t i = 0; i < epochs.size(); ++i)
    html += fmt::format("<tr><td>{}</td><td>{:.4f}</td><td>{}</td></tr>\n", i + 1, epochs[i].loss, epochs[i].hard);
  return html + "</table></div>\n";
}

}  // namespace

std::string network_summary(const TrainingResult& result, const JudgingOptions& options) {
  return validation_summary(result, options.background_share);
}

std::string network_report_html(const TrainingResult& result, std::span<const Picture> kept_apart,
                                std::span<const EpochSummary> epochs, const LearningOptions& learning,
                                const JudgingOptions& judging, const TrainingContext& context) {
  ReportTexts texts{network_summary(result, judging), "", "", list_options(judging), context};
  texts.remark =
      "Calibration, the say of the linear machine and the threshold were fitted on these same windows, weights were "
      "not. Every person is there twice: as labelled, and moved by as much as proposed boxes are.";
  if (!epochs.empty()) {
    texts.chapters = epochs_table(epochs);
    const auto learnt = list_options(learning);
    texts.options.insert(texts.options.begin(), learnt.begin(), learnt.end());
  }
  const auto picture = [&](std::uint32_t index) { return kept_apart[index].image; };
  return training_page(result, picture, picture, texts);
}

}  // namespace flies
