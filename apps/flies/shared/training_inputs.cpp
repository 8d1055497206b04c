#include "shared/training_inputs.hpp"

#include "flies/eval/dataset.hpp"
#include "flies/io/folder.hpp"
#include "flies/train/training_picture.hpp"

namespace {

void keep_those_that_are_there(std::vector<std::string>& folders) {
  std::erase_if(folders, [](const std::string& folder) { return !flies::detail::is_there_as_folder(folder); });
}

}  // namespace

void reads_pictures(OutputClaims& claims, std::vector<std::string> folders) {
  keep_those_that_are_there(folders);
  claims.reads(flies::files_to_train_on(folders));
}

void reads_true_pairs(OutputClaims& claims, std::vector<std::string> folders) {
  keep_those_that_are_there(folders);
  for (const auto& folder : folders) {
    const flies::Dataset dataset = flies::open_dataset(folder);
    claims.reads(dataset.pairs);
    claims.reads(dataset.files);
  }
}
