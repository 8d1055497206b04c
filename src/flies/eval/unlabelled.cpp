#include "flies/eval/unlabelled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"

namespace flies {

BoxesOfPairs parse_unlabelled(std::string_view text, const std::string& source) {
  constexpr std::size_t kNumbers = 4;
  BoxesOfPairs boxes;
  for (const auto& [number, content] : detail::lines_of(text)) {
    const std::string field = fmt::format("line {}", number);
    std::istringstream words{content};
    std::string name;
    std::getline(words, name, ',');
    std::vector<double> values;
    for (std::string word; values.size() < kNumbers && std::getline(words, word, ',');)
      values.push_back(detail::parse_number(detail::trimmed(word), source, field));
    if (values.size() != kNumbers)
      throw InputError(source, field,
                       fmt::format("found {} fields, expected name,left,top,width,height", values.size() + 1));
    boxes[std::string(detail::trimmed(name))].push_back({values[0], values[1], values[2], values[3]});
  }
  return boxes;
}

BoxesOfPairs read_unlabelled(const std::filesystem::path& file) {
  return parse_unlabelled(detail::read_truth(file), file.string());
}

Dataset with_unlabelled(Dataset dataset, BoxesOfPairs boxes, const std::string& source) {
  for (const auto& [name, of_pair] : boxes)
    if (std::none_of(dataset.pairs.begin(), dataset.pairs.end(), [&, &name = name](const PairPaths& pair) {
          return std::filesystem::path(pair.left).stem() == name;
        }))
      throw InputError(source, name, "found no pair of that name in the folder of truth");
  dataset.load = [load = std::move(dataset.load), boxes = std::move(boxes)](std::size_t i) {
    TruthFrame frame = load(i);
    if (const auto found = boxes.find(frame.truth.name); found != boxes.end())
      frame.truth.ignored_regions.insert(frame.truth.ignored_regions.end(), found->second.begin(), found->second.end());
    return frame;
  };
  return dataset;
}

}  // namespace flies
