// D of Eq. (2) in vectors, see mean_agreement.hpp; once for each instruction set: no include guard.

HWY_BEFORE_NAMESPACE();
namespace flies::kernels::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// @tparam D  a tag of single precision
template <class D>
struct Agreement {
  using D32 = hn::RebindToSigned<D>;
  using V = hn::Vec<D>;
  using V32 = hn::Vec<D32>;
  V step;

  HWY_INLINE explicit Agreement(int columns) : step(hn::Set(D(), MeanAgreement(columns).step)) {}
  HWY_INLINE V operator()(V32 difference) const {
    const D df;
    const D32 d;
    const V rounder = hn::Set(df, MeanAgreement::kRounder);
    const V y = hn::Min(hn::Mul(hn::ConvertTo(df, difference), step), hn::Set(df, MeanAgreement::kMaxExponent));
    const V t = hn::Add(y, rounder);
    const V f = hn::Sub(hn::Sub(t, rounder), y);
    V power = hn::Set(df, MeanAgreement::kPolynomial[0]);
    for (std::size_t i = 1; i < std::size(MeanAgreement::kPolynomial); ++i)
      power = hn::Add(hn::Mul(power, f), hn::Set(df, MeanAgreement::kPolynomial[i]));
    return hn::BitCast(df, hn::Sub(hn::BitCast(d, power), hn::ShiftLeft<23>(hn::BitCast(d, t))));
  }
};

#endif  // HWY_TARGET != HWY_SCALAR
}  // namespace flies::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
