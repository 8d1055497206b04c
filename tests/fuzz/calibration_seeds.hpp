#pragma once

#include <string>
#include <vector>

namespace flies::testing {

/// A calibration of each format that `load_calibration` knows, of one small camera; where we write the format, our own
/// text. Files of one calibration follow each other, a byte of 0 between two: they are called cam0.yaml, cam1.yaml and
/// cam2.yaml.
std::vector<std::string> calibration_seeds();

}  // namespace flies::testing
