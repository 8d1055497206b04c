#include "flies/classify/kernel_machine.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <numbers>
#include <utility>

#include "flies/classify/dot.hpp"

namespace flies {
namespace {

using kernels::kPanelPoints;
using kernels::kPanelRows;

/// Calls `use(panel, point, products)` for every panel with every point; panels side by side.
template <class Use>
void multiply(const kernels::Panels& panels, const std::vector<float>& points, const Use& use) {
  const std::size_t columns = panels.columns(), count = points.size() / columns;
  tbb::parallel_for(std::size_t{0}, panels.count(), [&](std::size_t panel) {
    for (std::size_t first = 0; first < count; first += kPanelPoints) {
      const std::size_t at_once = std::min(kPanelPoints, count - first);
      std::array<const float*, kPanelPoints> some{};
      for (std::size_t p = 0; p < at_once; ++p) some[p] = points.data() + (first + p) * columns;
      auto products = kernels::multiply_panel(panels.panel(panel), columns, some, at_once);
      for (std::size_t p = 0; p < at_once; ++p) use(panel, first + p, products[p]);
    }
  });
}

}  // namespace

KernelMachine::KernelMachine(const KernelStage& stage)
    : mean_(stage.mean),
      coefficients_(stage.coefficients),
      projection_(stage.projection),
      support_vectors_(stage.support_vectors),
      gamma_(stage.gamma),
      bias_(stage.bias) {
  for (std::size_t i = 0; i < stage.support_vectors.rows; ++i) {
    const auto row = stage.support_vectors.row(i);
    squares_.push_back(dot(row.data(), row.data(), row.size()));
  }
  // What the last panel is filled up with counts nothing.
  squares_.resize(support_vectors_.count() * kPanelRows, 0.0F);
  coefficients_.resize(squares_.size(), 0.0F);
}

std::vector<double> KernelMachine::scores(std::span<const float> features) const {
  assert(features.size() % mean_.size() == 0);
  const std::size_t windows = features.size() / mean_.size();
  std::vector<float> points(features.begin(), features.end());
  for (std::size_t w = 0; w < windows; ++w)
    for (std::size_t i = 0; i < mean_.size(); ++i) points[w * mean_.size() + i] -= mean_[i];
  if (const std::size_t dimensions = projection_.rows(); dimensions > 0) {
    std::vector<float> projected(windows * dimensions);
    multiply(projection_, points, [&](std::size_t panel, std::size_t window, const auto& products) {
      const std::size_t first = panel * kPanelRows;
      std::copy_n(products.begin(), std::min(kPanelRows, dimensions - first),
                  projected.begin() + static_cast<std::ptrdiff_t>(window * dimensions + first));
    });
    points = std::move(projected);
  }
  if (support_vectors_.rows() == 0) return std::vector<double>(windows, bias_);

  const std::size_t dimensions = support_vectors_.columns(), panels = support_vectors_.count();
  std::vector<float> squares;
  for (std::size_t w = 0; w < windows; ++w)
    squares.push_back(dot(points.data() + w * dimensions, points.data() + w * dimensions, dimensions));
  const auto exponent = static_cast<float>(gamma_ * std::numbers::log2e);
  std::vector<double> sums(windows * panels, 0.0);
  multiply(support_vectors_, points, [&](std::size_t panel, std::size_t window, auto& products) {
    const float* const rows = squares_.data() + panel * kPanelRows;
    const float* const coefficients = coefficients_.data() + panel * kPanelRows;
    for (std::size_t r = 0; r < kPanelRows; ++r)  // |p - s|^2, which rounding could make negative
      products[r] = exponent * std::max(0.0F, squares[window] + rows[r] - 2.0F * products[r]);
    kernels::exp2_of_negative(products);
    std::array<double, 4> parts{};  // side by side, for an addition waits for the one before
    for (std::size_t r = 0; r < kPanelRows; r += parts.size())
      for (std::size_t part = 0; part < parts.size(); ++part)
        parts[part] += coefficients[r + part] * products[r + part];
    sums[window * panels + panel] = (parts[0] + parts[2]) + (parts[1] + parts[3]);
  });
  std::vector<double> scores(windows, bias_);
  for (std::size_t w = 0; w < windows; ++w)
    for (std::size_t panel = 0; panel < panels; ++panel) scores[w] += sums[w * panels + panel];
  return scores;
}

}  // namespace flies
