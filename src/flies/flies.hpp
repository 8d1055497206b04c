#pragma once

/// Everything for detection: `Detector`, its options and results, cameras, the scan's polygon, errors.
/// Images and calibrations from files are in the component `io` ("flies/io/..."), sequences in the component `track`
/// ("flies/pipeline/tracker.hpp", "flies/pipeline/engine.hpp"); matrices of OpenCV become views by
/// "flies/core/mat_view.hpp".

#include "flies/core/error.hpp"
#include "flies/core/free_space.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/road/find_mount.hpp"
#include "flies/version.hpp"
