// This file is compiled once for each instruction set; see "run-time dispatch" in Highway's documentation.
#include "flies/classify/kernels/panels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "flies/classify/kernels/panels.cpp"
// Vectors without a compile-time size, which NEON serves as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kPanelRows>;
constexpr std::size_t kLanes = hn::MaxLanes(D());

/// As many rows as leave all sums in registers, and enough of them to hide how long an addition takes.
constexpr std::size_t kVectors = 2;

template <std::size_t kPoints>
HWY_ATTR void multiply_rows(const float* panel, std::size_t columns,
                            const std::array<const float*, kPanelPoints>& points, std::size_t first,
                            PanelProducts& products) {
  const D d;
  hn::Vec<D> sums[kPoints][kVectors];
  for (auto& of_point : sums)
    for (auto& sum : of_point) sum = hn::Zero(d);
  for (std::size_t i = 0; i < columns; ++i, panel += kPanelRows) {
    hn::Vec<D> rows[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) rows[v] = hn::LoadU(d, panel + first + v * kLanes);
    for (std::size_t p = 0; p < kPoints; ++p) {
      const auto value = hn::Set(d, points[p][i]);
      for (std::size_t v = 0; v < kVectors; ++v) sums[p][v] = hn::Add(sums[p][v], hn::Mul(rows[v], value));
    }
  }
  for (std::size_t p = 0; p < kPoints; ++p)
    for (std::size_t v = 0; v < kVectors; ++v) hn::StoreU(sums[p][v], d, products[p].data() + first + v * kLanes);
}

template <std::size_t kPoints>
HWY_ATTR void multiply_panel(const float* panel, std::size_t columns,
                             const std::array<const float*, kPanelPoints>& points, PanelProducts& products) {
  for (std::size_t first = 0; first < kPanelRows; first += kVectors * kLanes)
    multiply_rows<kPoints>(panel, columns, points, first, products);
}

HWY_ATTR void MultiplyPanel(const float* panel, std::size_t columns,
                            const std::array<const float*, kPanelPoints>& points, std::size_t count,
                            PanelProducts& products) {
  switch (count) {
    case 1:
      return multiply_panel<1>(panel, columns, points, products);
    case 2:
      return multiply_panel<2>(panel, columns, points, products);
    case 3:
      return multiply_panel<3>(panel, columns, points, products);
    default:
      return multiply_panel<kPanelPoints>(panel, columns, points, products);
  }
}

HWY_ATTR void Exp2OfNegative(float* x) {
  const D d;
  const hn::RebindToSigned<D> whole;
  // 2^f for -0.5 <= f <= 0.5: its Taylor coefficients ln(2)^i / i! from the last to the first.
  constexpr float kPolynomial[] = {1.540353e-4F, 1.3333558e-3F, 9.6181291e-3F, 5.5504109e-2F,
                                   0.240226507F, 0.693147181F,  1.0F};
  constexpr float kLeast = -126.0F;  // the smallest power of 2 that is a normal number
  constexpr int kExponentBias = 127, kMantissaBits = 23;
  for (std::size_t i = 0; i < kPanelRows; i += kLanes) {
    const auto y = hn::Max(hn::Neg(hn::LoadU(d, x + i)), hn::Set(d, kLeast));
    const auto nearest = hn::Round(y);
    const auto fraction = hn::Sub(y, nearest);
    auto power = hn::Set(d, kPolynomial[0]);
    for (std::size_t k = 1; k < std::size(kPolynomial); ++k)
      power = hn::Add(hn::Mul(power, fraction), hn::Set(d, kPolynomial[k]));
    const auto exponent = hn::Add(hn::ConvertTo(whole, nearest), hn::Set(whole, kExponentBias));
    hn::StoreU(hn::Mul(power, hn::BitCast(d, hn::ShiftLeft<kMantissaBits>(exponent))), d, x + i);
  }
}

}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace flies::kernels {

HWY_EXPORT(MultiplyPanel);
HWY_EXPORT(Exp2OfNegative);

Panels::Panels(const Matrix& matrix) : rows_(matrix.rows), columns_(matrix.columns) {
  values_.assign(count() * kPanelRows * columns_, 0.0F);
  for (std::size_t r = 0; r < rows_; ++r) {
    float* out = values_.data() + r / kPanelRows * kPanelRows * columns_ + r % kPanelRows;
    for (const float value : matrix.row(r)) {
      *out = value;
      out += kPanelRows;
    }
  }
}

PanelProducts multiply_panel(const float* panel, std::size_t columns,
                             const std::array<const float*, kPanelPoints>& points, std::size_t count) {
  PanelProducts products;
  HWY_DYNAMIC_DISPATCH(MultiplyPanel)(panel, columns, points, count, products);
  return products;
}

void exp2_of_negative(std::array<float, kPanelRows>& x) { HWY_DYNAMIC_DISPATCH(Exp2OfNegative)(x.data()); }

}  // namespace flies::kernels
#endif
