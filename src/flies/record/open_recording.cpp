#include <fstream>
#include <string>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/placeholder.hpp"
#include "flies/record/bag_reader.hpp"
#include "flies/record/mcap_reader.hpp"

namespace flies {

std::unique_ptr<RecordingReader> open_recording(const std::string& path) {
  if (const auto fault = detail::placeholder_fault_of_file(path); !fault.empty()) throw InputError(path, "", fault);
  std::ifstream file(path, std::ios::binary);
  constexpr std::string_view kBag = "#ROSBAG";
  std::string start(kBag.size(), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start == kBag || path.ends_with(".bag")) return std::make_unique<BagReader>(path);
  return std::make_unique<McapReader>(path);
}

}  // namespace flies
