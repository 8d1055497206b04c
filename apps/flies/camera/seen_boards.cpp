#include "camera/seen_boards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

void take_commonest_size(std::vector<SizedBoards> found, SeenBoards& seen) {
  std::map<std::pair<int, int>, int> counts;
  for (const auto& pair : found) ++counts[pair.size()];
  const auto commonest =
      std::ranges::max_element(found, {}, [&](const SizedBoards& pair) { return counts[pair.size()]; })->size();
  std::tie(seen.width_px, seen.height_px) = commonest;
  for (auto& pair : found)
    if (pair.size() == commonest)
      seen.pairs.push_back(std::move(pair.boards));
    else
      seen.without.push_back(
          {pair.boards.name, fmt::format("size: found {} x {} px, expected {} x {} px as most pairs have",
                                         pair.width_px, pair.height_px, seen.width_px, seen.height_px)});
}

const flies::DroppedView& commonest_reason(const std::vector<flies::DroppedView>& views) {
  const auto kind_of = [](const flies::DroppedView& view) {
    std::string kind = view.reason;
    std::erase_if(kind, [](char letter) { return (letter >= '0' && letter <= '9') || letter == '.'; });
    return kind;
  };
  // Of a kind the very words that are commonest: numbers that many agree on are worth telling.
  std::map<std::string, int> kinds, reasons;
  for (const auto& view : views) ++kinds[kind_of(view)], ++reasons[view.reason];
  return *std::ranges::max_element(
      views, {}, [&](const auto& view) { return std::pair(kinds[kind_of(view)], reasons[view.reason]); });
}

flies::InputError with_reason(const flies::InputError& fault, const std::vector<flies::DroppedView>& without) {
  const std::string text = fault.what(), of_views = "calibration: views: ";
  if (without.empty() || !text.starts_with(of_views)) return fault;
  const auto& [name, reason] = commonest_reason(without);
  return {"calibration", "views",
          fmt::format("{}; {} pairs were left out before, most as {}: {}", text.substr(of_views.size()), without.size(),
                      name, reason)};
}
