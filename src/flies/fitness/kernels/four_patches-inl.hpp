// Eq. (2) and moments of four patches side by side, where the CPU multiplies bytes and shifts across lanes: no include
// guard. Needs agreement-inl.hpp and byte_products-inl.hpp.
//
// Each block of 16 bytes of a vector belongs to a patch. Four rows of the four patches are transposed, so that each
// 32-bit lane belongs to a row and one vector holds columns 0 to 3, the next one columns 4 to 7, and so on: then every
// sum over a row is four products of bytes, and nothing is left to add up across lanes but the rows.

#if HWY_TARGET == HWY_AVX3
HWY_PUSH_ATTRIBUTES(FLIES_BYTE_PRODUCTS)
namespace flies::kernels::HWY_NAMESPACE {

constexpr std::size_t kPatchesAtOnce = 4;

/// Reads one of the images of four patches from the first row on.
class QuadReader {
 public:
  HWY_INLINE QuadReader(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, const std::uint8_t* d,
                        std::ptrdiff_t stride)
      : a_(a), b_(b), c_(c), d_(d), stride_(stride) {}

  /// The next four rows; those from `rows` on are 0.
  HWY_INLINE Quad next(int rows) {
    W32 blocks[kQuadRows];
    for (int j = 0; j < kQuadRows; ++j) {
      blocks[j] = hn::Zero(DW32());
      if (j >= rows) continue;
      blocks[j] = load();
      offset_ += stride_;
    }
    return Quad(blocks);
  }

 private:
  HWY_INLINE W32 load() const { return load_blocks(a_ + offset_, b_ + offset_, c_ + offset_, d_ + offset_); }

  const std::uint8_t *a_, *b_, *c_, *d_;
  std::ptrdiff_t stride_, offset_ = 0;
};

/// A value of each patch in all lanes of its block.
template <class Value>
HWY_INLINE W32 of_patches(const PatchPlace* places, const Value& value) {
  alignas(64) static constexpr std::int32_t kPatchOfLane[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  const __m128i values = _mm_setr_epi32(value(places[0]), value(places[1]), value(places[2]), value(places[3]));
  return W32{_mm512_permutexvar_epi32(hn::Load(DW32(), kPatchOfLane).raw, _mm512_castsi128_si512(values))};
}

/// Which columns of a row count how much.
struct ColumnWeights {
  W32 inside[kGroups];  ///< all ones in the columns of the patch
  W32 right[kGroups];   ///< 16 in the columns of the right patch that count in full
  W32 ends[kGroups];    ///< all ones in its first column and in the one behind it, which share one between them

  HWY_INLINE explicit ColumnWeights(int columns) {
    for (int g = 0; g < kGroups; ++g) {
      inside[g] = in_all_lanes(g, columns, 0, 0xFF);
      right[g] = hn::And(in_all_lanes(g, columns, 1, kScale), inside[g]);
      ends[g] = hn::Xor(in_all_lanes(g, columns + 1, 0, 0xFF), in_all_lanes(g, columns, 1, 0xFF));
    }
  }

 private:
  /// `byte` in the columns of group `g` from `first` to before `end`.
  static HWY_INLINE W32 in_all_lanes(int g, int end, int first, std::uint32_t byte) {
    std::uint32_t bytes = 0;
    for (int i = 0; i < 4; ++i)
      if (4 * g + i >= first && 4 * g + i < end) bytes |= byte << (8 * i);
    return hn::Set(DW32(), static_cast<std::int32_t>(bytes));
  }
};

/// Four patches of up to 15 columns: one more is read, too.
class FourPatches {
 public:
  HWY_INLINE FourPatches(const PatchImages& images, const ColumnWeights& weights, const PatchPlace* places)
      : left_(places[0].left, places[1].left, places[2].left, places[3].left, images.left_stride),
        right_(places[0].right, places[1].right, places[2].right, places[3].right, images.right_stride) {
    const W32 ends = of_patches(places, [](const PatchPlace& place) {
      return (place.fraction16 << 8 | (kScale - place.fraction16)) * 0x10001;
    });
    for (int g = 0; g < kGroups; ++g) {
      right_weights_[g] = hn::Or(weights.right[g], hn::And(ends, weights.ends[g]));
      inside_[g] = weights.inside[g];
    }
  }

  /// Reads the next four rows, of which the patches have `rows`.
  HWY_INLINE void read(int rows) {
    left = left_.next(rows);
    right = right_.next(rows);
    right_next = right.next_columns();
    left_signed = less_128(left);
  }
  /// Grey levels less 128, which changes no covariance and gives the second factor of a product its sign; 0 behind the
  /// last column.
  HWY_INLINE Quad less_128(const Quad& quad) const {
    const W32 middle = hn::Set(DW32(), static_cast<std::int32_t>(0x80808080));
    Quad less;
    for (int g = 0; g < kGroups; ++g) less.group[g] = hn::And(hn::Xor(quad.group[g], middle), inside_[g]);
    return less;
  }
  static HWY_INLINE W32 sum_products(const Quad& without_sign, const Quad& with_sign) {
    W32 sums = hn::Zero(DW32());
    for (int g = 0; g < kGroups; ++g) sums = add_byte_products(sums, without_sign.group[g], with_sign.group[g]);
    return sums;
  }
  /// Sums of the rows: of the left ones, less 128, and of the interpolated right ones.
  HWY_INLINE W32 sum_left() const {
    W32 sums = hn::Zero(DW32());
    for (const W32& group : left_signed.group) sums = add_byte_products(sums, hn::Set(DW32(), 0x01010101), group);
    return sums;
  }
  HWY_INLINE W32 sum_right() const {
    W32 sums = hn::Zero(DW32());
    for (int g = 0; g < kGroups; ++g) sums = add_byte_products(sums, right.group[g], right_weights_[g]);
    return sums;
  }

  HWY_INLINE W32 first_column() const { return hn::And(right.group[0], hn::Set(DW32(), 0xFF)); }
  HWY_INLINE W32 column_behind(int columns) const {
    const __m128i shift = _mm_cvtsi32_si128(columns % 4 * 8);
    return hn::And(W32{_mm512_srl_epi32(right.group[columns / 4].raw, shift)}, hn::Set(DW32(), 0xFF));
  }

  Quad left, left_signed, right, right_next;

 private:
  QuadReader left_, right_;
  W32 right_weights_[kGroups];  ///< of columns; they sum up to 16 times their number
  W32 inside_[kGroups];         ///< all ones in the columns of the patch
};

template <class Four>
using SumPatches = void(const PatchImages& images, std::span<const PatchPlace> places, typename Four::Result* results);

/// Eq. (2) of four patches.
struct FourWeightedCovariances {
  using Result = float;

  template <int kRows>
  static HWY_INLINE void evaluate(const PatchImages& images, int rows, int columns, const ColumnWeights& weights,
                                  const PatchPlace* places, float* results) {
    const DW32 d;
    const DWF df;
    FourPatches patches(images, weights, places);
    const W32 n_scale = hn::Set(d, columns * kScale), middle = hn::Set(d, columns * kScale * 128);
    const W32 n_fraction = of_patches(places, [&](const PatchPlace& place) { return columns * place.fraction16; });
    constexpr int kQuads = (kRows + kQuadRows - 1) / kQuadRows;
    const int quads = (rows + kQuadRows - 1) / kQuadRows;
    W32 C[kQuads], difference[kQuads];
    // One loop for the pixels and one for the exponentials: their chains of operations are long, the CPU works on
    // several of them at a time only where they lie close together.
#pragma GCC unroll 5
    for (int q = 0; q < quads; ++q) {
      patches.read(rows - kQuadRows * q);
      const W32 l = patches.sum_left(), r = patches.sum_right();
      const W32 whole = FourPatches::sum_products(patches.right, patches.left_signed);
      const W32 next = FourPatches::sum_products(patches.right_next, patches.left_signed);
      const W32 n_lr = hn::Add(hn::Mul(whole, n_scale), hn::Mul(hn::Sub(next, whole), n_fraction));
      C[q] = hn::Sub(n_lr, hn::Mul(l, r));
      difference[q] = hn::Abs(hn::Sub(hn::Add(hn::ShiftLeft<4>(l), middle), r));
    }
    const Agreement<DWF> agreement(columns);
    WF part[2] = {hn::Zero(df), hn::Zero(df)};  // of the rows with equal number modulo 8, as all kernels add them up
#pragma GCC unroll 5
    for (int q = 0; q < quads; ++q)
      part[q % 2] = hn::Add(part[q % 2], hn::Mul(hn::ConvertTo(df, C[q]), agreement(difference[q])));
    const WF all = hn::Add(part[0], part[1]);
    const WF pairs = hn::Add(all, hn::Shuffle1032(all));
    const WF sums = hn::Add(pairs, hn::Shuffle2301(pairs));
    alignas(64) static constexpr std::int32_t kFirstLanes[16] = {0, 4, 8, 12};
    const __m512 packed = _mm512_permutexvar_ps(hn::Load(d, kFirstLanes).raw, sums.raw);
    const __m128 scale = _mm_set1_ps(static_cast<float>(kScale * columns));
    _mm_storeu_ps(results, _mm_div_ps(_mm512_castps512_ps128(packed), scale));
  }
};

/// Sums for `correlation` of four patches.
struct FourMoments {
  using Result = PatchMoments;

  template <int>
  static HWY_INLINE void evaluate(const PatchImages& images, int rows, int columns, const ColumnWeights& weights,
                                  const PatchPlace* places, PatchMoments* results) {
    const DW32 d;
    const DW64 d64;
    FourPatches patches(images, weights, places);
    const auto of_fraction = [&](auto&& value) FLIES_BYTE_PRODUCTS_ATTR {
      return of_patches(places, [&](const PatchPlace& place) { return value(columns, place.fraction16); });
    };
    const W32 fraction = of_fraction([](int n, int f) { return n * f; });
    const W32 whole_squares = of_fraction([](int n, int f) { return n * ((kScale - f) * (kScale - f) + f * f); });
    const W32 neighbours = of_fraction([](int n, int f) { return n * 2 * f * (kScale - f); });
    const W32 ends_1 = of_fraction([](int n, int f) { return n * 128 * f * (kScale - 2 * f); });
    const W32 ends_2 = of_fraction([](int n, int f) { return n * f * f; });
    const W32 n = hn::Set(d, columns), n_scale = hn::Set(d, columns * kScale), n_middle = hn::Set(d, columns * 128);
    const W32 n_scaled_middle = hn::Set(d, columns * kScale * 128);
    W32 lr = hn::Zero(d), ll = hn::Zero(d);
    W64 rr = hn::Zero(d64);
#pragma GCC unroll 5
    for (int q = 0; q < (rows + kQuadRows - 1) / kQuadRows; ++q) {
      patches.read(rows - kQuadRows * q);
      const W32 l = patches.sum_left(), r = patches.sum_right();
      const W32 whole = FourPatches::sum_products(patches.right, patches.left_signed);
      const W32 next = FourPatches::sum_products(patches.right_next, patches.left_signed);
      const W32 n_lr = hn::Add(hn::Mul(whole, n_scale), hn::Mul(hn::Sub(next, whole), fraction));
      lr = hn::Add(lr, hn::Sub(n_lr, hn::Mul(l, r)));

      const W32 l_squares = FourPatches::sum_products(patches.left, patches.left_signed);
      ll = hn::Add(ll, hn::Sub(hn::Mul(l_squares, n), hn::Mul(l, hn::Add(l, n_middle))));

      // With R a grey level less 128 and R' that of the column to the right, the squares of the interpolated grey
      // levels are (16 - f)^2 R R + 2 f (16 - f) R R' + f^2 R' R', where the sums of R' R' and R R differ by the ends.
      const Quad right_signed = patches.less_128(patches.right);
      const W32 r_squares = FourPatches::sum_products(patches.right, right_signed);
      const W32 r_neighbours = FourPatches::sum_products(patches.right_next, right_signed);
      const W32 first = patches.first_column(), behind = patches.column_behind(columns);
      const W32 rise = hn::Sub(behind, first), both = hn::Add(behind, first);
      const W32 ends = hn::Mul(rise, hn::Add(ends_1, hn::Mul(both, ends_2)));
      const W32 n_rr = hn::Add(hn::Add(hn::Mul(r_squares, whole_squares), hn::Mul(r_neighbours, neighbours)), ends);
      const W32 row_rr = hn::Sub(n_rr, hn::Mul(r, hn::Sub(r, n_scaled_middle)));
      rr = hn::Add(rr, widen_pairs(row_rr));
    }
    alignas(64) std::int32_t lr_sums[16], ll_sums[16];
    alignas(64) std::int64_t rr_sums[8];
    hn::Store(sum_blocks(lr), d, lr_sums);
    hn::Store(sum_blocks(ll), d, ll_sums);
    hn::Store(hn::Add(rr, hn::Shuffle01(rr)), d64, rr_sums);
    for (std::size_t b = 0; b < kPatchesAtOnce; ++b) results[b] = {lr_sums[4 * b], ll_sums[4 * b], rr_sums[2 * b]};
  }

 private:
  /// Adds neighbouring lanes, which are not negative.
  static HWY_INLINE W64 widen_pairs(W32 v) {
    const W64 pairs = hn::BitCast(DW64(), v);
    return hn::Add(hn::And(pairs, hn::Set(DW64(), 0xFFFFFFFF)), W64{_mm512_srli_epi64(pairs.raw, 32)});
  }
  static HWY_INLINE W32 sum_blocks(W32 v) {
    const W32 pairs = hn::Add(v, hn::Shuffle1032(v));
    return hn::Add(pairs, hn::Shuffle2301(pairs));
  }
};

template <class Four, int kRows>
HWY_INLINE void evaluate_each_four(const PatchImages& images, int rows, int columns, std::span<const PatchPlace> places,
                                   SumPatches<Four>* fallback, typename Four::Result* results) {
  const ColumnWeights weights(columns);
  const auto room = [&](const std::uint8_t* first, std::ptrdiff_t stride, const std::uint8_t* end)
                        HWY_ATTR { return end - first - ((rows - 1) * stride + 16); };
  std::size_t i = 0;
  for (; i + kPatchesAtOnce <= places.size(); i += kPatchesAtOnce) {
    const auto four = places.subspan(i, kPatchesAtOnce);
    std::ptrdiff_t least_room = 0;  // negative as soon as one of them is
    for (const PatchPlace& place : four)
      least_room |= room(place.left, images.left_stride, images.left_end) |
                    room(place.right, images.right_stride, images.right_end);
    if (least_room >= 0)
      Four::template evaluate<kRows>(images, rows, columns, weights, four.data(), results + i);
    else
      fallback(images, four, results + i);
  }
  if (i < places.size()) fallback(images, places.subspan(i), results + i);
}

/// Evaluates four patches at a time; by `fallback` those of more columns than a block, those that end so close to the
/// end of an image that a block would reach beyond, and the last few.
template <class Four, SumPatches<Four> fallback>
void evaluate_fours(const PatchImages& images, std::span<const PatchPlace> places, typename Four::Result* results) {
  const int columns = images.columns, rows = images.rows;
  if (columns == kUsualColumns && rows == kUsualRows)
    evaluate_each_four<Four, kUsualRows>(images, kUsualRows, kUsualColumns, places, fallback, results);
  else if (columns == kUsualColumns && rows == kUsualFewRows)
    evaluate_each_four<Four, kUsualFewRows>(images, kUsualFewRows, kUsualColumns, places, fallback, results);
  else if (columns < kGroups * 4)
    evaluate_each_four<Four, kMaxRows>(images, rows, columns, places, fallback, results);
  else
    fallback(images, places, results);
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_POP_ATTRIBUTES
#endif  // HWY_TARGET == HWY_AVX3
