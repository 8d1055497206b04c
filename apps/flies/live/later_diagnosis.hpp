#pragma once

#include <future>
#include <optional>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/gray_image.hpp"
#include "shared/run_diagnosis.hpp"

/// Whether nothing is left to be found about a run: its pictures can be trusted, and the road was seen if it was asked.
bool is_settled(const RunDiagnosis& diagnosis, const RunCorrections& corrections);

/// Diagnoses pairs that come later where the first ones of a living source did not show enough: the exposure had not
/// settled yet, or the camera stood before a wall, and its mount is not known. In a thread that lets others have the
/// processor first; ever more seldom, at last once a minute.
class LaterDiagnosis {
 public:
  struct Finding {
    RunDiagnosis diagnosis;
    flies::CameraMount mount;  ///< that is to be used
  };

  /// @param calibration with the mount that was told, not one that was found
  LaterDiagnosis(flies::Calibration calibration, RunCorrections corrections);

  /// Keeps a copy of this pair if it is time for one, and begins to diagnose when there are enough.
  /// @param images rectified, rows as they came
  void offer(const flies::GrayPair& images, double time_s);

  /// What was found since this was last asked.
  /// @param is_awaited wait for a diagnosis that is being made
  std::optional<Finding> take(bool is_awaited);

 private:
  flies::Calibration calibration_;
  RunCorrections corrections_;
  std::vector<flies::GrayPair> sample_;
  std::optional<double> last_s_;  ///< time of the last pair that was kept
  double every_s_;                ///< between two pairs of a sample
  std::future<Finding> finding_;
};
