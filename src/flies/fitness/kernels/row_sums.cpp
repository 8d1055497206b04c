// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/fitness/kernels/row_sums.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <vector>

// Vectors without a compile-time size: a patch is too narrow to gain from them, NEON serves it as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/fitness/kernels/row_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR

const RowSumsKernel& kernel() { return scalar_kernel(); }

#else

namespace hn = hwy::HWY_NAMESPACE;

// Columns a vector holds: with more than 16, half of it would be empty for the usual 13 columns.
using D16 = hn::CappedTag<std::int16_t, 16>;
using D32 = hn::Repartition<std::int32_t, D16>;
using D8 = hn::Rebind<std::uint8_t, D16>;
using V16 = hn::Vec<D16>;
using V32 = hn::Vec<D32>;
constexpr int kLanes = hn::MaxLanes(D16());
constexpr int kRowsAtOnce = 4;

/// Products of column pairs are added to the same 32-bit lane: of 25 columns at most 7, as a lane takes 2 of every 8
/// and the last block of 8 has one column. They are all below 4080^2, so a lane is exact modulo 2^32 for all 33 rows.
constexpr std::int64_t kMaxProductsInLane = 7;
static_assert(kMaxRows * kMaxProductsInLane * (kScale * 255) * (kScale * 255) < (std::int64_t{1} << 32));

/// Two accumulators, as instruction sets add the products of neighbouring columns to one or to both.
struct Sum {
  V32 a, b;

  HWY_INLINE Sum() : a(hn::Zero(D32())), b(hn::Zero(D32())) {}
  HWY_INLINE void add_products(V16 x, V16 y) { a = hn::ReorderWidenMulAccumulate(D32(), x, y, a, b); }
  HWY_INLINE V32 total() const { return hn::Add(a, b); }
};

/// Where in a row's window of `kChunks` vectors the columns of the patch are.
enum class Columns {
  first,  ///< at the start; the window ends with what follows the row in its image
  last,   ///< at the end; the window starts with what precedes the row in its image
};

/// Hands out the rows of both neighbourhoods as vectors whose lanes outside the patch are 0. Never reads before the
/// first or after the last pixel of a neighbourhood in memory: upper rows are followed by others, lower ones preceded.
template <int kChunks>
class PatchReader {
 public:
  HWY_INLINE explicit PatchReader(const PatchPair& patch)
      : patch_(patch),
        next_column_(patch.fraction16 != 0 ? 1 : 0),
        excess_(kChunks * kLanes - patch.columns),
        upper_rows_(patch.rows),
        weight_(hn::Set(D16(), static_cast<std::int16_t>(kScale - patch.fraction16))),
        next_weight_(hn::Set(D16(), static_cast<std::int16_t>(patch.fraction16))),
        excess_lanes_(hn::Set(D16(), static_cast<std::int16_t>(excess_))) {
    while (upper_rows_ > 0 && (patch.rows - upper_rows_) * min_stride() < excess_) --upper_rows_;
  }

  /// Rows from the top on that have all of their window, with the columns first, inside the neighbourhood.
  int upper_rows() const { return upper_rows_; }

  /// Calls `add`(left, right) with each vector of row `j` < `upper_rows()`.
  template <class Add>
  HWY_INLINE void read_upper_row(int j, Add& add) const {
    read_window<Columns::first>(left_row(j), right_row(j), add);
  }

  /// The same for any row of the patch.
  template <class Add>
  HWY_INLINE void read_row(int j, Add& add) const {
    if (j < upper_rows_) return read_upper_row(j, add);
    if (j * min_stride() >= excess_)
      return read_window<Columns::last>(left_row(j) - excess_, right_row(j) - excess_, add);
    // An image hardly larger than the patch.
    std::uint8_t left[kChunks * kLanes + 1] = {}, right[kChunks * kLanes + 1] = {};
    std::memcpy(left, left_row(j), static_cast<std::size_t>(patch_.columns));
    std::memcpy(right, right_row(j), static_cast<std::size_t>(patch_.columns + next_column_));
    read_window<Columns::first>(left, right, add);
  }

 private:
  template <Columns kColumns, class Add>
  HWY_INLINE void read_window(const std::uint8_t* left, const std::uint8_t* right, Add& add) const {
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      const V16 l = load(left, chunk);
      const V16 r =
          hn::Add(hn::Mul(load(right, chunk), weight_), hn::Mul(load(right + next_column_, chunk), next_weight_));
      if (chunk == (kColumns == Columns::first ? kChunks - 1 : 0))
        add(hn::And(l, inside<kColumns>()), hn::And(r, inside<kColumns>()));
      else
        add(l, r);
    }
  }
  HWY_INLINE static V16 load(const std::uint8_t* row, int chunk) {
    return hn::PromoteTo(D16(), hn::LoadU(D8(), row + chunk * kLanes));
  }
  /// All ones in the lanes of the patch, in the one vector that has others too.
  template <Columns kColumns>
  HWY_INLINE V16 inside() const {
    const V16 lane = hn::Iota(D16(), 0);
    if constexpr (kColumns == Columns::last) return hn::VecFromMask(D16(), hn::Not(hn::Lt(lane, excess_lanes_)));
    return hn::VecFromMask(D16(), hn::Lt(lane, hn::Sub(hn::Set(D16(), kLanes), excess_lanes_)));
  }

  std::ptrdiff_t min_stride() const { return std::min(patch_.left_stride, patch_.right_stride); }
  const std::uint8_t* left_row(int j) const { return patch_.left + j * patch_.left_stride; }
  const std::uint8_t* right_row(int j) const { return patch_.right + j * patch_.right_stride; }

  const PatchPair patch_;
  int next_column_;
  int excess_;  ///< columns of a window that are not the patch's
  int upper_rows_;
  V16 weight_, next_weight_, excess_lanes_;
};

/// The sums of one row, each still spread over the lanes.
struct Row {
  V32 l, r, lr;
};

/// Adds up a row, and the squares of all rows.
template <bool kWithSquares>
struct RowAdder {
  V16 l, r;  // of at most four columns a lane: below 2^15
  Sum lr, ll, rr;

  HWY_INLINE RowAdder() : l(hn::Zero(D16())), r(hn::Zero(D16())) {}
  HWY_INLINE void operator()(V16 left, V16 right) {
    l = hn::Add(l, left);
    r = hn::Add(r, right);
    lr.add_products(left, right);
    if constexpr (kWithSquares) {
      ll.add_products(left, left);
      rr.add_products(right, right);
    }
  }
  /// The row so far; starts the next one.
  HWY_INLINE Row take_row() {
    const V16 one = hn::Set(D16(), 1);
    Sum l_pairs, r_pairs;
    l_pairs.add_products(l, one);
    r_pairs.add_products(r, one);
    const Row row = {l_pairs.total(), r_pairs.total(), lr.total()};
    l = r = hn::Zero(D16());
    lr = Sum();
    return row;
  }
};

/// Adds up squared differences.
struct DifferenceAdder {
  Sum squares;

  HWY_INLINE DifferenceAdder() {}
  HWY_INLINE void operator()(V16 left, V16 right) {
    const V16 difference = hn::Sub(hn::ShiftLeft<4>(left), right);
    squares.add_products(difference, difference);
  }
};

/// Writes the sums of the lanes of four vectors.
HWY_INLINE void store_lane_sums(V32 v0, V32 v1, V32 v2, V32 v3, std::int32_t* sums) {
  const D32 d;
  const hn::Repartition<std::int64_t, D32> pairs;
  const V32 v01 = hn::Add(hn::InterleaveLower(d, v0, v1), hn::InterleaveUpper(d, v0, v1));
  const V32 v23 = hn::Add(hn::InterleaveLower(d, v2, v3), hn::InterleaveUpper(d, v2, v3));
  const auto p01 = hn::BitCast(pairs, v01), p23 = hn::BitCast(pairs, v23);
  const V32 blocks = hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, p01, p23)),
                             hn::BitCast(d, hn::InterleaveUpper(pairs, p01, p23)));
  if constexpr (hn::MaxLanes(D32()) == 8) {
    const hn::Half<D32> half;
    hn::StoreU(hn::Add(hn::LowerHalf(half, blocks), hn::UpperHalf(half, blocks)), half, sums);
  } else {
    static_assert(hn::MaxLanes(D32()) == 4 || hn::MaxLanes(D32()) == 8);
    hn::StoreU(blocks, d, sums);
  }
}

/// Sum of lanes that are not negative and exact modulo 2^32.
HWY_INLINE std::int64_t sum_unsigned_lanes(const Sum& sum) {
  std::int64_t total = 0;
  for (const V32 v : {sum.a, sum.b}) {
    alignas(64) std::int32_t lanes[hn::MaxLanes(D32())];
    hn::Store(v, D32(), lanes);
    for (const std::int32_t lane : lanes) total += static_cast<std::uint32_t>(lane);
  }
  return total;
}

HWY_INLINE void store_rows(const Row& row0, const Row& row1, const Row& row2, const Row& row3, int j, RowSums& sums) {
  store_lane_sums(row0.l, row1.l, row2.l, row3.l, sums.l.data() + j);
  store_lane_sums(row0.r, row1.r, row2.r, row3.r, sums.r.data() + j);
  store_lane_sums(row0.lr, row1.lr, row2.lr, row3.lr, sums.lr.data() + j);
}

template <bool kWithSquares, int kChunks>
void sum_rows_of(const PatchPair& patch, RowSums& sums) {
  static_assert(RowSums::kCapacity % kRowsAtOnce == 0 && RowSums::kCapacity >= kMaxRows);
  const PatchReader<kChunks> reader(patch);
  RowAdder<kWithSquares> add;
  int j = 0;
  for (; j + kRowsAtOnce <= reader.upper_rows(); j += kRowsAtOnce) {
    reader.read_upper_row(j, add);
    const Row row0 = add.take_row();
    reader.read_upper_row(j + 1, add);
    const Row row1 = add.take_row();
    reader.read_upper_row(j + 2, add);
    const Row row2 = add.take_row();
    reader.read_upper_row(j + 3, add);
    store_rows(row0, row1, row2, add.take_row(), j, sums);
  }
  for (; j < patch.rows; j += kRowsAtOnce) {
    Row rows[kRowsAtOnce];
    for (int k = 0; k < kRowsAtOnce; ++k) {
      if (j + k < patch.rows) reader.read_row(j + k, add);
      rows[k] = add.take_row();
    }
    store_rows(rows[0], rows[1], rows[2], rows[3], j, sums);
  }
  sums.ll = kWithSquares ? sum_unsigned_lanes(add.ll) : 0;
  sums.rr = kWithSquares ? sum_unsigned_lanes(add.rr) : 0;
}

template <int kChunks>
std::int64_t add_squared_differences(const PatchPair& patch) {
  const PatchReader<kChunks> reader(patch);
  DifferenceAdder add;
  int j = 0;
  for (; j < reader.upper_rows(); ++j) reader.read_upper_row(j, add);
  for (; j < patch.rows; ++j) reader.read_row(j, add);
  return sum_unsigned_lanes(add.squares);
}

int chunks_of(const PatchPair& patch) {
  assert(patch.columns >= 1 && patch.columns <= kMaxColumns && patch.rows >= 1 && patch.rows <= kMaxRows);
  return (patch.columns + kLanes - 1) / kLanes;
}

template <bool kWithSquares>
void sum_rows(const PatchPair& patch, RowSums& sums) {
  const int chunks = chunks_of(patch);
  if (chunks == 1) return sum_rows_of<kWithSquares, 1>(patch, sums);
  if constexpr (kLanes == 16) {
    sum_rows_of<kWithSquares, 2>(patch, sums);
  } else {
    if (chunks == 2) return sum_rows_of<kWithSquares, 2>(patch, sums);
    if (chunks == 3) return sum_rows_of<kWithSquares, 3>(patch, sums);
    sum_rows_of<kWithSquares, 4>(patch, sums);
  }
}

std::int64_t sum_squares_of_differences(const PatchPair& patch) {
  const int chunks = chunks_of(patch);
  if (chunks == 1) return add_squared_differences<1>(patch);
  if constexpr (kLanes == 16) {
    return add_squared_differences<2>(patch);
  } else {
    if (chunks == 2) return add_squared_differences<2>(patch);
    if (chunks == 3) return add_squared_differences<3>(patch);
    return add_squared_differences<4>(patch);
  }
}

const RowSumsKernel& kernel() {
  static const RowSumsKernel kernel = {hwy::TargetName(HWY_TARGET), sum_rows<false>, sum_rows<true>,
                                       sum_squares_of_differences};
  return kernel;
}

#endif  // HWY_TARGET == HWY_SCALAR
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {
namespace {

HWY_EXPORT(kernel);

const RowSumsKernel& kernel_for([[maybe_unused]] std::int64_t target) {
#if (HWY_TARGETS & (HWY_TARGETS - 1)) == 0
  return HWY_STATIC_DISPATCH(kernel)();
#else
  // A choice of our own: the one inside Highway is shared with every other library of the process.
  hwy::ChosenTarget choice;
  choice.Update(target);
  return HWY_DISPATCH_TABLE(kernel)[choice.GetIndex()]();
#endif
}

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

std::span<const RowSumsKernel> supported_kernels() {
  static const std::vector<RowSumsKernel> kernels = [] {
    std::vector<RowSumsKernel> found;
    // Highway lists the better ones first.
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
      if (target != HWY_SCALAR) found.push_back(kernel_for(target));
    found.push_back(scalar_kernel());
    return found;
  }();
  return kernels;
}

const RowSumsKernel& select_kernel(std::string_view wanted) {
  const auto kernels = supported_kernels();
  const auto named = std::ranges::find_if(
      kernels, [&](const RowSumsKernel& candidate) { return same_letters(candidate.target, wanted); });
  return named == kernels.end() ? kernels.front() : *named;
}

const RowSumsKernel& chosen_kernel() {
  static const RowSumsKernel& chosen = [&]() -> const RowSumsKernel& {
    const char* wanted = std::getenv("FLIES_TARGET");
    return select_kernel(wanted == nullptr ? "" : wanted);
  }();
  return chosen;
}

}  // namespace flies::kernels
#endif  // HWY_ONCE
