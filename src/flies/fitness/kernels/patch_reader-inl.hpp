// How vector_kernel.cpp reads a patch, once for each instruction set: no include guard. Needs row_vectors-inl.hpp.

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

constexpr int kFirstChunk = 12;  ///< columns of the first of two chunks; even, as pairs of weights start at even bytes

/// Which bytes of a row's block count how much, for a chunk of up to 15 columns. What is outside the patch weighs 0.
struct ChunkWeights {
  V8 widen_left[kParts];    ///< table: columns to 16 bits
  V8 pair_right[kParts];    ///< table: columns to pairs with the next one
  V8 inside_pairs[kParts];  ///< all ones in the pairs of the patch
  V8 row[kParts];           ///< of the columns that count in full: 1 on the left, 16 on the right
  V8 row_ends[kParts];      ///< all ones in the first right column of the patch and behind its last one

  HWY_INLINE ChunkWeights() {}
  HWY_INLINE void set(int columns, bool is_first, bool is_last) {
    std::uint8_t left[32], right[32], inside[32], full[32] = {}, ends[32] = {};
    for (int i = 0; i < 16; ++i) {
      const bool counts = i < columns;
      left[2 * i] = static_cast<std::uint8_t>(counts ? i : 0x80);
      left[2 * i + 1] = 0x80;
      right[2 * i] = static_cast<std::uint8_t>(i);
      right[2 * i + 1] = static_cast<std::uint8_t>(counts ? i + 1 : i);
      inside[2 * i] = inside[2 * i + 1] = counts ? 0xFF : 0;
      full[i] = counts ? 1 : 0;
      full[16 + i] = counts && (i > 0 || !is_first) ? kScale : 0;
    }
    if (is_first) ends[16] = 0xFF;
    if (is_last) ends[16 + columns] = 0xFF;
    for (int p = 0; p < kParts; ++p) {
      const int at = p * 16;
      widen_left[p] = hn::LoadU(D8(), left + at);
      pair_right[p] = hn::LoadU(D8(), right + at);
      inside_pairs[p] = hn::LoadU(D8(), inside + at);
      row[p] = hn::LoadU(D8(), full + at);
      row_ends[p] = hn::LoadU(D8(), ends + at);
    }
  }
};

/// A patch and how to read it.
template <int kChunks>
struct Patch {
  ChunkWeights chunks[kChunks];
  V8 right_weights[kChunks][kParts], row_weights[kChunks][kParts];  ///< with those of the fraction
  const std::uint8_t *left, *right;                                 ///< first rows
  std::ptrdiff_t left_stride, right_stride;

  HWY_INLINE explicit Patch(int columns) {
    if constexpr (kChunks == 1) {
      chunks[0].set(columns, true, true);
    } else {
      chunks[0].set(kFirstChunk, true, false);
      chunks[1].set(columns - kFirstChunk, false, true);
    }
  }
  HWY_INLINE void set_fraction(int fraction16) {
    const auto pair = static_cast<std::int16_t>(fraction16 << 8 | (kScale - fraction16));
    const V8 pairs = hn::BitCast(D8(), hn::Set(D16(), pair));
    for (int c = 0; c < kChunks; ++c)
      for (int p = 0; p < kParts; ++p) {
        right_weights[c][p] = hn::And(pairs, chunks[c].inside_pairs[p]);
        row_weights[c][p] = hn::Or(chunks[c].row[p], hn::And(pairs, chunks[c].row_ends[p]));
      }
  }

  /// Calls `take`(c, l, r) with vectors of grey levels of a left and 16 times those of the right row, 0 outside the
  /// patch.
  template <class Take>
  HWY_INLINE void read_row(const std::uint8_t* left_row, const std::uint8_t* right_row, Take&& take) const {
    for (int c = 0; c < kChunks; ++c) {
      const V8 l = load_twice(left_row + c * kFirstChunk), r = load_twice(right_row + c * kFirstChunk);
      for (int p = 0; p < kParts; ++p)
        take(c, hn::BitCast(D16(), hn::TableLookupBytesOr0(l, chunks[c].widen_left[p])),
             weigh_pairs(hn::TableLookupBytes(r, chunks[c].pair_right[p]), right_weights[c][p]));
    }
  }

  /// Writes sums of a row's columns in chunk `c`: 8 lanes that add up to l, then 8 that add up to r.
  HWY_INLINE void sum_columns(const std::uint8_t* left_row, const std::uint8_t* right_row, int c,
                              std::int16_t* sums) const {
    const std::uint8_t *l = left_row + c * kFirstChunk, *r = right_row + c * kFirstChunk;
    const D16 d;
#if HWY_MAX_BYTES >= 32
    const hn::Half<D8> block;
    hn::Store(weigh_pairs(hn::Combine(D8(), hn::LoadU(block, r), hn::LoadU(block, l)), row_weights[c][0]), d, sums);
#else
    hn::Store(weigh_pairs(hn::LoadU(D8(), l), row_weights[c][0]), d, sums);
    hn::Store(weigh_pairs(hn::LoadU(D8(), r), row_weights[c][1]), d, sums + 8);
#endif
  }
};

constexpr int kRowsAtOnce = 8;
constexpr int kRowCapacity = 48;  ///< rows with those that make them full vectors
static_assert(kRowCapacity >= kMaxRows && kRowCapacity % kRowsAtOnce == 0);

/// The middle of the range of the sums of a row. Without it 16 bits with a sign hold those of r, and 32 bits the
/// products of both over 15 columns and 33 rows.
constexpr std::uint16_t left_bias(int columns) { return static_cast<std::uint16_t>(columns * 128); }
constexpr std::uint16_t right_bias(int columns) { return static_cast<std::uint16_t>(columns * 128 * kScale); }

/// The rows of a patch; those behind the last one are 0 unless a kernel sets them.
template <int kChunks>
struct RowBuffer {
  alignas(32) std::int16_t lanes[kChunks][kRowCapacity][16] = {};  ///< what `sum_columns` wrote
  alignas(32) std::uint16_t l[kChunks][kRowCapacity] = {};         ///< sums of l
  alignas(32) std::uint16_t r[kChunks][kRowCapacity] = {};         ///< and of r

  /// Adds up the lanes of each row.
  HWY_INLINE void add_lanes(int rows) {
    const D16 d;
    const hn::Half<D16> half;
    for (int c = 0; c < kChunks; ++c)
      for (int j = 0; j < rows; j += kRowsAtOnce) {
        V16 sums[kParts];
        for (int p = 0; p < kParts; ++p) {
          const auto row = [&](int k) HWY_ATTR { return hn::Load(d, lanes[c][j + k] + 8 * p); };
          const V16 r01 = fold<std::int16_t>(row(0), row(1)), r23 = fold<std::int16_t>(row(2), row(3));
          const V16 r45 = fold<std::int16_t>(row(4), row(5)), r67 = fold<std::int16_t>(row(6), row(7));
          sums[p] = fold<std::int64_t>(fold<std::int32_t>(r01, r23), fold<std::int32_t>(r45, r67));
        }
        auto* const l_out = reinterpret_cast<std::int16_t*>(l[c] + j);
        auto* const r_out = reinterpret_cast<std::int16_t*>(r[c] + j);
#if HWY_MAX_BYTES >= 32
        hn::Store(hn::LowerHalf(half, sums[0]), half, l_out);
        hn::Store(hn::UpperHalf(half, sums[0]), half, r_out);
#else
        (void)half;
        hn::Store(sums[0], d, l_out);
        hn::Store(sums[1], d, r_out);
#endif
      }
  }
};

#endif  // HWY_TARGET != HWY_SCALAR
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
