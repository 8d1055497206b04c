#pragma once

#include <string>
#include <vector>

#include "flies/reproduce/paper_figures.hpp"
#include "flies/reproduce/reproduce.hpp"

/// The results of `reproduce` as text.
namespace flies {

/// What made the numbers; printed beside them.
struct ReportContext {
  std::string command;  ///< as typed
  std::string version;  ///< of the program, with build type and compiler
  std::string cpu;
};

/// A set, what was measured on it and its pictures.
struct ReportSet {
  std::string title, description;
  std::vector<std::string> frames;  ///< names
  SetResult result;
  std::vector<PaperFigure> figures;
};

/// One HTML page that holds everything: pictures are data URIs, nothing is loaded from elsewhere.
std::string html_report(const std::vector<ReportSet>& sets, const PersonOptions& options, const ReportContext& context);

/// The numbers as one JSON object; docs/reproduce.md holds the schema. A missing value is null.
std::string json_report(const std::vector<ReportSet>& sets, const PersonOptions& options, const ReportContext& context);

/// The table as plain text.
std::string text_table(const std::vector<ReportSet>& sets);

/// "2.94" or "2.94 (2.60 to 3.10)"; "none" for a missing spread. The bracket holds smallest and largest of the seeds.
std::string spread_text(const std::optional<Spread>& spread, int decimals);

}  // namespace flies
