/// @file
/// One frame of contact of bodies that are solved together: the steps and iterations that
/// contact_solver.h draws.
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/contact_problem.h"
#include "palpable/common/contact/contact_search.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// How a frame went, of all bodies, or of one and those that were solved with it.
struct ContactReport {
  int candidates = 0;             ///< contact points near an obstacle or another skin
  int dropped = 0;                ///< of these, dropped for lack of room
  int steps = 0;                  ///< in which obstacles advanced
  int rounds = 0;                 ///< of the last step, each begun by a search for contacts
  int iterations = 0;             ///< of Newton's method, in all steps
  double last_change = 0;         ///< m, largest displacement of a point in the last iteration
  double penetration = 0;         ///< m, of obstacles at the deepest contact point
  double mutual_penetration = 0;  ///< m, of bodies into each other, at contact points with force
  double imbalance = 0;           ///< N, norm of the sum of all forces between bodies; 0 in theory
  /// m that a vertex has yet to move: beyond the step limit, or by the last iteration if the
  /// iterations have not converged.
  double left_to_move = 0;
};

/// Solves the contact of bodies that touch one another in one frame, by steps and iterations. The
/// bodies of a session are `parts`; those that are solved together are the members of a group
/// (ContactSolver finds the groups). Its memory is used again in each frame.
class ContactFrame {
 public:
  /// @param parts  outlive this
  /// @param most   contacts at a time, at most
  ContactFrame(std::span<ContactPart> parts, int most);

  /// @param members  indices of parts, in rising order; begin_frame() was called for their bodies
  /// @param pairs    of these members
  /// @param largest_move  m, step limit: no vertex moves farther in this frame
  ContactReport solve(std::span<const int> members, std::span<const SkinPair> pairs,
                      double largest_move);

  /// The pair of a contact between bodies.
  [[nodiscard]] const SkinPair& pair_of(const Contact& contact) const {
    return search_.pair_of(contact);
  }
  /// The contacts of the frame solved last, before the step limit.
  [[nodiscard]] std::span<const Contact> contacts() const { return search_.contacts(); }

 private:
  [[nodiscard]] ContactPart& part(int k) const { return parts_[static_cast<std::size_t>(k)]; }
  void begin(std::span<const int> members, std::span<const SkinPair> pairs);
  void find_places();
  void take_up(double shift, bool goes_on);
  void settle(double shift, bool last, bool goes_on, int most);
  double iterate(double shift, float share);
  bool solve_problem(double shift);
  void choose_pressed(double shift);
  void go_back(float share);
  void fill_place_forces();
  void run_last_step(double shift, int most);
  void end_step(bool last);
  void end_frame(double largest_move);

  std::span<ContactPart> parts_;
  std::size_t most_;
  ContactSearch search_;
  ContactProblem problem_;
  std::span<const int> members_;
  std::span<const SkinPair> pairs_;
  ContactLimits limits_;  // of all members
  ContactReport report_;
  double reach_ = 0;         // m: points nearer than this take part in the next iteration
  bool is_stuck_ = false;    // the last iteration could make no step
  bool is_entered_ = false;  // points that do not take part entered an obstacle

  std::vector<Contact> pressed_;         // contacts that take part in an iteration,
  std::vector<std::size_t> of_pressed_;  // and their indices among all contacts
  std::vector<Eigen::Vector3f> forces_before_;
  std::vector<ProblemBody> bodies_;  // by their number
};

}  // namespace palpable
