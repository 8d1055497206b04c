#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/train/train.hpp"

namespace flies {

/// What a reader needs to make the report's numbers again.
struct TrainingContext {
  std::string command;
  std::string version;
};

/// A page that is one file: numbers, DET curve, histograms of the probabilities, the hardest mistakes, the weights.
/// @throws InputError from reading a picture
std::string training_report_html(const TrainingData& data, const TrainOptions& options, const TrainingResult& result,
                                 const TrainingContext& context);

/// The numbers as lines of text.
std::string training_summary(const TrainOptions& options, const TrainingResult& result);

/// Those of them that come from pictures kept apart, whatever machine was trained.
/// @param false_positive_rate share of the windows without people that was to pass the threshold
std::string validation_summary(const TrainingResult& result, double false_positive_rate);

/// Reads the picture of this index.
using PictureReader = std::function<GrayImage(std::uint32_t picture)>;

/// What a page says beside what `TrainingResult` holds.
struct ReportTexts {
  std::string summary;   ///< lines of numbers
  std::string remark;    ///< a paragraph below them, or empty
  std::string chapters;  ///< HTML about the machine and how it came to be
  std::vector<OptionListing> options;
  TrainingContext context;
};

/// The page of any machine: numbers, DET curve, histograms and the hardest mistakes, from the result's validation part,
/// name and threshold; then what the texts say.
/// @throws InputError as the readers
std::string training_page(const TrainingResult& result, const PictureReader& people, const PictureReader& background,
                          const ReportTexts& texts);

/// False positives a window at which the reports give detection rates.
inline constexpr double kReportedRates[] = {1e-4, 1e-3, 1e-2};

}  // namespace flies
