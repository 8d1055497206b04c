#include "flies/classify/svm_scores.hpp"

#include <cassert>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "flies/classify/dot.hpp"
#include "flies/classify/people_model.hpp"
#include "flies/classify/vector_clones.hpp"

namespace flies {

FLIES_VECTOR_CLONES double linear_score(const LinearStage& stage, std::span<const float> features) {
  assert(features.size() == stage.weights.size());
  return stage.bias + dot(stage.weights.data(), features.data(), features.size());
}

FLIES_VECTOR_CLONES double linear_score(const LinearStage& stage, const FeaturePieces& pieces) {
  assert(pieces.size * pieces.count == stage.weights.size());
  return stage.bias + dot_of_pieces(stage.weights.data(), pieces.first, pieces.size, pieces.stride, pieces.count);
}

FLIES_VECTOR_CLONES double kernel_score(const KernelStage& stage, std::span<const float> features) {
  assert(features.size() == stage.mean.size());
  std::vector<float> centred(features.begin(), features.end());
  for (std::size_t i = 0; i < centred.size(); ++i) centred[i] -= stage.mean[i];
  std::vector<float> point;
  for (std::size_t i = 0; i < stage.projection.rows; ++i)
    point.push_back(dot(stage.projection.row(i).data(), centred.data(), centred.size()));
  if (stage.projection.rows == 0) point = std::move(centred);

  double score = stage.bias;
  for (std::size_t i = 0; i < stage.support_vectors.rows; ++i)
    score += stage.coefficients[i] *
             std::exp(-stage.gamma * squared_distance(point.data(), stage.support_vectors.row(i).data(), point.size()));
  return score;
}

}  // namespace flies
