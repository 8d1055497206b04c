#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/eval/dataset.hpp"

namespace flies {

/// Boxes in the left image, by the name of the pair.
using BoxesOfPairs = std::map<std::string, std::vector<ImageBox>>;

/// Reads people who are real but not labelled, as someone who looked at the pictures listed them: lines of
/// `name,left,top,width,height,remark`, the name of the left image without its ending and the box in pixels; the remark
/// may be left out and hold commas; `#` starts a comment line.
/// @param source file name, for errors
/// @throws InputError naming the line on a missing field or one that is not a number
BoxesOfPairs parse_unlabelled(std::string_view text, const std::string& source);

/// The same from a file.
/// @throws InputError also when it cannot be read
BoxesOfPairs read_unlabelled(const std::filesystem::path& file);

/// The dataset with these boxes as regions that are ignored.
/// @throws InputError naming `source` and the pair when the dataset has none of that name
Dataset with_unlabelled(Dataset dataset, BoxesOfPairs boxes, const std::string& source);

}  // namespace flies
