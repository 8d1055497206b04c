#pragma once

#include <string>
#include <vector>

namespace flies::testing {

/// Recordings with pictures and a calibration: MCAP files and bags of ROS 1, compressed in each way that is read.
std::vector<std::string> recording_seeds();

}  // namespace flies::testing
