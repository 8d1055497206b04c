#pragma once

#include <string>

#include "flies/io/gray_image.hpp"
#include "flies/io/images.hpp"
#include "shared/notes.hpp"

/// Tells once what was assumed of image files, and what is odd about the images: for commands that look at many pairs
/// and do not diagnose them.
class ImageWatch {
 public:
  /// @param images as they were read, before they are rectified
  void look(const flies::GrayPair& images, const std::string& source) {
    if (!are_notes_told_ && !images.notes.empty()) {
      are_notes_told_ = true;
      for (const auto& note : images.notes) say_notes({source + ": " + note});
    }
    if (is_told_ || looks_left_ == 0) return;
    --looks_left_;
    const auto notes = flies::notes_on_images(images.view());
    is_told_ = !notes.empty();
    for (const auto& note : notes) say_notes({source + ": " + note});
  }

 private:
  bool is_told_ = false, are_notes_told_ = false;
  int looks_left_ = 20;  ///< a run shows it in its first pairs, or never
};
