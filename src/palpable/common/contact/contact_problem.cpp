#include "palpable/common/contact/contact_problem.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/nth_element.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/contact/dense_solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Largest number of contacts with turning normals, those with the largest force times curvature; a
// multiple of 8.
constexpr std::size_t kMostTurning = 16;
// Force times curvature times compliance, below which the turning of a contact's normal is left
// out: about the relative change of the step by it.
constexpr double kTurns = 0.02;
// Largest eigenvalue of G_tt D. D is scaled down to it, because M = (1 - D G_tt)^-1 D has a pole at
// 1.
constexpr double kLargestTurn = 0.8;
// A point slides whose friction is nearer to its bound than this, as a ratio: rounding of forces.
constexpr double kAtBound = 1e-9;

}  // namespace

ContactProblem::ContactProblem(int most) : complementarity_(most) {
  const auto m = static_cast<std::size_t>(most);
  W_.resize(m * m);
  for (auto* vector : {&q_, &f_, &local_}) vector->resize(m);
  sums_.resize(m);
  turning_.reserve(m);
  constexpr std::size_t t = 2 * kMostTurning;
  Gnt_.resize(m * padded(t));
  M_.resize(t * padded(t));
  for (auto* matrix : {&Gtt_, &D_, &scratch_, &solved_}) matrix->resize(t * t);
  for (auto* vector : {&qt_, &x_, &y_}) vector->resize(t);
}

// Computes W = N J N^T, and q: the gaps without forces, by the tangents.
void ContactProblem::assemble(std::span<const Contact> contacts, std::span<ProblemBody> bodies,
                              const ContactStep& step) {
  const std::size_t m = contacts.size();
  for (ProblemBody& body : bodies) body.normals.clear();
  for (std::size_t p = 0; p < m; ++p) {
    const Contact& c = contacts[p];
    bodies[static_cast<std::size_t>(c.body)].normals.push_back({p, c.place, c.normal});
    q_[p] = static_cast<double>(c.distance) + (c.by < 0 ? step.shift : 0.0);
    if (c.by < 0) continue;
    bodies[static_cast<std::size_t>(c.by)].normals.push_back({p, c.on_foot, -c.foot_normal});
  }
  std::fill_n(W_.begin(), m * m, 0.0);
  for (const ProblemBody& body : bodies) {
    if (body.normals.empty()) continue;
    body.body->add_compliance(body.normals, step.tangent, {W_.data(), m * m}, m, {q_.data(), m});
  }
}

void ContactProblem::find_local_compliance(std::span<const Contact> contacts,
                                           std::span<const ProblemBody> bodies) {
  for (std::size_t p = 0; p < contacts.size(); ++p) {
    const Contact& c = contacts[p];
    local_[p] =
        bodies[static_cast<std::size_t>(c.body)].body->skin_compliance(c.area, c.softness, false);
    if (c.by < 0) continue;
    local_[p] +=
        bodies[static_cast<std::size_t>(c.by)].body->skin_compliance(c.area, c.softness, true);
  }
}

// Finds the contacts with curved obstacles whose force is large enough for turning to matter.
void ContactProblem::find_turning(std::span<const Contact> contacts) {
  turning_.clear();
  for (std::size_t p = 0; p < contacts.size(); ++p) {
    const Contact& c = contacts[p];
    const double turn = c.pressing * static_cast<double>(c.curvature.trace());
    if (turn * W_[p * contacts.size() + p] < kTurns) continue;
    Turning t{p, c.normal.unitOrthogonal(), {}};
    t.t2 = c.normal.cross(t.t1);
    turning_.push_back(t);
  }
  if (turning_.size() <= kMostTurning) return;
  const auto weight = [&](const Turning& t) {
    const Contact& c = contacts[t.contact];
    return c.pressing * static_cast<double>(c.curvature.trace());
  };
  select_nth(turning_.begin(), turning_.begin() + kMostTurning, turning_.end(),
             [&](const Turning& a, const Turning& b) { return weight(a) > weight(b); });
  turning_.resize(kMostTurning);
}

// Scales D_ down so that the largest eigenvalue of G_tt D, estimated by a few steps of the power
// method, is at most kLargestTurn.
void ContactProblem::bound_turning(std::size_t t) {
  const auto size = static_cast<Eigen::Index>(t);
  const Eigen::Map<const Eigen::MatrixXd> Gtt(Gtt_.data(), size, size);
  Eigen::Map<Eigen::VectorXd> x(x_.data(), size), y(y_.data(), size);
  x.setOnes();
  double largest = 0;
  for (int step = 0; step < 8; ++step) {
    for (std::size_t i = 0; i < t; ++i) {
      const std::size_t pair = i / 2 * 2;
      y_[i] = D_[i * t + pair] * x_[pair] + D_[i * t + pair + 1] * x_[pair + 1];
    }
    x.setZero();
    for (Eigen::Index j = 0; j < size; ++j) x += y[j] * Gtt.col(j);
    largest = x.norm();
    if (!(largest > 0)) break;
    x /= largest;
  }
  if (!(largest > kLargestTurn)) return;
  for (std::size_t i = 0; i < t * t; ++i) D_[i] *= kLargestTurn / largest;
}

// Computes G_nt, G_tt and the free displacement of the turning contacts.
void ContactProblem::assemble_tangential(std::span<const Contact> contacts,
                                         std::span<ProblemBody> bodies) {
  const std::size_t m = contacts.size(), t = 2 * turning_.size(), wide = padded(t);
  for (ProblemBody& body : bodies) body.tangents.clear();
  for (std::size_t i = 0; i < t; ++i) {
    const Contact& c = contacts[turning_[i / 2].contact];
    bodies[static_cast<std::size_t>(c.body)].tangents.push_back({i, c.place, tangent(i)});
  }
  std::fill_n(Gnt_.begin(), m * wide, 0.0f);
  std::fill_n(Gtt_.begin(), t * t, 0.0);
  std::fill_n(qt_.begin(), t, 0.0);
  for (const ProblemBody& body : bodies) {
    if (body.tangents.empty()) continue;
    body.body->add_tangential(body.tangents, ContactBody::Tangent::kSafe, {Gnt_.data(), m * wide},
                              wide, {Gtt_.data(), t * t}, {qt_.data(), t});
  }
  for (std::size_t i = 0; i < t; ++i) {
    const Contact& c = contacts[turning_[i / 2].contact];
    for (std::size_t j = 0; j < t; ++j) {
      const bool same = i / 2 == j / 2;
      D_[i * t + j] =
          same ? c.pressing * static_cast<double>(tangent(i).dot(c.curvature * tangent(j))) : 0.0;
    }
  }
}

// Adds the turning of normals to W and q; M_, qt_ and Gnt_ remain for the forces afterwards.
bool ContactProblem::add_turning(std::span<const Contact> contacts, std::span<ProblemBody> bodies) {
  const std::size_t m = contacts.size(), t = 2 * turning_.size(), wide = padded(t);
  if (t == 0) return true;
  assemble_tangential(contacts, bodies);
  bound_turning(t);
  // M = (1 - D G_tt)^-1 D
  for (std::size_t i = 0; i < t; ++i) {
    const std::size_t pair = i / 2 * 2;
    for (std::size_t j = 0; j < t; ++j) {
      scratch_[i * t + j] = (i == j ? 1.0 : 0.0) - D_[i * t + pair] * Gtt_[pair * t + j] -
                            D_[i * t + pair + 1] * Gtt_[(pair + 1) * t + j];
      solved_[i * t + j] = D_[i * t + j];
    }
  }
  if (!solve_in_place(scratch_.data(), t, solved_.data(), t)) return false;
  for (std::size_t i = 0; i < t; ++i) {
    float* row = M_.data() + i * wide;
    std::fill(row, row + wide, 0.0f);
    for (std::size_t j = 0; j < t; ++j) row[j] = static_cast<float>(solved_[i * t + j]);
  }
  // Row by row: Gnt M, then Gnt M Gnt^T.
  std::array<float, 2 * kMostTurning> turned;
  const std::span<float> row(turned.data(), wide);
  for (std::size_t p = 0; p < m; ++p) {
    std::fill(row.begin(), row.end(), 0.0f);
    best_row_kernels().add_float_rows(M_.data(), wide, {Gnt_.data() + p * wide, t}, row);
    for (std::size_t i = 0; i < t; ++i) q_[p] += static_cast<double>(row[i]) * qt_[i];
    best_row_kernels().dots_floats(Gnt_.data(), p + 1, row, sums_.data());
    for (std::size_t other = 0; other <= p; ++other)
      W_[p * m + other] += static_cast<double>(sums_[other]);
  }
  return true;
}

// Adds to the force of each contact that turns what the turning makes of it: M times the
// displacement of its tangents, x_.
void ContactProblem::add_turned_forces(std::span<Contact> contacts) {
  const std::size_t t = 2 * turning_.size(), wide = padded(t);
  for (std::size_t i = 0; i < t; ++i) {
    double force = 0;
    for (std::size_t j = 0; j < t; ++j) force += static_cast<double>(M_[i * wide + j]) * x_[j];
    contacts[turning_[i / 2].contact].force += static_cast<float>(force) * tangent(i);
  }
}

bool ContactProblem::solve(std::span<Contact> contacts, std::span<ProblemBody> bodies,
                           const ContactStep& step, std::span<ContactFriction> rubs) {
  const std::size_t m = contacts.size();
  const std::span<double> W(W_.data(), m * m), q(q_.data(), m), f(f_.data(), m);
  residual_ = 0;
  assemble(contacts, bodies, step);
  turning_.clear();
  if (step.turning) find_turning(contacts);
  find_local_compliance(contacts, bodies);
  if (!add_turning(contacts, bodies)) return false;
  for (std::size_t p = 0; p < m; ++p) {
    W[p * m + p] += local_[p];
    f[p] = contacts[p].pressing;
  }
  rubbing_.clear();
  if (!rubs.empty()) find_rubbing(contacts, rubs);
  if (!rubbing_.empty()) return solve_with_friction(contacts, bodies, step, rubs);
  if (!complementarity_.solve(W, q, f)) return false;

  const std::size_t t = 2 * turning_.size(), wide = padded(t);
  for (std::size_t i = 0; i < t; ++i) {
    double slide = qt_[i];
    for (std::size_t p = 0; p < m; ++p) slide += static_cast<double>(Gnt_[p * wide + i]) * f[p];
    x_[i] = slide;
  }
  for (std::size_t p = 0; p < m; ++p) {
    contacts[p].pressing = f[p];
    contacts[p].force = static_cast<float>(f[p]) * contacts[p].normal;
  }
  add_turned_forces(contacts);
  if (!rubs.empty()) hand_out_friction(contacts, rubs);
  return true;
}

// --- friction

void ContactProblem::make_room_for_friction() {
  if (cone_.has_room()) return;
  const std::size_t m = q_.size(), t = 2 * kMostTurning;
  cone_.make_room(m);
  for (auto* list : {&rubbing_, &turning_at_}) list->reserve(m);
  for (auto* list : {&t1_, &t2_}) list->resize(m);
  mu_.resize(m);
  for (auto* list : {&rub_, &qf_}) list->resize(2 * m);
  Wnf_.resize(m * padded(2 * m));
  Wff_.resize(4 * m * m);
  for (auto* list : {&Gcf_, &MGcf_}) list->resize(2 * t * m);
}

// Finds the contacts that have tangents in the problem with friction: those that may rub, and those
// that turn, which are coupled with them. None if nothing rubs.
void ContactProblem::find_rubbing(std::span<const Contact> contacts,
                                  std::span<const ContactFriction> rubs_of) {
  bool any = false;
  turning_at_.resize(turning_.size());
  for (std::size_t p = 0; p < contacts.size(); ++p) {
    const ContactFriction& rub = rubs_of[static_cast<std::size_t>(contacts[p].rub)];
    const bool rubs = rub.is_anchored && rub.coefficient > 0;
    const auto turns = std::find_if(turning_.begin(), turning_.end(),
                                    [p](const Turning& one) { return one.contact == p; });
    if (!rubs && turns == turning_.end()) continue;
    any |= rubs;
    const std::size_t k = rubbing_.size();
    if (turns != turning_.end()) {
      turning_at_[static_cast<std::size_t>(turns - turning_.begin())] = k;
    }
    t1_[k] = contacts[p].normal.unitOrthogonal();
    t2_[k] = contacts[p].normal.cross(t1_[k]);
    mu_[k] = rubs ? static_cast<double>(rub.coefficient) : 0.0;
    rub_[2 * k] = static_cast<double>(contacts[p].friction.dot(t1_[k]));
    rub_[2 * k + 1] = static_cast<double>(contacts[p].friction.dot(t2_[k]));
    rubbing_.push_back(p);
  }
  if (!any) rubbing_.clear();
}

// Computes the compliance of the tangents, and the slip without forces by the tangents.
void ContactProblem::assemble_friction(std::span<const Contact> contacts,
                                       std::span<ProblemBody> bodies, const ContactStep& step,
                                       std::span<const ContactFriction> rubs) {
  const std::size_t m = contacts.size(), n = 2 * rubbing_.size(), wide = padded(n);
  for (ProblemBody& body : bodies) body.tangents.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t p = rubbing_[i / 2];
    const Contact& c = contacts[p];
    const ContactFriction& rub = rubs[static_cast<std::size_t>(c.rub)];
    const Vector3f& direction = i % 2 == 0 ? t1_[i / 2] : t2_[i / 2];
    bodies[static_cast<std::size_t>(c.body)].tangents.push_back({i, c.place, direction});
    qf_[i] = static_cast<double>(direction.dot(rub.slip));
    if (c.by < 0) continue;
    // The frame of the other body: the turn that takes the normal there is that of the pair.
    const Vector3f there = rub.to_other * direction;
    bodies[static_cast<std::size_t>(c.by)].tangents.push_back({i, c.on_foot, -there});
  }
  std::fill_n(Wnf_.begin(), m * wide, 0.0f);
  std::fill_n(Wff_.begin(), n * n, 0.0);
  for (const ProblemBody& body : bodies) {
    if (body.tangents.empty()) continue;
    body.body->add_tangential(body.tangents, step.tangent, {Wnf_.data(), m * wide}, wide,
                              {Wff_.data(), n * n}, {qf_.data(), n});
  }
}

// Adds the turning of normals to the compliance of the tangents: L M L^T with L = G_fc, and G_nc
// among the normals (add_turning()).
void ContactProblem::turn_friction(std::size_t m) {
  const std::size_t t = 2 * turning_.size(), n = 2 * rubbing_.size();
  const std::size_t wide = padded(n), wide_t = padded(t);
  if (t == 0) return;
  for (std::size_t i = 0; i < t; ++i) {
    const double* row = Wff_.data() + (2 * turning_at_[i / 2] + i % 2) * n;
    std::copy_n(row, n, Gcf_.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
  std::fill_n(MGcf_.begin(), t * n, 0.0);
  for (std::size_t i = 0; i < t; ++i) {
    for (std::size_t j = 0; j < t; ++j) {
      const auto turn = static_cast<double>(M_[i * wide_t + j]);
      if (turn == 0) continue;
      for (std::size_t l = 0; l < n; ++l) MGcf_[i * n + l] += turn * Gcf_[j * n + l];
    }
  }
  for (std::size_t i = 0; i < t; ++i) {
    const double* turned = MGcf_.data() + i * n;
    for (std::size_t l = 0; l < n; ++l) {
      qf_[l] += turned[l] * qt_[i];
      const double factor = Gcf_[i * n + l];
      for (std::size_t j = 0; j < n; ++j) Wff_[l * n + j] += factor * turned[j];
    }
    for (std::size_t p = 0; p < m; ++p) {
      const float factor = Gnt_[p * wide_t + i];
      if (factor == 0) continue;
      float* row = Wnf_.data() + p * wide;
      for (std::size_t l = 0; l < n; ++l) row[l] += factor * static_cast<float>(turned[l]);
    }
  }
}

bool ContactProblem::solve_with_friction(std::span<Contact> contacts, std::span<ProblemBody> bodies,
                                         const ContactStep& step, std::span<ContactFriction> rubs) {
  PALPABLE_EXPECT(cone_.has_room(), "make_room_for_friction() was called");
  const std::size_t m = contacts.size(), n = 2 * rubbing_.size(), wide = padded(n);
  const std::span<double> f(f_.data(), m), rub(rub_.data(), n);
  assemble_friction(contacts, bodies, step, rubs);
  turn_friction(m);
  for (std::size_t i = 0; i < n; ++i) Wff_[i * n + i] += local_[rubbing_[i / 2]];
  const ConeOutcome outcome = cone_.solve({.W = std::span<const double>(W_).first(m * m),
                                           .q = std::span<const double>(q_).first(m),
                                           .W_nt = std::span<const float>(Wnf_).first(m * wide),
                                           .wide = wide,
                                           .W_tt = std::span<const double>(Wff_).first(n * n),
                                           .q_t = std::span<const double>(qf_).first(n),
                                           .contacts = rubbing_,
                                           .mu = std::span<const double>(mu_).first(n / 2),
                                           .tolerance = step.tolerance},
                                          complementarity_, f, rub);
  if (!outcome.is_solved) return false;
  residual_ = outcome.residual;

  // The displacement of the tangents that turn.
  const std::size_t t = 2 * turning_.size(), wide_t = padded(t);
  for (std::size_t i = 0; i < t; ++i) {
    double slide = qt_[i];
    for (std::size_t p = 0; p < m; ++p) slide += static_cast<double>(Gnt_[p * wide_t + i]) * f[p];
    for (std::size_t l = 0; l < n; ++l) slide += Gcf_[i * n + l] * rub[l];
    x_[i] = slide;
  }
  for (std::size_t p = 0; p < m; ++p) {
    contacts[p].pressing = f[p];
    contacts[p].force = static_cast<float>(f[p]) * contacts[p].normal;
  }
  add_turned_forces(contacts);
  hand_out_friction(contacts, rubs);
  return true;
}

// Gives each contact its friction, of the last solution in f_ and rub_.
void ContactProblem::hand_out_friction(std::span<Contact> contacts,
                                       std::span<ContactFriction> rubs) {
  for (std::size_t p = 0; p < contacts.size(); ++p) {
    ContactFriction& rub = rubs[static_cast<std::size_t>(contacts[p].rub)];
    contacts[p].friction.setZero();
    rub.slides = false;
    rub.compliance = static_cast<float>(local_[p]);
  }
  for (std::size_t k = 0; k < rubbing_.size(); ++k) {
    if (!(mu_[k] > 0)) continue;
    Contact& c = contacts[rubbing_[k]];
    const double x = rub_[2 * k], y = rub_[2 * k + 1], bound = mu_[k] * f_[rubbing_[k]];
    c.friction = static_cast<float>(x) * t1_[k] + static_cast<float>(y) * t2_[k];
    c.force += c.friction;
    // Not std::hypot(), which differs between machines.
    const bool slides = std::sqrt(x * x + y * y) >= (1 - kAtBound) * bound;
    rubs[static_cast<std::size_t>(c.rub)].slides = slides;
  }
}

}  // namespace palpable
