#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// What the images say about the calibration, over a run (`PairDiagnosis`).
struct DiagnosisRecord {
  double textured_share = 0.0, matched_share = 0.0, beyond_share = 0.0;
  std::optional<double> row_offset_px, row_roll_rad;  ///< left over
  std::optional<double> corrected_offset_px;          ///< made up for
  bool road_found = false;
  CameraMount mount;                ///< that is used
  bool mount_is_from_road = false;  ///< it was found, and is not as told
  std::vector<std::string> notes;   ///< what to check, one sentence each
};

/// The line by which rows of the right image were moved: a point lay `offset_px + roll_rad * (u - middle_u_px)` rows
/// lower in it than in the left one.
struct RowCorrectionRecord {
  double offset_px = 0.0, roll_rad = 0.0, middle_u_px = 0.0;
};

/// What a run was made of, so that it can be made again.
struct RunRecord {
  std::string version;                                ///< of the program
  std::string calibration;                            ///< its file
  StereoCamera camera;                                ///< as it was used
  std::optional<RowCorrectionRecord> row_correction;  ///< of every pair; nothing: none was made
  /// What the user said of pairs and camera beside the files: names of options without their dashes, and values.
  std::vector<std::pair<std::string, std::string>> input;
  std::string people_model;
  std::string preset;                                        ///< that options start from
  std::vector<std::pair<std::string, std::string>> options;  ///< those that differ from it, by name and value
};

/// What was found in one pair, as it is written. docs/formats.md holds the schema.
struct FrameRecord {
  int frame = 0;            ///< counted from 0 in the order of processing
  std::string left, right;  ///< image files
  std::uint64_t seed = 0;
  std::string preset;
  std::vector<Obstacle> obstacles;
  std::vector<Pedestrian> pedestrians;
  Scan scan;  ///< empty: not written
  StageTimes_ms stage_ms{};
  std::optional<DiagnosisRecord> diagnosis = {};  ///< of the whole run, the same in every line
  std::shared_ptr<const RunRecord> run = {};      ///< the same in every line
  std::optional<RoadPlane> road = {};
  bool road_found = true;  ///< false: too little of it was seen, and `road` is the nominal ground
  std::string error = {};  ///< why the pair could not be used, when it could not: nothing was looked for in it then
};

/// One JSON object and a line feed: a line of JSON Lines. Numbers are rounded to millimetres, hundredths of a pixel,
/// microseconds, millionths of a radian and six digits of a score; a number that is not finite becomes null. Bytes of
/// file names that are not UTF-8 become U+FFFD.
std::string json_line(const FrameRecord& record);

/// The names of the columns, one line.
std::string csv_header();

/// One line per obstacle and per pedestrian, told apart by the column `kind`; no line when nothing was found. Fields
/// are quoted as in RFC 4180 where needed, lines end with a line feed. A number that is not finite is an empty field.
std::string csv_rows(const FrameRecord& record);

/// The names of the columns of the scan, one line.
std::string scan_csv_header();

/// One line per sector of the scan, from right to left; no line when it is empty. Numbers as in `csv_rows`.
std::string scan_csv_rows(const FrameRecord& record);

/// The flies as a point cloud, ASCII PLY: x y z in metres in the vehicle frame, colour by fitness (see
/// `fitness_color`), fitness. Flies at positions that are not finite are left out.
std::string ply_text(const Population& flies);

}  // namespace flies
