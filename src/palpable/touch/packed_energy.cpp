#include "palpable/touch/packed_energy.h"

#include <cstddef>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

PackedEnergy::PackedEnergy(const QuarticEnergy& energy)
    : n_(energy.modes()),
      K_(energy.K),
      C_(energy.C.cast<float>()),
      products_(energy.K.size()),
      quartic_(energy.K.size()),
      cubic_(energy.K.size()) {
  const Index P = K_.size();
  D_.reserve(static_cast<std::size_t>(P * (P + 1) / 2));
  for (Index i = 0; i < P; ++i) {
    for (Index j = i; j < P; ++j) D_.push_back(static_cast<float>(energy.D(i, j)));
  }
}

void PackedEnergy::evaluate(const VectorXd& q, VectorXd& gradient, MatrixXd& hessian) {
  const Index P = K_.size();
  Index row = 0;
  for (Index j = 0; j < n_; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) {
      products_[row] = static_cast<float>((i == j ? 0.5 : 1.0) * q[i] * q[j]);
    }
  }
  cubic_.setZero();
  for (Index i = 0; i < n_; ++i) cubic_ += static_cast<float>(q[i]) * C_.col(i);
  quartic_.setZero();
  const float* from = D_.data();
  for (Index i = 0; i < P; ++i) {
    const Eigen::Map<const Eigen::VectorXf> of(from, P - i);
    quartic_[i] += of.dot(products_.tail(P - i));
    quartic_.tail(P - i - 1) += products_[i] * of.tail(P - i - 1);
    from += P - i;
  }
  gradient.setZero(n_);
  hessian.resize(n_, n_);
  row = 0;
  for (Index j = 0; j < n_; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) {
      const double cubic = static_cast<double>(cubic_[row]),
                   quartic = static_cast<double>(quartic_[row]);
      const double force = K_[row] + 0.5 * cubic + quartic / 3;
      gradient[i] += force * q[j];
      if (i != j) gradient[j] += force * q[i];
      hessian(i, j) = hessian(j, i) = K_[row] + cubic + quartic;
    }
  }
}

}  // namespace palpable
