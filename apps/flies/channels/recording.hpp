#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/record/mcap_reader.hpp"
#include "shared/camera_arguments.hpp"

/// The pairs of a recording (MCAP) with its calibration, as `flies live --record` writes them: messages in JSON of
/// Foxglove's CompressedImage, CameraCalibration and FrameTransform.
class Recording {
 public:
  /// Reads the file once, to know what is where.
  /// @throws InputError naming the file when it cannot be read, or lacks pictures or calibration of a camera
  explicit Recording(const std::string& path);

  std::size_t size() const { return pairs_.size(); }
  double time_s(std::size_t pair) const;  ///< since the first pair
  std::string name(std::size_t pair, bool is_right) const;

  /// @throws InputError naming the file and the pair when a picture is damaged
  flies::GrayPair pair(std::size_t pair) const;

  /// The camera as it was recorded, its mount overruled by what the user says.
  flies::Calibration calibration(const CameraArguments& arguments) const;

  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Pair {
    std::uint64_t time_ns = 0;
    flies::McapPlace left, right;
  };

  flies::GrayImage picture(const flies::McapPlace& place, const std::string& name) const;
  void read_calibration(const flies::McapMessage& message);

  std::string path_;
  std::unique_ptr<flies::McapReader> reader_;
  std::vector<Pair> pairs_;
  flies::StereoCamera camera_;
  bool has_left_ = false, has_right_ = false, has_mount_ = false;
  std::vector<std::string> notes_;
};
