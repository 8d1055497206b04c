#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/field.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/planar_motion.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/scan/best_path.hpp"
#include "flies/scan/cell_layout.hpp"
#include "flies/scan/evidence.hpp"
#include "flies/scan/kernels/match_cells.hpp"
#include "flies/scan/scan_options.hpp"

namespace flies {

/// @throws InputError naming `source` and the option out of range or the interval that is empty
void check_scan_options(const ScanOptions& options, const std::string& source);

/// Looks for the nearest obstacle in every direction that both cameras see. The pair is cut into cells of eight columns
/// and four rows, which are matched semi-globally; each cell, and each fly where `evidence.fly` is above 0, says that
/// its line of sight is free up to some range and that something is there. For every column of cells and every range
/// what speaks for an obstacle there is added up (seen itself) and what speaks against it (something seen through it,
/// something seen before it), and the cheapest path over all columns decides for neighbours together. Deterministic.
/// @param flies scored, in the vehicle frame; may be empty
/// @param field its far end is that of the scan
/// @throws InputError when the options, the field or the pair cannot be used
Scan scan(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, const Population& flies,
          const FieldOptions& field, const ScanOptions& options);

/// The same for pair after pair, whose evidence adds up where the motion between them is known. Threads: one at a time.
class Scanner {
 public:
  /// @param motion from the pair before to this one: what was known then still counts (`EvidenceOptions::memory`);
  ///               where it is not known, it is forgotten
  Scan scan(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, const Population& flies,
            const FieldOptions& field, const ScanOptions& options, const std::optional<PlanarMotion>& motion = {});

  /// The first half of `scan`: what this pair shows by itself. The motion may be measured meanwhile.
  void look(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, const Population& flies,
            const FieldOptions& field, const ScanOptions& options);
  /// The second half, for what `look` was given last.
  Scan decide(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, const FieldOptions& field,
              const ScanOptions& options, const std::optional<PlanarMotion>& motion);

 private:
  CellLayout layout_;
  kernels::CellMemory memory_;
  std::vector<kernels::CellMatch> matches_;
  std::vector<CellPoint> points_;
  Evidence evidence_, before_;
  PathMemory path_memory_;
};

}  // namespace flies
