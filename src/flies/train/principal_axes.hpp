#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/classify/people_model.hpp"

namespace flies {

/// The directions in which rows differ most.
struct PrincipalAxes {
  std::vector<float> mean;  ///< of the rows
  Matrix axes;              ///< a row an axis, of length 1, orthogonal, the most important first
};

/// Finds the most important principal axes by subspace iteration (Golub and Van Loan, Matrix Computations, 8.2.4) on
/// the covariance: of 2000 possible axes only some 200 are wanted, and a full decomposition takes minutes.
/// @param rows  at least one
/// @param count wanted; fewer are returned when the rows have fewer columns
/// @param seed  of the first guess
PrincipalAxes principal_axes(const Matrix& rows, std::size_t count, std::uint64_t seed);

/// Coordinates of rows along the axes: axes * (row - mean).
Matrix project(const Matrix& rows, std::span<const float> mean, const Matrix& axes);

}  // namespace flies
