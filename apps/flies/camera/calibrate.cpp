#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/check.hpp"
#include "camera/living_boards.hpp"
#include "flies/core/error.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/io/images.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/rig/calibrate_rig.hpp"
#include "flies/rig/coverage_picture.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/image_watch.hpp"
#include "shared/named_output.hpp"
#include "shared/output_claims.hpp"
#include "shared/pair_arguments.hpp"
#include "shared/progress_bar.hpp"
#include "shared/source_options.hpp"
#include "shared/standard_output.hpp"

namespace {

struct CalibrateArguments {
  PairArguments images;
  std::string check;
  std::string kind = "chessboard", size = "9x6", lens = "pinhole";
  flies::Board board;
  std::string output, picture, json;
  bool is_living = false;
  LivingBoards living;
};

/// @returns the value of the word. @throws flies::InputError naming the option and what is allowed
template <class Value, std::size_t Count>
Value choice(const std::string& word, const char* option, const std::pair<const char*, Value> (&allowed)[Count]) {
  std::string names;
  for (const auto& [name, value] : allowed) {
    if (word == name) return value;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
  }
  throw flies::InputError(option, word, fmt::format("unknown, expected {}", names));
}

flies::Board board_of(const CalibrateArguments& arguments) {
  constexpr std::pair<const char*, flies::BoardKind> kKinds[] = {{"chessboard", flies::BoardKind::chessboard},
                                                                 {"charuco", flies::BoardKind::charuco},
                                                                 {"aprilgrid", flies::BoardKind::aprilgrid}};
  flies::Board board = arguments.board;
  board.kind = choice(arguments.kind, "--kind", kKinds);
  int end = 0;
  if (std::sscanf(arguments.size.c_str(), "%dx%d%n", &board.columns, &board.rows, &end) != 2 ||
      static_cast<std::size_t>(end) != arguments.size.size())
    throw flies::InputError("--board", arguments.size, "expected columns x rows, e.g. 9x6");
  if (board.square_m == 0.0)
    throw flies::InputError("--square", "", "is missing: give the side of a square (or tag), metres");
  flies::check_board(board);
  if (board.kind == flies::BoardKind::chessboard && board.marker_m != 0.0)
    throw flies::InputError("command line", "--marker",
                            "is for --kind charuco or aprilgrid: a chessboard has no markers");
  if (board.kind != flies::BoardKind::charuco && board.dictionary != flies::Board{}.dictionary)
    throw flies::InputError("command line", "--dictionary",
                            fmt::format("is for --kind charuco, found --kind {}", arguments.kind));
  return board;
}

flies::Lens lens_of(const CalibrateArguments& arguments) {
  constexpr std::pair<const char*, flies::Lens> kLenses[] = {{"pinhole", flies::Lens::brown},
                                                             {"fisheye", flies::Lens::equidistant}};
  return choice(arguments.lens, "--lens", kLenses);
}

/// @throws flies::InputError where this program cannot find such a board
const flies::BoardTools& tools_for(const CalibrateArguments& arguments, const flies::Board& board) {
  const auto& tools = flies::board_tools();
  if (board.kind != flies::BoardKind::chessboard && !tools.has_markers())
    throw flies::InputError("--kind", arguments.kind,
                            "needs OpenCV's aruco module, which this build lacks; allowed: chessboard");
  return tools;
}

SeenBoards find_living_boards(const CalibrateArguments& arguments, const flies::Board& board) {
  LivingBoards living = arguments.living;
  living.sources = {arguments.images.left};
  if (!arguments.images.right.empty()) living.sources.push_back(arguments.images.right);
  const flies::PairReading reading = reading_of(arguments.images.reading);
  refuse_idle_source_options(living.sources, reading.split, !living.size_px.empty());
  if (arguments.images.pair_by != PairArguments{}.pair_by)
    throw flies::InputError("command line", "--pair-by", "is for folders of images, not for --live");
  return watch_boards(living, reading, tools_for(arguments, board), board);
}

/// The board in both images; in the right one it is looked for where the left one shows it.
flies::BoardPair pair_of(const flies::BoardTools& tools, const flies::Board& board, const std::string& name,
                         const flies::GrayPair& images) {
  auto left = tools.find(images.left.view(), board);
  if (left.corners.empty()) return {name, std::move(left), {}};
  auto right = tools.find(images.right.view(), board);
  if (right.corners.empty()) left.misfit = right.misfit;
  return flies::matched_boards(board, name, std::move(left), std::move(right));
}

/// Whether pair after pair showed something else than the board: the others will, too.
bool is_other_board(const SeenBoards& seen) {
  constexpr std::size_t kEnough = 3;
  if (seen.without.size() < kEnough) return false;
  const auto& reason = seen.without.front().reason;
  return is_misfit(reason) && !reason.ends_with(flies::kPartOfBoard) &&
         std::ranges::all_of(seen.without, [&](const auto& view) { return view.reason == reason; });
}

/// A pair that cannot be read costs that pair.
SeenBoards find_boards(const CalibrateArguments& arguments, const flies::Board& board,
                       const std::vector<flies::PairPaths>& paths) {
  const flies::PairReading reading = reading_of(arguments.images.reading);
  const auto& tools = tools_for(arguments, board);
  ProgressBar bar(paths.size());
  SeenBoards seen;
  std::vector<SizedBoards> found;
  ImageWatch watch;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    bar.show(i);
    if (found.empty() && is_other_board(seen)) break;
    const auto& left = paths[i].left;
    try {
      const auto images = flies::load_pair(paths[i], reading);
      watch.look(images, left);
      auto pair = pair_of(tools, board, left, images);
      if (pair.left.corners.empty())
        seen.without.push_back({left, pair.left.misfit.empty() ? kNoBoard : pair.left.misfit});
      else
        found.push_back({std::move(pair), images.left.width_px, images.left.height_px});
    } catch (const flies::InputError& error) {
      seen.without.push_back({left, error.what()});
    }
  }
  if (!found.empty()) {
    take_commonest_size(std::move(found), seen);
    return seen;
  }
  const auto& [name, reason] = commonest_reason(seen.without);
  if (is_misfit(reason)) throw flies::InputError(name, "--board", reason);
  if (reason != kNoBoard)
    throw flies::InputError(
        arguments.images.left, "",
        fmt::format("none of {} pairs shows a board, and most of them cannot be used: {}", paths.size(), reason));
  throw flies::InputError(arguments.images.left, "board",
                          fmt::format("was found in none of {} pairs: is it a {} of {}? On a chessboard count the "
                                      "inner corners; all of them must be visible in both images",
                                      paths.size(), arguments.kind, arguments.size));
}

/// @throws flies::InputError as `flies::calibrate_rig`; of too few views it says why others were left out before
flies::RigReport calibrated(const flies::Board& board, flies::Lens lens, SeenBoards seen) {
  try {
    auto report =
        flies::calibrate_rig(flies::board_tools(), board, std::move(seen.pairs), seen.width_px, seen.height_px, lens);
    report.dropped.insert(report.dropped.end(), seen.without.begin(), seen.without.end());
    return report;
  } catch (const flies::InputError& fault) {
    throw with_reason(fault, seen.without);
  }
}

double field_of_view_deg(double focal_px, int size_px) {
  return flies::degrees(2.0 * std::atan(0.5 * size_px / focal_px));
}

constexpr double kTold_m[] = {5.0, 10.0, 20.0};

std::string table(const flies::RigReport& report) {
  const auto& solution = report.solution;
  const auto& camera = report.calibration.camera;
  std::string text =
      fmt::format("{:<32}{:>8}{:>10}{:>10}{:>11}\n", "view", "corners", "off [px]", "worst", "rows [px]");
  for (std::size_t i = 0; i < report.used.size(); ++i) {
    const auto& view = solution.views[i];
    double worst_px = 0.0;
    for (const auto& corner : view.corners) worst_px = std::max({worst_px, corner.left_px, corner.right_px});
    text += fmt::format("{:<32}{:>8}{:>10.2f}{:>10.2f}{:>11.2f}\n", report.used[i].name, view.corners.size(),
                        view.rms_px, worst_px, view.row_px);
  }
  for (const auto& view : report.dropped) text += fmt::format("{:<32}left out: {}\n", view.name, view.reason);
  const auto line = [&](const char* name, const std::string& value) { text += fmt::format("{:<24}{}\n", name, value); };
  line("corners", fmt::format("{:.2f} px off on average", solution.rms_px));
  line("rows", fmt::format("{:.2f} px apart on average after rectification", solution.row_px));
  line("baseline", fmt::format("{:.4f} m", camera.baseline_m));
  line("focal length", fmt::format("{:.2f} px left, {:.2f} px right, {:.2f} px rectified", solution.raw.left.matrix[0],
                                   solution.raw.right.matrix[0], camera.fx_px));
  line("field of view",
       fmt::format("{:.1f} deg horizontally, {:.1f} deg vertically", field_of_view_deg(camera.fx_px, camera.width_px),
                   field_of_view_deg(camera.fy_px, camera.height_px)));
  std::string deviations;
  for (const double range_m : kTold_m)
    deviations += fmt::format("{}{:.2f} m at {:.0f} m", deviations.empty() ? "" : ", ",
                              flies::range_deviation_m(camera, range_m), range_m);
  line("range error (1 sd)", deviations);
  for (const auto& note : report.notes) line("note", note);
  return text;
}

std::string json(const flies::RigReport& report) {
  const auto& solution = report.solution;
  const auto& camera = report.calibration.camera;
  nlohmann::ordered_json views = nlohmann::ordered_json::array(), dropped = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < report.used.size(); ++i) {
    const auto& pair = report.used[i];
    const auto& view = solution.views[i];
    nlohmann::ordered_json corners = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < view.corners.size(); ++k)
      corners.push_back({{"corner", pair.left.corners[k].corner},
                         {"left_px", view.corners[k].left_px},
                         {"right_px", view.corners[k].right_px},
                         {"row_px", view.corners[k].row_px}});
    views.push_back({{"name", pair.name},
                     {"rms_px", view.rms_px},
                     {"row_px", view.row_px},
                     {"distance_m", view.distance_m},
                     {"tilt_across_deg", view.tilt_across_deg},
                     {"tilt_down_deg", view.tilt_down_deg},
                     {"corners", corners}});
  }
  for (const auto& view : report.dropped) dropped.push_back({{"name", view.name}, {"reason", view.reason}});
  const nlohmann::ordered_json object = {{"rms_px", solution.rms_px},
                                         {"alone_rms_px", solution.alone_rms_px},
                                         {"row_px", solution.row_px},
                                         {"baseline_m", camera.baseline_m},
                                         {"fx_px", camera.fx_px},
                                         {"width_px", camera.width_px},
                                         {"height_px", camera.height_px},
                                         {"focal_deviation", solution.focal_deviation},
                                         {"views", views},
                                         {"dropped", dropped},
                                         {"notes", report.notes}};
  return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void check_outputs(const CalibrateArguments& arguments, const std::vector<flies::PairPaths>& paths) {
  OutputClaims claims;
  claims.reads(arguments.images.left);
  claims.reads(arguments.images.right);
  claims.reads(paths);
  claims.writes(arguments.output, "--output");
  claims.writes(arguments.picture, "--picture");
  require_named_output(arguments.picture, "--picture", ".png");
  claims.writes(arguments.json, "--json");
}

void run_calibrate(const CalibrateArguments& arguments) {
  if (!arguments.check.empty()) {
    CheckArguments check;
    check.images = arguments.images;
    check.calib = arguments.check;
    print(fmt::format("{} {}\n", arguments.check, fit_of_rig(check)));
    return;
  }
  if (arguments.output.empty())
    throw flies::InputError("--output", "", "is missing: give the file to write the calibration to");
  const auto board = board_of(arguments);
  const auto lens = lens_of(arguments);
  const auto paths = arguments.is_living ? std::vector<flies::PairPaths>{} : pairs_of(arguments.images);
  check_outputs(arguments, paths);
  auto seen = arguments.is_living ? find_living_boards(arguments, board) : find_boards(arguments, board, paths);
  const auto report = calibrated(board, lens, std::move(seen));
  flies::write_file(arguments.output,
                    flies::calibration_texts(report.calibration, flies::CalibrationSyntax::opencv).text);
  if (!arguments.picture.empty())
    flies::write_png(arguments.picture, flies::draw_coverage(report.used, report.solution));
  if (!arguments.json.empty()) flies::write_file(arguments.json, json(report));
  if (arguments.json != "-" && arguments.output != "-") print(table(report));
}

}  // namespace

void setup_calibrate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("calibrate", "calibrate two cameras from pairs that show a calibration board");
  const auto arguments = std::make_shared<CalibrateArguments>();
  add_pair_options(*command, arguments->images);
  command
      ->add_option("--board", arguments->size,
                   "columns x rows of the board: inner corners of a chessboard, squares of a charuco board, tags of an "
                   "aprilgrid; default 9x6")
      ->type_name("CxR");
  command->add_option("--kind", arguments->kind, "chessboard (default), charuco or aprilgrid")->type_name("NAME");
  command->add_option("--square", arguments->board.square_m, "side of a square or tag, metres")->type_name("M");
  command->add_option("--marker", arguments->board.marker_m, "charuco: side of a marker; aprilgrid: gap between tags")
      ->type_name("M");
  command->add_option("--dictionary", arguments->board.dictionary, "charuco: dictionary of its markers; default 4x4_50")
      ->type_name("NAME");
  command->add_option("--lens", arguments->lens, "pinhole (default) or fisheye")->type_name("NAME");
  auto* const live = command->add_flag("--live", arguments->is_living,
                                       "LEFT and RIGHT are cameras or films, as for `flies live`, or LEFT alone gives "
                                       "both images; views are taken while you hold the board");
  command->add_option("--views", arguments->living.views, "--live: end after this many views; default 20")
      ->check(in_range(5, 1000).description(""))
      ->needs(live)
      ->type_name("N");
  command
      ->add_option("--size", arguments->living.size_px,
                   "--live: picture size to ask the camera for, both pictures together")
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(16, 100000).description(""))
      ->needs(live)
      ->type_name("W,H");
  command
      ->add_option("--check", arguments->check,
                   "do not calibrate, but check with any scene whether this calibration still fits the cameras")
      ->excludes("--live")
      ->type_name("FILE");
  command->add_option("--output", arguments->output, "calibration file to write; every command reads it")
      ->excludes("--check")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--picture", arguments->picture,
                   "picture of where in both images corners were found, and where none were")
      ->excludes("--check")
      ->type_name("PNG")
      ->group("Output");
  command->add_option("--json", arguments->json, "errors of all views and corners; - is standard output")
      ->excludes("--check")
      ->type_name("FILE")
      ->group("Output");
  command->footer(
      "\nTen to twenty pairs are enough: hold the board near and far and in all corners of both images, and\n"
      "tilt each of its sides away from the cameras once. Views that are blurred or do not fit the others are\n"
      "left out and named.\n"
      "\nExamples:\n"
      "  flies calibrate left right --board 9x6 --square 0.025 --output rig.yml --picture coverage.png\n"
      "  flies calibrate both --split side --kind charuco --board 8x6 --square 0.04 --marker 0.03 --output rig.yml\n"
      "  flies calibrate 0 --live --size 2560,720 --board 9x6 --square 0.025 --output rig.yml\n"
      "  flies calibrate left.png right.png --check rig.yml\n"
      "\nExit status: 0 done; 2 an error in the input, or images that do not suffice for a calibration.");
  command->callback([arguments] { run_calibrate(*arguments); });
}
