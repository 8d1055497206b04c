#include "network_checkpoint.hpp"

#include <fmt/format.h>
#include <torch/version.h>

#include <string_view>
#include <system_error>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/text_file.hpp"
#include "flies/train/fingerprint.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStateFile = "network.state";
/// First line of a state. Then come the training's fingerprint, that of the bytes that follow, and these.
constexpr std::string_view kFormat = "flies network training 1\n";
constexpr std::size_t kDigits = 16;
constexpr std::size_t kMaxState_bytes = std::size_t{1} << 30;  // states have some megabytes

std::string fingerprint_of_bytes(std::string_view bytes) {
  Fingerprint fingerprint;
  fingerprint.add(bytes);
  return fingerprint.text();
}

}  // namespace

std::string fingerprint_of_learning(std::span<const Picture> pictures, const LearningOptions& options,
                                    const std::string& shape) {
  Fingerprint fingerprint;
  fingerprint.add(shape);
  fingerprint.add(TORCH_VERSION);
  for (const auto& listing : list_options(options)) fingerprint.add(listing.path + "=" + listing.value);
  for (const auto& picture : pictures) {
    fingerprint.add(picture.name);
    fingerprint.add(fmt::format("{} {} {} {}", picture.image.width_px, picture.image.height_px, picture.has_background,
                                picture.has_proposals));
    fingerprint.add({reinterpret_cast<const char*>(picture.image.pixels.data()), picture.image.pixels.size()});
    fingerprint.add(picture.people);
    fingerprint.add(picture.unclear);
    fingerprint.add(picture.proposals);
  }
  return fingerprint.text();
}

NetworkCheckpoint::NetworkCheckpoint(fs::path folder, std::string fingerprint)
    : folder_(std::move(folder)), file_(folder_ / kStateFile), fingerprint_(std::move(fingerprint)) {}

void NetworkCheckpoint::restore(Learning& learning) const {
  if (!detail::is_there(file_)) return;
  const InputError damaged(file_.string(), "",
                           "is damaged, expected the state of a training; remove it to start again");
  const std::string text = read_bytes(file_.string(), kMaxState_bytes);
  constexpr std::size_t kHead = kFormat.size() + 2 * (kDigits + 1);
  if (text.size() < kHead || !text.starts_with(kFormat)) throw damaged;
  const std::string_view rest = std::string_view(text).substr(kFormat.size());
  const std::string bytes = text.substr(kHead);
  if (rest.substr(kDigits + 1, kDigits) != fingerprint_of_bytes(bytes)) throw damaged;
  if (rest.substr(0, kDigits) != fingerprint_)
    throw InputError(folder_.string(), "",
                     "holds the state of a training with other pictures or options; remove it or name another folder");
  if (!learning.restore(bytes)) throw damaged;
}

void NetworkCheckpoint::save(Learning& learning) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw InputError(folder_.string(), "", "cannot create the folder: " + error.message());
  const std::string bytes = learning.state();
  write_file(file_.string(), fmt::format("{}{}\n{}\n", kFormat, fingerprint_, fingerprint_of_bytes(bytes)) + bytes);
}

void NetworkCheckpoint::remove() const {
  std::error_code error;  // what cannot be removed does no harm
  fs::remove(file_, error);
  fs::remove(folder_, error);
}

}  // namespace flies
