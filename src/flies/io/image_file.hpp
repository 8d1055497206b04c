#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace flies::detail {

enum class ImageFileKind { png, jpeg, pnm, tiff, webp, bmp, unknown };

/// What can be read, for error messages.
inline constexpr std::string_view kReadableImages = "PNG, JPEG, PGM, PPM, TIFF, WebP or BMP";

ImageFileKind image_file_kind(std::string_view bytes);

/// Checks that an image file is whole, because decoders fill what is missing with grey or black and only warn:
/// PNG chunk by chunk with its checksums, JPEG marker by marker up to the end of the image, PNM and WebP by their
/// size. (The decoders of TIFF and BMP do fail on missing data.)
/// @returns what is wrong, empty when nothing is
std::string image_file_fault(std::string_view bytes);

/// The next number of a PNM file from `at` on, past blanks and comments; `at` moves behind it.
std::optional<std::size_t> pnm_number(std::string_view bytes, std::size_t& at);

}  // namespace flies::detail
