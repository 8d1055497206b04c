// Loops as the library has them, without a race, or with one (FLIES_RACE), which the thread sanitizer must tell.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <numeric>
#include <vector>

namespace {

#ifdef FLIES_RACE
constexpr int kPlaces = 1;  // all tasks write to one
#else
constexpr int kPlaces = 1000;
#endif

int sum_of_ones(int count) {
  std::vector<int> places(1000);
  tbb::parallel_for(tbb::blocked_range<int>(0, count, 7), [&](const auto& part) {
    for (int i = part.begin(); i < part.end(); ++i) places[static_cast<std::size_t>(i % kPlaces)] += 1;
  });
  tbb::parallel_for(0, count, [&](int i) { places[static_cast<std::size_t>(i % kPlaces)] -= 1; });
  tbb::parallel_for(0, count, [&](int i) { places[static_cast<std::size_t>(i % kPlaces)] += 1; });
  return std::accumulate(places.begin(), places.end(), 0);
}

}  // namespace

int main() {
  int first = 0, second = 0;
  tbb::task_arena arena;
  arena.execute([&] { tbb::parallel_invoke([&] { first = sum_of_ones(1000); }, [&] { second = sum_of_ones(1000); }); });
  const int alone = tbb::task_arena(1).execute([] { return sum_of_ones(1000); });
  return first == 1000 && second == 1000 && alone == 1000 ? 0 : 1;
}
