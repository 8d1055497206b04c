#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "flies/classify/people_model.hpp"

namespace flies::kernels {

/// Rows of a matrix that are multiplied side by side, one to a lane.
constexpr std::size_t kPanelRows = 32;
/// Points that are multiplied with a panel at once, at most.
constexpr std::size_t kPanelPoints = 4;

/// A matrix in panels of `kPanelRows` rows, column by column, the last panel filled up with zeros. Every sum then runs
/// over the columns one after the other, on whatever instruction set.
class Panels {
 public:
  Panels() = default;
  explicit Panels(const Matrix& matrix);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::size_t count() const { return (rows_ + kPanelRows - 1) / kPanelRows; }
  const float* panel(std::size_t p) const { return values_.data() + p * kPanelRows * columns_; }

 private:
  std::size_t rows_ = 0, columns_ = 0;
  std::vector<float> values_;
};

using PanelProducts = std::array<std::array<float, kPanelRows>, kPanelPoints>;

/// Scalar products of the rows of a panel with the first `count` points, 1 to `kPanelPoints`, of `columns` numbers
/// each.
PanelProducts multiply_panel(const float* panel, std::size_t columns,
                             const std::array<const float*, kPanelPoints>& points, std::size_t count);

/// 2^-x to 3e-7 of its value, for x from 0; below 2^-126 it is that.
void exp2_of_negative(std::array<float, kPanelRows>& x);

}  // namespace flies::kernels
