#include "flies/io/foreign_files.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

using std::string_view_literals::operator""sv;  // for bytes of 0

/// What programs write that is no text, by its first bytes.
struct Binary {
  std::string_view first_bytes;
  const char* complaint;
};

constexpr const char* kPicture = "is a picture, expected the calibration of the cameras that took it";
constexpr const char* kPickle =
    "is a pickle of Python: python3 -c \"import json, pickle; print(json.dumps({k: v.tolist() for k, v in "
    "pickle.load(open('FILE', 'rb')).items()}))\" writes a dictionary of arrays as JSON, which is read";
constexpr const char* kTable = "is a table of Arrow (.feather), expected the numbers as text: as YAML or JSON";

constexpr Binary kBinaries[] = {
    {"PK\x03\x04",
     "is a zip archive, as numpy.savez writes it (.npz): python3 -c \"import json, numpy; "
     "print(json.dumps({k: v.tolist() for k, v in numpy.load('FILE').items()}))\" writes it as JSON"},
    {"\x93NUMPY",
     "is one NumPy array (.npy), expected all numbers in one text: json.dumps({'K1': numpy.load('K1.npy')"
     ".tolist(), ...}), with D1, K2, D2, R, T and image_size"},
    {"MATLAB 5.0 MAT-file", "is a MAT-file: jsonencode(toStruct(stereoParams)) in MATLAB writes what flies reads"},
    {"\x89HDF", "is an HDF5 or MAT-file: jsonencode(toStruct(stereoParams)) in MATLAB writes what flies reads"},
    {"\x89PNG", kPicture},
    {"\xFF\xD8\xFF", kPicture},
    {"II*\0"sv, kPicture},
    {"MM\0*"sv, kPicture},
    {"RIFF", kPicture},
    {"P5\n", kPicture},
    {"P6\n", kPicture},
    {"\x80\x02", kPickle},
    {"\x80\x03", kPickle},
    {"\x80\x04", kPickle},
    {"\x80\x05", kPickle},
    {"ARROW1", kTable},
    {"FEA1", kTable},
    {"%PDF", "is a PDF, as Kalibr writes its report: give camchain-*.yaml, which it writes beside it"}};

/// Texts, by words that all stand in them.
struct Text {
  std::array<std::string_view, 2> words;
  const char* complaint;
};

constexpr Text kTexts[] = {
    {{"!!python/object", "numpy"},
     "was written by yaml.dump with NumPy's numbers in it, which only Python reads: write it again with "
     ".tolist() behind each array and float() around each number"},
    {{"Camera-system parameters:", "projection:"},
     "is the text of Kalibr's results (results-cam): give camchain-*.yaml, which it writes beside it"},
    {{"  p[", "  f["},
     "holds intrinsics of a RealSense as Python prints them: give what rs-enumerate-devices -c writes, or JSON "
     "of fx, fy, ppx, ppy, width, height, coeffs of each camera and the baseline"},
    {{"relative_config_imucam:"},
     "is OpenVINS's estimator_config: give the file of the cameras that it names as relative_config_imucam "
     "(kalibr_imucam_chain.yaml)"}};

}  // namespace

void check_no_foreign_file(const std::string& bytes, const std::string& path) {
  for (const auto& [first_bytes, complaint] : kBinaries)
    if (bytes.starts_with(first_bytes)) throw InputError(path, "format", complaint);
  for (const auto& [words, complaint] : kTexts)
    if (std::ranges::all_of(words, [&](std::string_view word) { return bytes.find(word) != std::string::npos; }))
      throw InputError(path, "format", complaint);
}

}  // namespace flies::detail
