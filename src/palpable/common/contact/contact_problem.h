/// @file
/// One iteration of Newton's method for unilateral contact: from gaps and compliance of the
/// contacts to their forces.
///
///   m  contacts     P  places of the bodies
///   N  (m x 3P) the contacts' normals; the opposite ones at the feet on other bodies
///   T  (2 for each contact with a curved obstacle, x 3P) tangential directions
///   J  the bodies' tangents, m/N (ContactBody::add_compliance())
///
///     W f + q >= 0,    f >= 0,    f_i (W f + q)_i = 0,
///     W = N J N^T + c,   q = g + N (u_free - u)
///
/// with u_free the displacement without forces by the tangent, and c the local compliance of the
/// skin under a point. A contact that slides by T du along an obstacle of curvature K has its
/// normal turned by K T du, and its force by D T du, with D = f K. Put into the equilibrium, this
/// adds
///
///     W += G_nt M G_nt^T,     M = D (1 - G_tt D)^-1,     G_nt = N J T^T, G_tt = T J T^T
///
/// With friction, T has also the tangents of the contacts that have an anchor (point_anchor.h), and
/// the conditions are extended by Coulomb's cone (coulomb_cone.h):
///
///     |t_i| <= mu_i f_i,   s' = T (x - X(a)) + q_t + W_nt^T f + W_tt t,   W_tt = T J T^T + c
///
/// The turning of normals enters all blocks: with T_c the tangents of the contacts that turn and
/// L = [N; T] J T_c^T, the compliance of [N; T] grows by L M L^T. The friction itself turns with
/// the normal one iteration later. Contacts without anchors have no friction; without any anchor
/// the problem is that without friction, to the bit.
#pragma once

#include "palpable/common/contact/complementarity.h"
#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/coulomb_cone.h"
#include "palpable/common/contact/point_anchor.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A contact point that may press an obstacle or another body.
struct Contact {
  int body = 0;                                       ///< index in the solver
  int point = 0;                                      ///< contact point of that body
  int by = -1;                                        ///< index of the other body; -1: an obstacle
  SkinPoint foot;                                     ///< on the other body
  std::size_t place = kNoPlace;                       ///< number of the point's place on `body`
  std::size_t on_foot = kNoPlace;                     ///< number of the foot's place on `by`
  float distance = 0;                                 ///< m, the gap now
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, out of the obstacle
  Eigen::Vector3f foot_normal = Eigen::Vector3f::UnitZ();  ///< the same in the frame of `by`
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();     ///< 1/m
  float softness = 0;                                      ///< SurfaceGap::softness
  double area = 0;                                         ///< m^2 that the point stands for
  double pressing = 0;                                     ///< N, normal force
  /// N, with its turning and friction; frame of `body`
  Eigen::Vector3f force = Eigen::Vector3f::Zero();
  /// m, frame of `by`: vector from the foot to the point, and the gap, when the foot was found.
  Eigen::Vector3f anchor = Eigen::Vector3f::Zero();
  float anchor_gap = 0;
  float slid = 0;  ///< m, slip along the other skin since the foot was found
  // Friction.
  float given = 0;           ///< SurfaceGap::friction
  int part = -1;             ///< SurfaceGap::part
  bool is_anchored = false;  ///< the state had an anchor for it when its places were given out
  int rub = -1;              ///< which ContactFriction of the step is its; -1: none yet
  Eigen::Vector3f friction = Eigen::Vector3f::Zero();  ///< N, t: part of `force`

  static constexpr std::size_t kNoPlace = static_cast<std::size_t>(-1);
};

/// A body of a problem.
struct ProblemBody {
  ContactBody* body = nullptr;
  std::vector<UnitForce> normals, tangents;  ///< of the present problem
};

struct ContactStep {
  double shift = 0;     ///< m, added to gaps of obstacles: how far load steps move them back
  bool turning = true;  ///< false: the turning of normals is left out
  ContactBody::Tangent tangent = ContactBody::Tangent::kFull;
  double tolerance = 0;  ///< m, of the residual of the problem with friction
};

/// Keeps the memory of its solves, which allocate nothing.
class ContactProblem {
 public:
  /// @param most  contacts of one problem
  explicit ContactProblem(int most);

  /// New forces of all contacts.
  /// @param bodies  by their number; they were linearised
  /// @return false if the problem has no solution: the forces are as before
  /// @param rubs  by Contact::rub, of all contacts; empty: without friction
  bool solve(std::span<Contact> contacts, std::span<ProblemBody> bodies, const ContactStep& step,
             std::span<ContactFriction> rubs = {});
  /// Allocates what problems with friction need. Until then there is none.
  void make_room_for_friction();
  /// m, of the last problem: ConeOutcome::residual. 0 without friction.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  struct Turning {  // a contact with a curved obstacle
    std::size_t contact = 0;
    Eigen::Vector3f t1 = Eigen::Vector3f::Zero(), t2 = Eigen::Vector3f::Zero();
  };
  void assemble(std::span<const Contact> contacts, std::span<ProblemBody> bodies,
                const ContactStep& step);
  void find_local_compliance(std::span<const Contact> contacts,
                             std::span<const ProblemBody> bodies);
  void find_turning(std::span<const Contact> contacts);
  void assemble_tangential(std::span<const Contact> contacts, std::span<ProblemBody> bodies);
  bool add_turning(std::span<const Contact> contacts, std::span<ProblemBody> bodies);
  void add_turned_forces(std::span<Contact> contacts);
  void find_rubbing(std::span<const Contact> contacts, std::span<const ContactFriction> rubs);
  void assemble_friction(std::span<const Contact> contacts, std::span<ProblemBody> bodies,
                         const ContactStep& step, std::span<const ContactFriction> rubs);
  void turn_friction(std::size_t m);
  bool solve_with_friction(std::span<Contact> contacts, std::span<ProblemBody> bodies,
                           const ContactStep& step, std::span<ContactFriction> rubs);
  void hand_out_friction(std::span<Contact> contacts, std::span<ContactFriction> rubs);
  void bound_turning(std::size_t t);
  [[nodiscard]] const Eigen::Vector3f& tangent(std::size_t i) const {
    return i % 2 == 0 ? turning_[i / 2].t1 : turning_[i / 2].t2;
  }

  Complementarity complementarity_;
  std::vector<double> W_, q_, f_;                   // (m x m), (m)
  std::vector<double> local_;                       // (m) m/N, c
  std::vector<Turning> turning_;                    // t / 2 of them
  std::vector<float> sums_;                         // (m)
  std::vector<float> Gnt_, M_;                      // (m x t), (t x t), rows padded to 16
  std::vector<double> Gtt_, D_, scratch_, solved_;  // (t x t)
  std::vector<double> qt_, x_, y_;                  // (t) free displacement; scratch

  // With friction.
  CoulombCone cone_;
  double residual_ = 0;
  std::vector<std::size_t> rubbing_;      // (k) contacts with tangents here: those that rub or turn
  std::vector<Eigen::Vector3f> t1_, t2_;  // (k) their directions
  std::vector<double> mu_, rub_;          // (k), (2k) N
  std::vector<float> Wnf_;                // (m x 2k), rows padded to 16
  std::vector<double> Wff_, qf_;          // (2k x 2k), (2k)
  std::vector<std::size_t> turning_at_;   // (t / 2) of each turning contact its place in rubbing_
  std::vector<double> Gcf_, MGcf_;        // (t x 2k)
};

}  // namespace palpable
