#include "flies/train/training_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/draw/curves.hpp"
#include "flies/draw/html.hpp"
#include "flies/train/weights_picture.hpp"

namespace flies {
namespace {

constexpr int kSheetColumns = 16;
constexpr int kTileWidth_px = 64;
constexpr int kTileHeight_px = 128;
constexpr int kCaption_px = 14;

std::string figure(const cv::Mat& picture, const std::string& caption, bool is_photo = false) {
  return fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n", html_text(caption),
                     html_image(picture, is_photo));
}

cv::Mat tile(const GrayImage& image, const ImageBox& window) {
  const cv::Mat pixels = mat_of(image.view());
  // From the tile to the picture: where a window leaves the picture, the border is repeated, as in detection.
  const double scale = window.height_px / kTileHeight_px;
  const cv::Matx23d picture_from_tile(scale, 0.0, window.u_px, 0.0, scale, window.v_px);
  cv::Mat result;
  cv::warpAffine(pixels, result, picture_from_tile, {kTileWidth_px, kTileHeight_px},
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return result;
}

/// Windows in rows, their probability below each.
cv::Mat contact_sheet(const PictureReader& pictures, std::span<const JudgedWindow> windows) {
  const int count = static_cast<int>(windows.size());
  const int columns = std::min(count, kSheetColumns), rows = (count + kSheetColumns - 1) / kSheetColumns;
  cv::Mat sheet(rows * (kTileHeight_px + kCaption_px), columns * kTileWidth_px, CV_8U, cv::Scalar(255));
  for (int i = 0; i < count; ++i) {
    const JudgedWindow& judged = windows[static_cast<std::size_t>(i)];
    const cv::Point corner(i % kSheetColumns * kTileWidth_px, i / kSheetColumns * (kTileHeight_px + kCaption_px));
    tile(pictures(judged.window.picture), judged.window.window)
        .copyTo(sheet(cv::Rect(corner, cv::Size(kTileWidth_px, kTileHeight_px))));
    cv::putText(sheet, fmt::format("{:.4f}", judged.probability), corner + cv::Point(6, kTileHeight_px + 11),
                cv::FONT_HERSHEY_SIMPLEX, 0.35, cv::Scalar(0), 1, cv::LINE_AA);
  }
  return sheet;
}

std::string rates_table(const TrainingResult& result) {
  std::string html = "<div class=\"scroll\"><table><tr><th>false positives a window</th><th>people found</th></tr>\n";
  for (const auto& rate : detection_rates(result.validation, kReportedRates))
    if (rate.set.empty())
      html += fmt::format("<tr><td>{:g}</td><td>{}</td></tr>\n", rate.false_positives_per_window,
                          rate.is_measured ? fmt::format("{:.1f} %", 100 * rate.rate) : "too few windows to tell");
  return html + "</table></div>\n";
}

std::string rounds_table(const TrainingResult& result) {
  std::string html =
      "<div class=\"scroll\"><table><tr><th>background</th><th>hard windows found</th><th>windows learnt from "
      "then</th></tr>\n";
  for (const auto& round : result.rounds)
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", html_text(round.name), round.hard,
                        round.learnt_from);
  return html + "</table></div>\n";
}

std::string curves(const TrainingResult& result) {
  ErrorCurve curve{"validation", error_points(result.validation), {}};
  std::size_t passed = 0, all = 0;
  ScorePlot plot{"probability", {}, {}, result.model.threshold};
  for (const auto& picture : result.validation.negatives) {
    for (const double probability : picture) {
      ++all;
      passed += probability > result.model.threshold;
      plot.negatives.push_back(probability);
    }
  }
  for (const auto& set : result.validation.positives)
    plot.positives.insert(plot.positives.end(), set.scores.begin(), set.scores.end());
  if (all > 0)
    curve.operating_point =
        ErrorPoint{static_cast<double>(passed) / static_cast<double>(all), 1.0 - result.validation_rate};
  return figure(draw_error_curves({&curve, 1}),
                "People missed over false positives a window, on pictures kept apart. The dot is the threshold.") +
         figure(draw_score_histograms(plot), "Probabilities of windows with and without people, on the same pictures.");
}

}  // namespace

std::string validation_summary(const TrainingResult& result, double false_positive_rate) {
  std::size_t background = 0;
  for (const auto& picture : result.validation.negatives) background += picture.size();
  std::string text = fmt::format("validated on   {} windows with people, {} without, of pictures kept apart\n",
                                 result.validation.positives.front().scores.size(), background);
  if (background > 0 && !result.validation.positives.front().scores.empty())
    for (const auto& rate : detection_rates(result.validation, kReportedRates))
      if (rate.set.empty())
        text += rate.is_measured ? fmt::format("               {:.1f} % of people at {:g} false positives a window\n",
                                               100 * rate.rate, rate.false_positives_per_window)
                                 : fmt::format(
                                       "               too few windows without people to tell of {:g} false "
                                       "positives a window\n",
                                       rate.false_positives_per_window);
  const std::string threshold =
      can_tell(background, false_positive_rate)
          ? fmt::format("for {:g} false positives a window", false_positive_rate)
          : fmt::format("(no window without people is above it: too few for {:g} false positives a window)",
                        false_positive_rate);
  return text + fmt::format("threshold      {:.4f} {}; finds {:.1f} % of people\n", result.model.threshold, threshold,
                            100 * result.validation_rate);
}

std::string training_summary(const TrainOptions& options, const TrainingResult& result) {
  std::string text =
      fmt::format("learnt from    {} windows with people, {} without\n", result.people, result.background);
  if (result.model.kernel)
    text += fmt::format("kernel machine {} support vectors, {} axes\n", result.model.kernel->support_vectors.rows,
                        result.model.kernel->support_vectors.columns);
  return text + validation_summary(result, options.false_positive_rate);
}

std::string training_page(const TrainingResult& result, const PictureReader& people, const PictureReader& background,
                          const ReportTexts& texts) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>flies: training of {0}</title><style>{1}</style></head>"
      "<body>\n<h1>Training of {0}</h1>\n<pre>{2}</pre>\n",
      html_text(result.model.name), kHtmlStyle, html_text(texts.summary));
  if (!texts.remark.empty()) html += fmt::format("<p>{}</p>\n", html_text(texts.remark));
  html += "<h2>On pictures kept apart</h2>\n" + rates_table(result) + curves(result);
  html += "<h2>Hardest mistakes</h2>\n";
  if (!result.mistaken.empty())
    html += figure(contact_sheet(background, result.mistaken),
                   "Windows without people that are most like one, with their probability.", true);
  if (!result.missed.empty())
    html += figure(contact_sheet(people, result.missed),
                   "Windows with people that are least like one, with their probability.", true);
  std::string listing;
  for (const auto& option : texts.options) listing += fmt::format("{}: {}\n", option.path, option.value);
  return html + texts.chapters +
         fmt::format(
             "<h2>What made this</h2>\n<pre>command   {}\nversion   {}\n</pre>\n<details><summary>All options"
             "</summary><pre>{}</pre></details>\n</body></html>\n",
             html_text(texts.context.command), html_text(texts.context.version), html_text(listing));
}

std::string training_report_html(const TrainingData& data, const TrainOptions& options, const TrainingResult& result,
                                 const TrainingContext& context) {
  ReportTexts texts{training_summary(options, result), "", "", list_options(options), context};
  if (options.refit)
    texts.remark =
        "The numbers and pictures are of machines that did not learn from the pictures kept apart; what was written "
        "learnt from those as well, with the same calibration and threshold.";
  texts.chapters = "<h2>Weights of the linear machine</h2>\n" +
                   figure(draw_weights(result.model.linear.weights, result.model.hog),
                          "Left: edges that speak for a person; right: edges that speak against.") +
                   "<h2>Background learnt from</h2>\n" + rounds_table(result);
  return training_page(
      result, [&](std::uint32_t picture) { return load_picture(data.people[picture]); },
      [&](std::uint32_t picture) { return load_picture(data.background[picture]); }, texts);
}

}  // namespace flies
