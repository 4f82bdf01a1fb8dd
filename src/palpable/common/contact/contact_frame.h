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
  int candidates = 0;      ///< contact points near something
  int dropped = 0;         ///< more of them than there is room for
  int steps = 0;           ///< in which obstacles advanced
  int rounds = 0;          ///< of the last step, each begun by a search for contacts
  int iterations = 0;      ///< of Newton's method in all
  double last_change = 0;  ///< m, of a point in the last iteration
  double penetration = 0;  ///< m, of obstacles at the deepest contact point
  double between = 0;      ///< m, of bodies into each other, at the points that press
  double imbalance = 0;    ///< N, of the forces between bodies: what does not cancel out
  /// m, that a vertex has yet to move: beyond the largest move of a frame, or by the last iteration
  /// where iterations have not converged.
  double left_to_move = 0;
};

/// Its memory is used again in each frame.
class ContactFrame {
 public:
  /// @param parts  outlive this
  /// @param most   contacts at a time
  ContactFrame(std::span<ContactPart> parts, int most);

  /// @param members  indices of parts, rising; their frames were begun
  /// @param pairs    of these members
  /// @param largest_move  m, see ContactSolver
  ContactReport solve(std::span<const int> members, std::span<const SkinPair> pairs,
                      double largest_move);

  /// The pair of a contact between bodies.
  [[nodiscard]] const SkinPair& pair_of(const Contact& contact) const {
    return search_.pair_of(contact);
  }
  /// Those of the frame solved last, before anything was held back.
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
  bool is_stuck_ = false;    // no step of the last iteration could be made
  bool is_entered_ = false;  // by points that do not take part

  std::vector<Contact> pressed_;         // those that take part in an iteration,
  std::vector<std::size_t> of_pressed_;  // and which
  std::vector<Eigen::Vector3f> forces_before_;
  std::vector<ProblemBody> bodies_;  // by their number
};

}  // namespace palpable
