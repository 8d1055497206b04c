#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {

/// A person cut out of a photograph.
struct CutOut {
  GrayImage image;               ///< the photograph
  GrayImage mask;                ///< of the same size: 255 the person, 0 what is around him, soft at the edge
  ImageBox body;                 ///< around the mask's pixels from 128 on: head to feet
  double level_mean = 0.0;       ///< of the whole photograph, grey levels: how much light there was
  double level_deviation = 0.0;  ///< their standard deviation, >= 1
  double dark = 0.0;             ///< 5 % of the person's pixels are darker than this
  double bright = 255.0;         ///< 5 % are brighter than this
};

/// A cut-out with a mask that somebody made. @returns nothing when the mask shows fewer than 64 pixels
std::optional<CutOut> cut_out_by_mask(GrayImage image, GrayImage mask);

/// Cuts out the person who stands upright in the middle of a crop, by graph cuts between grey levels inside and outside
/// (Rother, Kolmogorov, Blake: "GrabCut", 2004, as OpenCV has it) that start from the outline of a standing person.
/// Same crop, same mask.
/// @param person_share height of the person over that of the crop, 0.3 to 1
/// @returns nothing when what was cut out cannot be a standing person: too thin, too wide, not from head to feet, or
///          spread over the crop's edge
std::optional<CutOut> cut_out_person(const GrayView& crop, double person_share = 0.75);

/// The people of a folder.
struct CutOuts {
  std::vector<CutOut> people;   ///< in name order
  std::size_t photographs = 0;  ///< that were tried
};

/// Cuts people out of all pictures in a folder and below. Where `NAME_mask.png` lies beside `NAME.png` (or .jpg
/// and so on), it says what the person is; else `cut_out_person` does, whose failures are left out.
/// @throws InputError naming the folder when it cannot be read or nobody could be cut out of any picture; naming the
///         mask when its size is not that of the picture
CutOuts load_cut_outs(const std::filesystem::path& folder, double person_share = 0.75);

}  // namespace flies
