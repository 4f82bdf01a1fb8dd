#include "palpable/bake/solid/quasi_newton.h"

#include <utility>

namespace palpable {

void QuasiNewton::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                        const LinearMap& apply_factor) {
  if (pairs_.empty()) {
    apply_factor(b, x);
    return;
  }
  // The two loops of L-BFGS (Nocedal and Wright, algorithm 7.4), on b scaled to numbers of order
  // one. Each pass over memory adds one vector and multiplies by the next.
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
    // After the last pair the product is not used; any vector will do.
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

void QuasiNewton::record(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks) {
  // The memory of an old pair is used again: of the oldest recorded one, or of one given up.
  Pair pair;
  auto& source = static_cast<int>(recorded_.size()) == capacity_ ? recorded_ : spare_;
  if (!source.empty()) {
    pair = std::move(source.front());
    source.pop_front();
  }
  // The update does not depend on the length of s, but single precision has a small range.
  const double length = s.norm();
  pair.s.assign(s / length);
  pair.y.assign(Ks / length);
  pair.inverse_curvature = 1.0 / pair.s.dot(pair.y);
  if (pair.inverse_curvature > 0.0) {
    recorded_.push_back(std::move(pair));
  } else {  // rounding has made the curvature negative
    spare_.push_back(std::move(pair));
  }
}

void QuasiNewton::use_recorded() {
  for (Pair& pair : recorded_) {
    if (static_cast<int>(pairs_.size()) == capacity_) {
      spare_.push_back(std::move(pairs_.front()));
      pairs_.pop_front();
    }
    pairs_.push_back(std::move(pair));
  }
  recorded_.clear();
}

}  // namespace palpable
