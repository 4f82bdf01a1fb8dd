#include "palpable/solid/quasi_newton.h"

#include <utility>

namespace palpable {

void QuasiNewton::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                        const LinearMap& apply_factor) {
  if (pairs_.empty()) {
    apply_factor(b, x);
    return;
  }
  // The two loops of L-BFGS (Nocedal and Wright, algorithm 7.4), in numbers of order one.
  const double scale = b.cwiseAbs().maxCoeff();
  if (scale == 0.0) {
    x.setZero(b.size());
    return;
  }
  q_ = (b / scale).cast<float>();
  shares_.resize(pairs_.size());
  for (std::size_t i = pairs_.size(); i-- > 0;) {
    const Pair& pair = pairs_[i];
    shares_[i] = pair.inverse_curvature * static_cast<double>(pair.s.dot(q_));
    q_ -= static_cast<float>(shares_[i]) * pair.y;
  }
  wide_ = q_.cast<double>();
  apply_factor(wide_, x);
  z_ = x.cast<float>();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    const double share = pair.inverse_curvature * static_cast<double>(pair.y.dot(z_));
    z_ += static_cast<float>(shares_[i] - share) * pair.s;
  }
  x = scale * z_.cast<double>();
}

void QuasiNewton::note(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks) {
  // The memory of a pair is used again: the oldest noted one's, or one that was given up.
  Pair pair;
  auto& source = static_cast<int>(noted_.size()) == capacity_ ? noted_ : spare_;
  if (!source.empty()) {
    pair = std::move(source.front());
    source.pop_front();
  }
  // The update does not see the length of a pair; single precision does.
  const double length = s.norm();
  pair.s = (s / length).cast<float>();
  pair.y = (Ks / length).cast<float>();
  pair.inverse_curvature = 1.0 / static_cast<double>(pair.s.dot(pair.y));
  if (pair.inverse_curvature > 0.0) {
    noted_.push_back(std::move(pair));
  } else {  // rounded away
    spare_.push_back(std::move(pair));
  }
}

void QuasiNewton::learn() {
  for (Pair& pair : noted_) {
    if (static_cast<int>(pairs_.size()) == capacity_) {
      spare_.push_back(std::move(pairs_.front()));
      pairs_.pop_front();
    }
    pairs_.push_back(std::move(pair));
  }
  noted_.clear();
}

}  // namespace palpable
