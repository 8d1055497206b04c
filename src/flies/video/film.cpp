#include "flies/video/film.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/exclusive_file.hpp"
#include "flies/io/unfinished_outputs.hpp"
#include "flies/video/lazy_module.hpp"

namespace fs = std::filesystem;

namespace flies {

Film::Film(const std::string& path, double rate_hz) : path_(path), rate_hz_(rate_hz) {
  if (fs::path(path).extension() != ".mp4")
    throw InputError(path, "", "has another ending, expected .mp4: only MP4 films are written");
  if (!(rate_hz > 0.0))
    throw InputError(path, "rate", fmt::format("found {} pictures a second, expected more", rate_hz));
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path, "", "is a folder, expected a file to write");
  const fs::path folder = fs::absolute(path, error).parent_path();
  if (!fs::is_directory(folder, error)) throw InputError(path, "", "cannot be written: its folder does not exist");
  if (::access(folder.c_str(), W_OK) != 0)
    throw InputError(path, "", fmt::format("cannot be written: {}", std::strerror(errno)));
  check_not_being_written(path);
  part_path_ = path + ".part.mp4";
}

Film::~Film() {
  encoder_.reset();
  if (lock_ < 0) return;
  ::unlink(part_path_.c_str());
  release();
}

/// Of the part's name: from now on it may be another run's.
void Film::release() {
  forget_unfinished_output(part_path_);
  ::close(std::exchange(lock_, -1));
}

void Film::add(const cv::Mat& picture) {
  const cv::Size even(picture.cols / 2 * 2, picture.rows / 2 * 2);
  if (!encoder_) {
    const auto open = reinterpret_cast<OpenFilmFunction>(module_function("flies_video", kOpenFilmName));
    lock_ = open_exclusively(part_path_, path_);
    note_unfinished_output(part_path_);
    size_ = even;
    encoder_.reset(open(part_path_, rate_hz_, size_));
    if (!encoder_) throw InputError(path_, "", "cannot be written as a film; does OpenCV's videoio have FFmpeg here?");
  }
  if (even != size_)
    throw InputError(path_, "",
                     fmt::format("found a picture of {} x {} px after ones of {} x {} px", picture.cols, picture.rows,
                                 size_.width, size_.height));
  encoder_->add(picture(cv::Rect({}, size_)));
  ++pictures_;
}

void Film::commit() {
  if (!encoder_) throw InputError(path_, "", "no picture came, so there is no film");
  const std::size_t written = encoder_->finish();
  if (written < pictures_)
    throw InputError(
        path_, "",
        fmt::format("cannot be written: {} of {} pictures got into the film; is the disk full?", written, pictures_));
  if (std::rename(part_path_.c_str(), path_.c_str()) != 0)
    throw InputError(path_, "", fmt::format("cannot be written: {}", std::strerror(errno)));
  release();
}

}  // namespace flies
