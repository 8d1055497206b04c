#include "flies/fitness/reference.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flies {
namespace {

/// Grey levels around the two projections, addressed by the i and j of the equations.
class Neighbourhoods {
 public:
  Neighbourhoods(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point)
      : pair_(pair), u_left_(std::lrint(point.u_px)), v_(std::lrint(point.v_px)) {
    u_right_ = options.sampling == PatchSampling::nearest
                   ? static_cast<double>(std::lrint(point.u_px - point.disparity_px))
                   : static_cast<double>(u_left_) - point.disparity_px;
  }

  bool inside(int uSz, int vSz) const {
    const int width = pair_.left.width_px, height = pair_.left.height_px;
    // The right patch is interpolated between whole columns, so the column after its last one is read as well.
    return u_left_ - uSz >= 0 && u_left_ + uSz < width && v_ - vSz >= 0 && v_ + vSz < height && u_right_ - uSz >= 0.0 &&
           std::floor(u_right_) + uSz + 1 < width;
  }

  double left(int i, int j) const { return pair_.left.at(static_cast<int>(u_left_) + i, static_cast<int>(v_) + j); }
  double right(int i, int j) const {
    const double whole = std::floor(u_right_);
    const double fraction = u_right_ - whole;
    const int u = static_cast<int>(whole) + i, v = static_cast<int>(v_) + j;
    return (1.0 - fraction) * pair_.right.at(u, v) + fraction * pair_.right.at(u + 1, v);
  }

 private:
  const RectifiedPair& pair_;
  long u_left_, v_;
  double u_right_;
};

/// The j of the equations, or every so many of them.
std::vector<int> compared_rows(const FitnessOptions& options) {
  std::vector<int> rows;
  for (int j = -options.half_height_px; j <= options.half_height_px; ++j)
    if (j % options.row_step == 0) rows.push_back(j);
  return rows;
}

/// Eq. (1).
double louchet(const Neighbourhoods& n, const FitnessOptions& options) {
  const int uSz = options.half_width_px;
  const double gradient_u = (n.left(1, 0) - n.left(-1, 0)) / 2.0;
  const double gradient_v = (n.left(0, 1) - n.left(0, -1)) / 2.0;
  const double G = std::sqrt(std::hypot(gradient_u, gradient_v));
  double squared_differences = 0.0;
  for (const int j : compared_rows(options))
    for (int i = -uSz; i <= uSz; ++i) squared_differences += std::pow(n.left(i, j) - n.right(i, j), 2);
  return G / (options.louchet_constant + squared_differences);
}

struct RowMoments {
  double left_mean = 0.0, right_mean = 0.0;
  double covariance = 0.0, left_variance = 0.0, right_variance = 0.0;  ///< sums over the row, not divided
};

RowMoments row_moments(const Neighbourhoods& n, int uSz, int j) {
  RowMoments m;
  for (int i = -uSz; i <= uSz; ++i) {
    m.left_mean += n.left(i, j);
    m.right_mean += n.right(i, j);
  }
  m.left_mean /= 2 * uSz + 1;
  m.right_mean /= 2 * uSz + 1;
  for (int i = -uSz; i <= uSz; ++i) {
    const double l = n.left(i, j) - m.left_mean, r = n.right(i, j) - m.right_mean;
    m.covariance += l * r;
    m.left_variance += l * l;
    m.right_variance += r * r;
  }
  return m;
}

/// Eq. (2). Its sum is negative where the neighbourhoods are opposite; a fitness is a weight, so it ends at 0.
double covariance(const Neighbourhoods& n, const FitnessOptions& options) {
  double sum = 0.0;
  for (const int j : compared_rows(options)) {
    const auto row = row_moments(n, options.half_width_px, j);
    const double C = row.covariance;
    const double D = std::exp(-std::abs(row.left_mean - row.right_mean));
    sum += C * D;
  }
  return std::max(0.0, sum);
}

/// z^p (mean covariance)^q, z the correlation coefficient of the row-centred neighbourhoods with a noise floor.
double correlation(const Neighbourhoods& n, const FitnessOptions& options) {
  double C = 0.0, left_variance = 0.0, right_variance = 0.0;
  for (const int j : compared_rows(options)) {
    const auto row = row_moments(n, options.half_width_px, j);
    C += row.covariance;
    left_variance += row.left_variance;
    right_variance += row.right_variance;
  }
  if (C <= 0.0) return 0.0;
  const double pixels = (2.0 * options.half_width_px + 1.0) * static_cast<double>(compared_rows(options).size());
  const double noise = pixels * options.noise_gray * options.noise_gray;
  const double z = C / std::sqrt((left_variance + noise) * (right_variance + noise));
  return std::pow(z, options.correlation_power) * std::pow(C / pixels, options.contrast_power);
}

}  // namespace

double reference_fitness(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  if (!std::isfinite(point.u_px) || !std::isfinite(point.v_px) || !std::isfinite(point.disparity_px)) return 0.0;
  const Neighbourhoods neighbourhoods(pair, options, point);
  if (!neighbourhoods.inside(options.half_width_px, options.half_height_px)) return 0.0;
  switch (options.function) {
    case FitnessFunction::louchet:
      return louchet(neighbourhoods, options);
    case FitnessFunction::covariance:
      return covariance(neighbourhoods, options);
    case FitnessFunction::correlation:
      return correlation(neighbourhoods, options);
  }
  return 0.0;
}

}  // namespace flies
