#include "palpable/common/contact/modal_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/point_levels.h"
#include "palpable/common/geometry/element_order.h"
#include "palpable/common/reduced/mode_kernels.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;

// Of a heap of points: radius over their distance, and m at most.
constexpr float kCluster = 3.5f, kLargestCluster = 0.0045f;
// m between contact points: the coarsest set and the finest; of large bodies twice and half of the
// distance that their points have. Those that are asked of other bodies lie twice the coarsest.
constexpr double kCoarsest = 0.006, kFinest = 0.0015, kBetween = 2;
// Loads that are tried, and the states of theirs in which squares of the gradient are kept.
constexpr Index kLoads = 200, kLoadStates = 4;
// Heaps of a block.
constexpr std::size_t kHeapsOfBlock = 16;
// Vertices that tell how far a step moves the skin.
constexpr std::size_t kProbeVertices = 128;

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

// Of forces along the normals at vertices all over the skin: those few that most of their work is
// done in, each orthogonal to the others in the energy at rest.
LoadStates load_states(const ModalMember& member, const Matrix3Xf& rest) {
  const SeveralLoads& several = *member.body->several;
  const Index n = several.mode_count(), V = rest.cols();
  MatrixXd K(n, n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) K(i, j) = several.energy.K[pair_row(i, j)];
  }
  Matrix3Xf normals(3, V);
  vertex_normals(rest, member.body->surface.triangles, normals);
  const Eigen::LLT<MatrixXd> factor(K);
  MatrixXd work = MatrixXd::Zero(n, n);
  for (Index v = 0; v < V; v += std::max<Index>(1, V / kLoads)) {
    const VectorXd load =
        (several.modes.middleRows(3 * v, 3).transpose() * normals.col(v)).cast<double>();
    const VectorXd x = factor.matrixL().solve(load);
    work += x * x.transpose();
  }
  const Index m = std::min(n, kLoadStates);
  const MatrixXd most = Eigen::SelfAdjointEigenSolver<MatrixXd>(work).eigenvectors().rightCols(m);
  const MatrixXd states = factor.matrixU().solve(most);
  const MatrixXd duals = most.transpose() * MatrixXd(factor.matrixU());
  return {states.cast<float>(), duals.cast<float>()};
}

}  // namespace

bool are_twins(const ModalMember& one, const ModalMember& other) {
  const ReducedBody &a = *one.body, &b = *other.body;
  const QuarticEnergy &energy = a.several->energy, &others = b.several->energy;
  const ShellTable &shell = one.tables->shell, &other_shell = other.tables->shell;
  const auto same = [](const auto& x, const auto& y) {
    return x.rows() == y.rows() && x.cols() == y.cols() && x == y;
  };
  // Of one energy: of one law.
  return same(a.surface.vertices, b.surface.vertices) &&
         same(a.surface.triangles, b.surface.triangles) &&
         same(a.several->modes, b.several->modes) && same(energy.K, others.K) &&
         same(energy.C, others.C) && same(energy.D, others.D) &&
         same(one.tables->inner_modes, other.tables->inner_modes) &&
         same(shell.stress_free, other_shell.stress_free) &&
         same(shell.preload, other_shell.preload) && shell.elements == other_shell.elements &&
         shell.materials.size() == other_shell.materials.size() &&
         shell.first == other_shell.first && shell.points == other_shell.points &&
         shell.weights == other_shell.weights;
}

ModalBody::ModalBody(const ModalMember& member, const ModalBody* twin)
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
      modes_(twin != nullptr ? twin->modes_ : &member.body->several->modes),
      energy_(twin != nullptr ? twin->energy_
                              : std::make_shared<PackedEnergy>(member.body->several->energy)),
      surface_(member.body->surface),
      normals_(member.body->surface.triangles, static_cast<int>(V_)),
      from_edge_(distances_from_edges(rest_, surface_.sharp_vertices())),
      q_(VectorXd::Zero(n_)),
      narrow_q_(Eigen::VectorXf::Zero(n_)),
      u_(Matrix3Xf::Zero(3, V_)),
      x_(rest_) {
  const Eigen::MatrixXf& F = member.body->several->modes;
  rows_.resize(static_cast<std::size_t>(F.size()));
  for (Index r = 0; r < F.rows(); ++r) {
    for (Index i = 0; i < n_; ++i) rows_[static_cast<std::size_t>(r * n_ + i)] = F(r, i);
  }
  if (member.tables->shell.nodes() > 0) {
    const ShellTable& shell = member.tables->shell;
    if (twin != nullptr && twin->stress_) {
      stress_ = twin->stress_;
    } else if (ModalStress::serves(shell)) {
      stress_ = std::make_shared<ModalStress>(shell, F, member.tables->inner_modes,
                                              load_states(member, rest_));
    } else {
      shell_u_.resize(3, shell.nodes());
      shell_.emplace(shell, static_cast<int>(V_));
    }
  }
  arrange_heaps();
  for (std::size_t p = 0; p < points_.size(); ++p) {
    // Up to the next finer set.
    if (levels_[p] * std::numbers::sqrt2_v < float >> between_) {
      points_between_.push_back(static_cast<int>(p));
    }
  }
  const std::span<const SkinCluster> heaps = clusters_.clusters();
  const std::size_t every = std::max<std::size_t>(1, heaps.size() / kProbeVertices);
  const auto count = static_cast<Index>((heaps.size() + every - 1) / every);
  probes_.resize(3 * count, n_);
  for (Index k = 0; k < count; ++k) {
    probes_.middleRows(3 * k, 3) =
        F.middleRows(3 * heaps[static_cast<std::size_t>(k) * every].vertex, 3);
  }
  probe_u_.setZero(3, count);
  probe_was_ = probe_u_;
}

// Heaps that lie beside each other stand beside each other, in blocks.
void ModalBody::arrange_heaps() {
  const std::span<const SkinCluster> heaps = clusters_.clusters();
  if (heaps.empty()) return;
  Eigen::Matrix3Xd middles(3, std::ssize(heaps));
  for (Index k = 0; k < middles.cols(); ++k) {
    middles.col(k) = rest_.col(heaps[static_cast<std::size_t>(k)].vertex).cast<double>();
  }
  for (const int k : order_along_curve(middles)) {
    if (heaps_.size() % kHeapsOfBlock == 0) {
      const int at = static_cast<int>(heaps_.size());
      blocks_.push_back({at, at, 0, {}});
    }
    heaps_.push_back(heaps[static_cast<std::size_t>(k)]);
    blocks_.back().last = static_cast<int>(heaps_.size());
    blocks_.back().radius = std::max(blocks_.back().radius, heaps_.back().radius);
  }
}

void ModalBody::changed() {
  narrow_q_ = q_.cast<float>();
  is_skin_old_ = is_surface_old_ = are_blocks_old_ = true;
  sum(probes_, probe_u_.data());
}

void ModalBody::set_q(const VectorXd& q) {
  if (q_ == q) return;
  q_ = q;
  changed();
}

double ModalBody::move(const VectorXd& step, double share) {
  q_ += share * step;
  probe_was_.swap(probe_u_);
  changed();
  if (probe_u_.cols() == 0) return 0;
  return static_cast<double>(std::sqrt((probe_u_ - probe_was_).colwise().squaredNorm().maxCoeff()));
}

double ModalBody::farthest() const {
  return probe_u_.cols() == 0
             ? 0
             : static_cast<double>(std::sqrt(probe_u_.colwise().squaredNorm().maxCoeff()));
}

void ModalBody::find_rows(const Eigen::Vector3i& corners, const Vector3f& weights,
                          Eigen::Ref<Eigen::MatrixXf> rows) const {
  auto sums = rows.topRows(n_);
  sums.setZero();
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) continue;
    const Eigen::Map<const Eigen::MatrixXf> here(
        rows_.data() + 3 * static_cast<Index>(corners[k]) * n_, n_, 3);
    sums += weights[k] * here;
  }
}

Vector3f ModalBody::rest_place(const Eigen::Vector3i& corners, const Vector3f& weights) const {
  return rest_.col(corners[0]) * weights[0] + rest_.col(corners[1]) * weights[1] +
         rest_.col(corners[2]) * weights[2];
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

// u = sum_i q_i F_i.
void ModalBody::sum(const Eigen::MatrixXf& F, float* u) const {
  const auto rows = static_cast<std::size_t>(F.rows());
  if (rows == 0) return;
  mode_kernels().front().sum({F.data(), rows, static_cast<std::size_t>(n_)}, narrow_q_.data(),
                             false, {u, rows});
}

const Matrix3Xf& ModalBody::skin() {
  if (is_skin_old_) {
    sum(*modes_, u_.data());
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

std::span<const HeapBlock> ModalBody::blocks() {
  if (!are_blocks_old_) return blocks_;
  const Matrix3Xf& now = skin();
  for (HeapBlock& block : blocks_) {
    block.middles.setEmpty();
    for (int k = block.first; k < block.last; ++k) {
      block.middles.extend(Vector3f(now.col(heaps_[static_cast<std::size_t>(k)].vertex)));
    }
  }
  are_blocks_old_ = false;
  return blocks_;
}

Eigen::AlignedBox3f ModalBody::bounds() {
  Eigen::AlignedBox3f all;
  for (const HeapBlock& block : blocks()) {
    const Vector3f reach = Vector3f::Constant(kHeapStretch * block.radius);
    all.extend(Eigen::AlignedBox3f(block.middles.min() - reach, block.middles.max() + reach));
  }
  return all;
}

void ModalBody::stress(std::span<float> von_mises, std::span<float> cauchy) {
  if (stress_) {
    const auto n = static_cast<std::size_t>(n_);
    stress_->evaluate({narrow_q_.data(), n}, von_mises, cauchy);
    return;
  }
  PALPABLE_EXPECT(shell_.has_value(), "stress needs a shell");
  (void)skin();
  shell_u_.leftCols(V_) = u_;
  sum(member_.tables->inner_modes, shell_u_.data() + 3 * V_);
  shell_->evaluate(shell_u_, von_mises, cauchy);
}

}  // namespace palpable
