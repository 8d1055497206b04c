#include "flies/train/principal_axes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>

#include "flies/core/random.hpp"

namespace flies {
namespace {

constexpr std::uint32_t kFirstGuess = 0x9CA0;
/// More axes than are wanted converge faster: the error shrinks by the ratio of the variances at both cuts.
constexpr std::size_t kSpareAxes = 16;
constexpr int kIterations = 6;

cv::Mat view(const Matrix& matrix) {
  return cv::Mat(static_cast<int>(matrix.rows), static_cast<int>(matrix.columns), CV_32F,
                 const_cast<float*>(matrix.values.data()));
}

/// Gram-Schmidt, twice for accuracy; rows that vanish stay as they are.
void orthonormalize(cv::Mat& rows) {
  for (int i = 0; i < rows.rows; ++i) {
    cv::Mat row = rows.row(i);
    for (int pass = 0; pass < 2; ++pass)
      for (int j = 0; j < i; ++j) row -= row.dot(rows.row(j)) * rows.row(j);
    const double length = cv::norm(row);
    if (length > 0.0) row /= length;
  }
}

cv::Mat centred(const Matrix& rows, std::span<const float> mean) {
  cv::Mat result = view(rows).clone();
  for (int i = 0; i < result.rows; ++i)
    for (int k = 0; k < result.cols; ++k) result.at<float>(i, k) -= mean[static_cast<std::size_t>(k)];
  return result;
}

/// rows^T * rows / count. A few rows at a time, along memory: `cv::mulTransposed` walks down the columns of a matrix
/// that is far larger than the cache, and takes minutes.
cv::Mat covariance_of(const cv::Mat& rows) {
  constexpr int kAtATime = 8;
  cv::Mat padded;  // rows of zeros add nothing
  cv::copyMakeBorder(rows, padded, 0, (kAtATime - rows.rows % kAtATime) % kAtATime, 0, 0, cv::BORDER_CONSTANT, 0.0);
  cv::Mat sum(rows.cols, rows.cols, CV_32F, cv::Scalar(0.0));
  for (int first = 0; first < padded.rows; first += kAtATime) {
    std::array<const float*, kAtATime> r{};
    for (int i = 0; i < kAtATime; ++i) r[static_cast<std::size_t>(i)] = padded.ptr<float>(first + i);
    for (int i = 0; i < rows.cols; ++i) {
      float* to = sum.ptr<float>(i);
      const float a = r[0][i], b = r[1][i], c = r[2][i], d = r[3][i], e = r[4][i], f = r[5][i], g = r[6][i],
                  h = r[7][i];
      for (int j = i; j < rows.cols; ++j)
        to[j] += a * r[0][j] + b * r[1][j] + c * r[2][j] + d * r[3][j] + e * r[4][j] + f * r[5][j] + g * r[6][j] +
                 h * r[7][j];
    }
  }
  cv::completeSymm(sum);
  sum /= rows.rows;
  cv::Mat covariance;
  sum.convertTo(covariance, CV_64F);
  return covariance;
}

}  // namespace

PrincipalAxes principal_axes(const Matrix& rows, std::size_t count, std::uint64_t seed) {
  assert(rows.rows > 0);
  PrincipalAxes result;
  std::vector<double> mean(rows.columns, 0.0);
  for (std::size_t i = 0; i < rows.rows; ++i)
    for (std::size_t k = 0; k < rows.columns; ++k) mean[k] += rows.row(i)[k];
  for (const double sum : mean) result.mean.push_back(static_cast<float>(sum / static_cast<double>(rows.rows)));

  const cv::Mat covariance = covariance_of(centred(rows, result.mean));
  const std::size_t wanted = std::min(count, rows.columns);
  const std::size_t sought = std::min(wanted + kSpareAxes, rows.columns);
  cv::Mat axes(static_cast<int>(sought), static_cast<int>(rows.columns), CV_64F);
  for (int i = 0; i < axes.rows; ++i) {
    FlyRandom random(seed, kFirstGuess, 0, static_cast<std::uint32_t>(i));
    for (int k = 0; k < axes.cols; ++k) axes.at<double>(i, k) = random.normal();
  }
  orthonormalize(axes);
  for (int i = 0; i < kIterations; ++i) {
    axes = axes * covariance;
    orthonormalize(axes);
  }
  result.axes = {wanted, rows.columns, {}};
  for (std::size_t i = 0; i < wanted; ++i)
    for (int k = 0; k < axes.cols; ++k)
      result.axes.values.push_back(static_cast<float>(axes.at<double>(static_cast<int>(i), k)));
  return result;
}

Matrix project(const Matrix& rows, std::span<const float> mean, const Matrix& axes) {
  Matrix result{rows.rows, axes.rows, std::vector<float>(rows.rows * axes.rows)};
  cv::Mat coordinates = view(result);
  cv::gemm(centred(rows, mean), view(axes), 1.0, cv::noArray(), 0.0, coordinates, cv::GEMM_2_T);
  return result;
}

}  // namespace flies
