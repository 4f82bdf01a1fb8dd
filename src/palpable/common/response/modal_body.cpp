#include "palpable/common/response/modal_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/point_levels.h"
#include "palpable/common/reduced/mode_kernels.h"
#include "palpable/common/reduced/small_cholesky.h"

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

// Radius of a cluster of contact points: ratio to the distance between points, and m at most.
constexpr float kCluster = 3.5f, kLargestCluster = 0.0045f;
// m between contact points, of the coarsest and of the finest set; at least twice and half of
// ModalTables::point_spacing. Points that are searched on other bodies are kBetween times as far
// apart as the coarsest set.
constexpr double kCoarsest = 0.006, kFinest = 0.0015, kBetween = 2;
// About how many loads the load states are found from, and how many load states are kept
// (modal_stress.h).
constexpr Index kLoads = 200, kLoadStates = 4;
// About how many vertices the displacement of the skin by a step is measured at.
constexpr std::size_t kProbeVertices = 128;
// Mean displacement of a disc of radius a pressed evenly by f: w = 0.54 f (1 - nu^2) / (E a).
constexpr double kDisc = 0.54;
// The local compliance of the skin grows by this factor times SurfaceGap::softness. The softness is
// the uncertainty sigma of the obstacle's surface divided by 10 mm: where the surface is known to
// within 1 mm, the compliance doubles, so that an uncertain obstacle presses less sharply.
constexpr double kSofter = 10;
// Where the Hessian is not positive definite, its diagonal is shifted: by this ratio at first, then
// by four times as much up to kShifts - 1 times.
constexpr double kFirstShift = 0.01;
constexpr int kShifts = 20;
// ContactLimits::thins_above. Fewer points than for other bodies are enough: a beam is smooth.
constexpr int kEnoughPoints = 160;

ContactLimits modal_limits(const ModalSettings& s) {
  ContactLimits limits = limits_from(s);
  limits.largest_change = s.largest_move;
  limits.damped = false;
  limits.thins_above = kEnoughPoints;
  limits.narrows = true;
  return limits;
}

// The few states in which forces along the normals at vertices all over the skin do most of their
// work, orthogonal to each other in the energy at rest.
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
  // Bodies with the same energy have the same law, so materials are not compared.
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

ModalBody::ModalBody(const ModalMember& member, const ModalBody* twin,
                     const ModalSettings& settings)
    : member_(member),
      limits_(modal_limits(settings)),
      friction_(settings.friction.value_or(member.tables->friction)),
      n_(member.body->several->mode_count()),
      V_(member.body->surface.vertex_count()),
      rest_(member.body->surface.vertices.cast<float>()),
      points_(skin_points(member.body->surface, member.body->fixed, member.tables->point_spacing)),
      points_at_rest_(places_of(points_, rest_)),
      held_(held_vertices(rest_, member.body->fixed)),
      coarsest_(static_cast<float>(std::max(kCoarsest, 2 * member.tables->point_spacing))),
      finest_(static_cast<float>(std::max(kFinest, 0.5 * member.tables->point_spacing))),
      between_(static_cast<float>(kBetween) * coarsest_),
      levels_(point_levels(member.body->surface, points_, static_cast<double>(between_),
                           static_cast<double>(finest_))),
      clusters_(
          rest_, points_, points_at_rest_, levels_,
          std::min(kCluster * static_cast<float>(member.tables->point_spacing), kLargestCluster)),
      modes_(twin != nullptr ? twin->modes_ : &member.body->several->modes),
      energy_(twin != nullptr ? twin->energy_
                              : std::make_shared<PackedEnergy>(member.body->several->energy)),
      surface_(member.body->surface),
      normals_(member.body->surface.triangles, static_cast<int>(V_)),
      q_(VectorXd::Zero(n_)),
      narrow_q_(Eigen::VectorXf::Zero(n_)),
      u_(Matrix3Xf::Zero(3, V_)),
      x_(rest_),
      q_begun_(q_),
      q_linearised_(q_),
      step_(q_),
      free_(q_),
      factor_(n_, n_) {
  gradient_.setZero(n_);
  hessian_.setZero(n_, n_);
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
  const std::span<const SkinCluster> clusters = clusters_.clusters();
  const std::size_t every = std::max<std::size_t>(1, clusters.size() / kProbeVertices);
  const auto count = static_cast<Index>((clusters.size() + every - 1) / every);
  probe_modes_.resize(3 * count, n_);
  for (Index k = 0; k < count; ++k) {
    probe_modes_.middleRows(3 * k, 3) =
        F.middleRows(3 * clusters[static_cast<std::size_t>(k) * every].vertex, 3);
  }
  probes_.setZero(3, count);
  probes_begun_ = probes_kept_ = probes_linearised_ = probes_;
  make_room(kMostPlaces);
}
ModalBody::~ModalBody() = default;

void ModalBody::make_room(int places) {
  most_places_ = static_cast<std::size_t>(places);
  for (auto* list : {&next_, &now_}) list->reserve(most_places_);
  row_of_.reserve(most_places_);
  now_at_rest_.resize(3, places);
  place_rows_.resize(n_, 3 * places);
  columns_.resize(n_, places);
  tangents_.resize(n_, 2 * places);
}

// --- the modes

// u = sum_i q_i F_i.
void ModalBody::sum(const Eigen::MatrixXf& F, float* u) const {
  const auto rows = static_cast<std::size_t>(F.rows());
  if (rows == 0) return;
  mode_kernels().front().sum({F.data(), rows, static_cast<std::size_t>(n_)}, narrow_q_.data(),
                             false, {u, rows});
}

void ModalBody::set_q(const VectorXd& q) {
  if (q_ == q) return;
  q_ = q;
  narrow_q_ = q_.cast<float>();
  is_skin_old_ = is_surface_old_ = is_box_old_ = true;
  sum(probe_modes_, probes_.data());
}

// Largest distance of the probes from these positions, m.
double ModalBody::distance_to(const Probes& probes) const {
  if (probes_.cols() == 0) return 0;
  return static_cast<double>(std::sqrt((probes_ - probes).colwise().squaredNorm().maxCoeff()));
}

// The modes at a place, (n x 3): one column per direction.
void ModalBody::find_rows(const SkinPoint& at, Eigen::Ref<Eigen::MatrixXf> rows) const {
  rows.setZero();
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight = at.weights[static_cast<int>(k)];
    if (weight == 0) continue;
    const Eigen::Map<const Eigen::MatrixXf> here(
        rows_.data() + 3 * static_cast<Index>(at.corners[k]) * n_, n_, 3);
    rows += weight * here;
  }
}

// --- frame

void ModalBody::begin_frame() {
  ModalState& state = *state_;
  if (state.q.size() != n_) {
    state.q.setZero(n_);
    state.forces.clear();
    state.forces.reserve(2 * std::size_t{kMostPlacesWithOthers});
    state.anchors.clear();
    if (friction_ > 0) state.anchors.reserve(2 * std::size_t{kMostPlacesWithOthers});
  }
  set_q(state.q);
  q_begun_ = q_;
  probes_begun_ = probes_kept_ = probes_;
  forces_begun_.start(state.forces);
}

SkinPointSet ModalBody::contact_points() const {
  return {points_,
          levels_,
          &clusters_,
          coarsest_,
          finest_,
          between_,
          static_cast<float>(member_.tables->point_spacing),
          &held_};
}

// --- shape

const Matrix3Xf& ModalBody::skin() {
  if (is_skin_old_) {
    sum(*modes_, u_.data());
    x_ = rest_ + u_;
    is_skin_old_ = false;
  }
  return x_;
}

Eigen::AlignedBox3f ModalBody::bounds() {
  if (is_box_old_) {
    box_.setEmpty();
    for (const auto& x : skin().colwise()) box_.extend(Vector3f(x));
    is_box_old_ = false;
  }
  return box_;
}

const MovingSurface& ModalBody::surface() {
  if (is_surface_old_) surface_.move(skin());
  is_surface_old_ = false;
  return surface_;
}

Vector3f ModalBody::shape_at(int point) {
  return points_[static_cast<std::size_t>(point)].at(skin());
}

Vector3f ModalBody::normal_at(int point) {
  const SkinPoint& at = points_[static_cast<std::size_t>(point)];
  const MovingSurface& now = surface();
  Vector3f sum = Vector3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight = at.weights[static_cast<int>(k)];
    if (weight != 0) sum += weight * now.vertex_normal(at.corners[k]);
  }
  return sum.normalized();
}

// --- a step

bool ModalBody::add_place(const SkinPoint& place) {
  if (next_.size() == most_places_) return false;
  next_.push_back(place);
  return true;
}

void ModalBody::begin_step(std::span<const PlaceLoad>, bool) {
  now_.assign(next_.begin(), next_.end());
  for (std::size_t p = 0; p < now_.size(); ++p) {
    const auto P = static_cast<Index>(p);
    now_at_rest_.col(P) = now_[p].at(rest_);
    find_rows(now_[p], place_rows_.middleCols(3 * P, 3));
  }
}

Vector3f ModalBody::position(std::size_t place) const {
  const auto P = static_cast<Index>(place);
  return now_at_rest_.col(P) + place_rows_.middleCols(3 * P, 3).transpose() * narrow_q_;
}

// --- an iteration

bool ModalBody::linearise() {
  q_linearised_ = q_;
  probes_linearised_ = probes_;
  energy_->evaluate(q_, gradient_, hessian_);
  factor_ = hessian_;
  double shift = 0;
  for (int tries = 0; !factorise_small(factor_); ++tries) {
    if (tries == kShifts) return false;  // a number is not finite
    shift = shift == 0 ? kFirstShift : 4 * shift;
    factor_ = hessian_;
    factor_.diagonal() += shift * hessian_.diagonal().cwiseAbs();
  }
  free_ = -gradient_;
  solve_lower(factor_, free_);
  return true;
}

// Fills L^-1 B of a unit force. @param column  (n)
void ModalBody::find_column(const UnitForce& force, Eigen::Ref<VectorXd> column) const {
  const auto first = 3 * static_cast<Index>(force.place);
  const Vector3d d = force.direction.cast<double>();
  column = d[0] * place_rows_.col(first).cast<double>() +
           d[1] * place_rows_.col(first + 1).cast<double>() +
           d[2] * place_rows_.col(first + 2).cast<double>();
  solve_lower(factor_, column);
}

// The tangent is always positive definite, so its kind does not matter.
void ModalBody::add_compliance(std::span<const UnitForce> forces, Tangent, std::span<double> W,
                               std::size_t m, std::span<double> q) {
  row_of_.clear();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const auto I = static_cast<Index>(i);
    find_column(forces[i], columns_.col(I));
    row_of_.push_back(forces[i].row);
    q[forces[i].row] += columns_.col(I).dot(free_);
    for (Index j = 0; j <= I; ++j) {
      W[forces[i].row * m + row_of_[static_cast<std::size_t>(j)]] +=
          columns_.col(I).dot(columns_.col(j));
    }
  }
}

void ModalBody::add_tangential(std::span<const UnitForce> forces, Tangent, std::span<float> W_nt,
                               std::size_t wide, std::span<double> W_tt, std::span<double> q_t) {
  const std::size_t t = q_t.size();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const auto I = static_cast<Index>(i);
    find_column(forces[i], tangents_.col(I));
    q_t[forces[i].row] += tangents_.col(I).dot(free_);
    for (std::size_t p = 0; p < row_of_.size(); ++p) {
      W_nt[row_of_[p] * wide + forces[i].row] +=
          static_cast<float>(columns_.col(static_cast<Index>(p)).dot(tangents_.col(I)));
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const double value = tangents_.col(I).dot(tangents_.col(static_cast<Index>(j)));
      W_tt[forces[i].row * t + forces[j].row] += value;
      if (i != j) W_tt[forces[j].row * t + forces[i].row] += value;
    }
  }
}

double ModalBody::skin_compliance(double area, float softness, bool is_foot) const {
  const double half_space =
      member_.tables->half_space * (is_foot ? 1 : 1 + kSofter * static_cast<double>(softness));
  return kDisc * half_space / std::sqrt(area / std::numbers::pi);
}

void ModalBody::find_step(std::span<const Vector3f> forces) {
  step_.setZero();
  for (std::size_t p = 0; p < now_.size(); ++p) {
    if (forces[p].isZero(0)) continue;
    for (int d = 0; d < 3; ++d) {
      step_ += static_cast<double>(forces[p][d]) *
               place_rows_.col(3 * static_cast<Index>(p) + d).cast<double>();
    }
  }
  solve_lower(factor_, step_);
  step_ += free_;
  solve_upper(factor_, step_);
}

double ModalBody::move(std::span<const Vector3f>, double share) {
  q_ = q_linearised_ + share * step_;
  narrow_q_ = q_.cast<float>();
  is_skin_old_ = is_surface_old_ = is_box_old_ = true;
  sum(probe_modes_, probes_.data());
  return distance_to(probes_linearised_);
}

// --- end of a step

bool ModalBody::has_moved(double way) const { return distance_to(probes_kept_) > way; }

void ModalBody::keep(bool is_free) {
  // A body without contacts that is this close to rest is at rest: the remainder is rounding.
  if (is_free && !probes_.isZero(0) &&
      std::sqrt(probes_.colwise().squaredNorm().maxCoeff()) <
          static_cast<float>(limits_.tolerance)) {
    step_.setZero();
    set_q(step_);
  }
  state_->q = q_;
  probes_kept_ = probes_;
}

// --- end of a frame

double ModalBody::moved() const { return distance_to(probes_begun_); }

void ModalBody::limit_step(double share) {
  step_ = q_begun_ + share * (q_ - q_begun_);
  set_q(step_);
  state_->q = q_;
  forces_begun_.limit_step(state_->forces, static_cast<float>(share));
}

// --- any state

void ModalBody::show(const ModalState& state) {
  if (state.q.size() == n_) {
    set_q(state.q);
  } else {
    step_.setZero();
    set_q(step_);
  }
}

const Matrix3Xf& ModalBody::place(const ModalState& state) {
  show(state);
  return skin();
}

void ModalBody::find_normals(const ModalState& state, Matrix3Xf& normals) {
  show(state);
  normals_.find(skin(), normals);
}

void ModalBody::stress(const ModalState& state, std::span<float> von_mises,
                       std::span<float> cauchy) {
  show(state);
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
