#include "palpable/touch/modal_body.h"

#include "palpable/base/contract.h"
#include "palpable/reduced/mode_kernels.h"
#include "palpable/touch/point_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;

// Of a heap of points: radius over their distance, and m at most.
constexpr float kCluster = 3.5f, kLargestCluster = 0.0045f;
// m between contact points: the coarsest set and the finest; of large bodies twice and half of the
// distance that their points have. Those that are asked of other bodies lie twice the coarsest.
constexpr double kCoarsest = 0.006, kFinest = 0.0015, kBetween = 2;
// Vertices that tell how far a step moves the skin.
constexpr std::size_t kProbes = 128;

// (V) m, of each vertex from the nearest one on an edge, 1 where there is none.
std::vector<float> distances_from_edges(const Matrix3Xf& vertices, const std::vector<int>& edges) {
  std::vector<float> distances(static_cast<std::size_t>(vertices.cols()), 1.0f);
  for (Index v = 0; v < vertices.cols(); ++v) {
    float& nearest = distances[static_cast<std::size_t>(v)];
    for (const int e : edges) {
      nearest = std::min(nearest, (vertices.col(v) - vertices.col(e)).norm());
    }
  }
  return distances;
}

Eigen::Vector3i corners_of(const SkinPoint& point) {
  return {point.corners[0], point.corners[1], point.corners[2]};
}

}  // namespace

ModalBody::ModalBody(const ModalMember& member)
    : member_(member),
      n_(member.body->several->mode_count()),
      V_(member.body->surface.vertex_count()),
      rest_(member.body->surface.vertices.cast<float>()),
      points_(skin_points(member.body->surface, member.body->fixed, member.tables->point_spacing)),
      places_(places_of(points_, rest_)),
      coarsest_(static_cast<float>(std::max(kCoarsest, 2 * member.tables->point_spacing))),
      finest_(static_cast<float>(std::max(kFinest, 0.5 * member.tables->point_spacing))),
      between_(static_cast<float>(kBetween) * coarsest_),
      levels_(point_levels(member.body->surface, points_, static_cast<double>(between_),
                           static_cast<double>(finest_))),
      clusters_(
          rest_, points_, places_, levels_,
          std::min(kCluster * static_cast<float>(member.tables->point_spacing), kLargestCluster)),
      energy_(member.body->several->energy),
      surface_(member.body->surface),
      from_edge_(distances_from_edges(rest_, surface_.sharp_vertices())),
      q_(VectorXd::Zero(n_)),
      narrow_q_(Eigen::VectorXf::Zero(n_)),
      u_(Matrix3Xf::Zero(3, V_)),
      x_(rest_),
      shell_u_(3, member.tables->shell.nodes()) {
  const Eigen::MatrixXf& F = member.body->several->modes;
  rows_.resize(static_cast<std::size_t>(F.size()));
  for (Index r = 0; r < F.rows(); ++r) {
    for (Index i = 0; i < n_; ++i) rows_[static_cast<std::size_t>(r * n_ + i)] = F(r, i);
  }
  if (member.tables->shell.nodes() > 0) shell_.emplace(member.tables->shell, static_cast<int>(V_));
  const std::size_t heaps = clusters_.clusters().size();
  const std::size_t every = std::max<std::size_t>(1, heaps / kProbes);
  for (std::size_t k = 0; k < heaps; k += every) {
    probes_.push_back(clusters_.clusters()[k].vertex);
  }
  probe_u_.setZero(3, std::ssize(probes_));
  probe_was_ = probe_u_;
}

void ModalBody::set_q(const VectorXd& q) {
  if (q_ == q) return;
  q_ = q;
  narrow_q_ = q_.cast<float>();
  is_skin_old_ = is_surface_old_ = true;
  probe(probe_u_);
}

double ModalBody::move(const VectorXd& step, double share) {
  q_ += share * step;
  narrow_q_ = q_.cast<float>();
  is_skin_old_ = is_surface_old_ = true;
  probe_was_.swap(probe_u_);
  probe(probe_u_);
  if (probes_.empty()) return 0;
  return static_cast<double>(std::sqrt((probe_u_ - probe_was_).colwise().squaredNorm().maxCoeff()));
}

double ModalBody::farthest() const {
  return probes_.empty()
             ? 0
             : static_cast<double>(std::sqrt(probe_u_.colwise().squaredNorm().maxCoeff()));
}

void ModalBody::probe(Matrix3Xf& u) const {
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    for (Index c = 0; c < 3; ++c) {
      const Eigen::Map<const Eigen::VectorXf> row(rows_.data() + (3 * probes_[k] + c) * n_, n_);
      u(c, static_cast<Index>(k)) = row.dot(narrow_q_);
    }
  }
}

Vector3f ModalBody::displacement(const Eigen::Vector3i& corners, const Vector3f& weights) const {
  Vector3f u = Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) continue;
    for (Index c = 0; c < 3; ++c) {
      const Eigen::Map<const Eigen::VectorXf> row(
          rows_.data() + (3 * static_cast<Index>(corners[k]) + c) * n_, n_);
      u[c] += weights[k] * row.dot(narrow_q_);
    }
  }
  return u;
}

Vector3f ModalBody::place(int point) const {
  const SkinPoint& at = points_[static_cast<std::size_t>(point)];
  return places_.col(point) + displacement(corners_of(at), at.weights);
}

Vector3f ModalBody::place(const Eigen::Vector3i& corners, const Vector3f& weights) const {
  return rest_.col(corners[0]) * weights[0] + rest_.col(corners[1]) * weights[1] +
         rest_.col(corners[2]) * weights[2] + displacement(corners, weights);
}

Vector3f ModalBody::normal(int point) {
  const SkinPoint& at = points_[static_cast<std::size_t>(point)];
  const MovingSurface& now = surface();
  Vector3f sum = Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] == 0) continue;
    sum += at.weights[k] * now.vertex_normal(at.corners[static_cast<std::size_t>(k)]);
  }
  return sum.normalized();
}

float ModalBody::from_edge(const Eigen::Vector3i& corners, const Vector3f& weights) const {
  float sum = 0;
  for (int k = 0; k < 3; ++k) {
    sum += weights[k] * from_edge_[static_cast<std::size_t>(corners[k])];
  }
  return sum;
}

void ModalBody::add_row(const Eigen::Vector3i& corners, const Vector3f& weights, const Vector3d& d,
                        Eigen::Ref<VectorXd> result) const {
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) continue;
    for (Index c = 0; c < 3; ++c) {
      const Eigen::Map<const Eigen::VectorXf> row(
          rows_.data() + (3 * static_cast<Index>(corners[k]) + c) * n_, n_);
      result += (static_cast<double>(weights[k]) * d[c]) * row.cast<double>();
    }
  }
}

// u = sum_i q_i F_i.
void ModalBody::sum(const Eigen::MatrixXf& F, float* u) {
  const auto rows = static_cast<std::size_t>(F.rows());
  if (rows == 0) return;
  mode_kernels().front().sum({F.data(), rows, static_cast<std::size_t>(n_)}, narrow_q_.data(),
                             false, {u, rows});
}

const Matrix3Xf& ModalBody::skin() {
  if (is_skin_old_) {
    sum(member_.body->several->modes, u_.data());
    x_ = rest_ + u_;
    is_skin_old_ = false;
  }
  return x_;
}

const MovingSurface& ModalBody::surface() {
  if (is_surface_old_) surface_.move(skin());
  is_surface_old_ = false;
  return surface_;
}

void ModalBody::stress(std::span<float> von_mises, std::span<float> cauchy) {
  PALPABLE_EXPECT(shell_.has_value(), "stress needs a shell");
  (void)skin();
  shell_u_.leftCols(V_) = u_;
  sum(member_.tables->inner_modes, shell_u_.data() + 3 * V_);
  shell_->evaluate(shell_u_, von_mises, cauchy);
}

}  // namespace palpable
