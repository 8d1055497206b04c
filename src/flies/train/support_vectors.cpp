#include "flies/train/support_vectors.hpp"

#include <libsvm/svm.h>
#include <linear.h>

#include <cassert>
#include <cstdlib>
#include <memory>
#include <vector>

#include "flies/classify/model_file.hpp"
#include "flies/train/principal_axes.hpp"

namespace flies {
namespace {

void say_nothing(const char*) {}

/// The sparse rows that both libraries read: index and value, ended by index -1.
template <class Node>
struct SparseRows {
  std::vector<Node> nodes;
  std::vector<Node*> rows;

  SparseRows(const Matrix& matrix, bool has_bias) {
    const std::size_t length = matrix.columns + (has_bias ? 2 : 1);
    nodes.reserve(matrix.rows * length);
    for (std::size_t i = 0; i < matrix.rows; ++i) {
      int index = 0;
      for (const float value : matrix.row(i)) nodes.push_back({++index, value});
      if (has_bias) nodes.push_back({++index, 1.0});
      nodes.push_back({-1, 0.0});
    }
    for (std::size_t i = 0; i < matrix.rows; ++i) rows.push_back(nodes.data() + i * length);
  }
};

std::vector<double> targets(std::span<const char> is_person) {
  std::vector<double> y;
  for (const char person : is_person) y.push_back(person ? 1.0 : -1.0);
  return y;
}

/// Both libraries count the class of the first window as positive.
double sign_of(const int* labels) { return labels[0] == 1 ? 1.0 : -1.0; }

}  // namespace

LinearStage train_linear(const Matrix& features, std::span<const char> is_person, const LinearSvmOptions& options,
                         std::uint64_t seed) {
  assert(features.rows == is_person.size());
  SparseRows<feature_node> sparse(features, true);
  std::vector<double> y = targets(is_person);
  problem data{};
  data.l = static_cast<int>(features.rows);
  data.n = static_cast<int>(features.columns) + 1;
  data.y = y.data();
  data.x = sparse.rows.data();
  data.bias = 1.0;
  parameter settings{};
  settings.solver_type = L2R_L1LOSS_SVC_DUAL;
  settings.eps = 0.05;  // of the projected gradient; LIBLINEAR proposes 0.1 for this solver
  settings.C = options.c;

  set_print_string_function(say_nothing);
  std::srand(static_cast<unsigned>(seed));
  struct Free {
    void operator()(model* m) const { free_and_destroy_model(&m); }
  };
  const std::unique_ptr<model, Free> trained(train(&data, &settings));
  const double sign = sign_of(trained->label);
  LinearStage stage;
  for (std::size_t k = 0; k < features.columns; ++k) stage.weights.push_back(static_cast<float>(sign * trained->w[k]));
  round_to_half(stage.weights);
  stage.bias = sign * trained->w[features.columns];
  return stage;
}

KernelStage train_kernel(const Matrix& features, std::span<const char> is_person, const KernelSvmOptions& options,
                         std::uint64_t seed) {
  assert(features.rows == is_person.size());
  KernelStage stage;
  PrincipalAxes axes = principal_axes(features, static_cast<std::size_t>(options.projection), seed);
  stage.mean = std::move(axes.mean);
  stage.projection = std::move(axes.axes);
  round_to_half(stage.mean);
  round_to_half(stage.projection.values);
  // What is learnt from is rounded like what is stored, so that a support vector is a window that was learnt from.
  Matrix projected = project(features, stage.mean, stage.projection);
  round_to_half(projected.values);

  SparseRows<svm_node> sparse(projected, false);
  std::vector<double> y = targets(is_person);
  svm_problem data{};
  data.l = static_cast<int>(projected.rows);
  data.y = y.data();
  data.x = sparse.rows.data();
  svm_parameter settings{};
  settings.svm_type = C_SVC;
  settings.kernel_type = RBF;
  settings.gamma = options.gamma;
  settings.C = options.c;
  settings.cache_size = 1000;  // megabytes of kernel rows
  settings.eps = 1e-2;
  settings.shrinking = 1;

  svm_set_print_string_function(say_nothing);
  struct Free {
    void operator()(svm_model* m) const { svm_free_and_destroy_model(&m); }
  };
  const std::unique_ptr<svm_model, Free> trained(svm_train(&data, &settings));
  const double sign = sign_of(trained->label);
  stage.gamma = options.gamma;
  stage.bias = -sign * trained->rho[0];
  stage.support_vectors.rows = static_cast<std::size_t>(trained->l);
  stage.support_vectors.columns = projected.columns;
  for (int i = 0; i < trained->l; ++i) {
    const auto row = projected.row(static_cast<std::size_t>(trained->sv_indices[i]) - 1);
    stage.support_vectors.values.insert(stage.support_vectors.values.end(), row.begin(), row.end());
    stage.coefficients.push_back(static_cast<float>(sign * trained->sv_coef[0][i]));
  }
  round_to_half(stage.coefficients);
  return stage;
}

}  // namespace flies
