#pragma once

#include <array>

namespace flies {

/// Rows of columns.
using Matrix3 = std::array<std::array<double, 3>, 3>;

inline double determinant(const Matrix3& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace flies
