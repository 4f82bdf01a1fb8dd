#include "palpable/solid/quasi_newton.h"

#include <utility>

namespace palpable {

void QuasiNewton::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                        const LinearMap& apply_factor) {
  if (pairs_.empty()) {
    apply_factor(b, x);
    return;
  }
  // The two loops of L-BFGS (Nocedal and Wright, algorithm 7.4), in numbers of order one. Each
  // pass adds one vector and multiplies by the next.
  const double scale = b.cwiseAbs().maxCoeff();
  if (scale == 0.0) {
    x.setZero(b.size());
    return;
  }
  const std::size_t count = pairs_.size();
  q_.setZero(pairs_.front().s.padded_size());
  auto q = q_.head(b.size());
  q = (b / scale).cast<float>();
  shares_.resize(count);
  float along = dot(simd_, pairs_.back().s, q_);
  for (std::size_t i = count; i-- > 0;) {
    const Pair& pair = pairs_[i];
    shares_[i] = pair.inverse_curvature * static_cast<double>(along);
    // After the last nothing is left to multiply by: any vector will do.
    along = add_then_dot(simd_, static_cast<float>(-shares_[i]), pair.y, q_,
                         pairs_[i > 0 ? i - 1 : 0].s);
  }
  wide_ = q.cast<double>();
  apply_factor(wide_, x);
  q = x.cast<float>();
  along = dot(simd_, pairs_.front().y, q_);
  for (std::size_t i = 0; i < count; ++i) {
    const Pair& pair = pairs_[i];
    const double share = pair.inverse_curvature * static_cast<double>(along);
    along = add_then_dot(simd_, static_cast<float>(shares_[i] - share), pair.s, q_,
                         pairs_[i + 1 < count ? i + 1 : i].y);
  }
  x = scale * q.cast<double>();
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
  pair.s.assign(s / length);
  pair.y.assign(Ks / length);
  pair.inverse_curvature = 1.0 / pair.s.dot(pair.y);
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
