/// @file
/// One frame of contact of bodies that are solved together: the steps and iterations that
/// contact_solver.h draws.
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/contact_problem.h"
#include "palpable/common/contact/near_points.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/surface_gap.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

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
  double held_back = 0;
};

/// A body, and what is near it.
struct ContactPart {
  explicit ContactPart(ContactBody& the_body);

  ContactBody* body;
  const Obstacles* obstacles = nullptr;  ///< in its frame; null: none
  NearPoints near;
  std::vector<float>
      edge_distance;             ///< (F) m, of a vertex from the nearest edge at rest, 1 at most
  std::size_t places = 0;        ///< that were added for the next step
  std::vector<PlaceLoad> loads;  ///< of these
  std::vector<Eigen::Vector3f> place_forces;  ///< likewise, N
  double penetration = 0;                     ///< m, as ContactReport, of this body
  double share_gone = 1;                      ///< of its way in the frame; less: it was held back
};

/// Contact points of one body before the skin of another.
struct SkinPair {
  int points = 0, skin = 0;  ///< bodies
  Eigen::Isometry3f skin_from_points = Eigen::Isometry3f::Identity();
  float overlap = 0;  ///< m, added to gaps: by so much they stand in each other at rest
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
  [[nodiscard]] const SkinPair& pair_of(const Contact& contact) const;
  /// Those of the frame solved last, before anything was held back.
  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }

 private:
  [[nodiscard]] ContactPart& part(int k) const { return parts_[static_cast<std::size_t>(k)]; }
  void begin(std::span<const int> members, std::span<const SkinPair> pairs);
  void add_contact(int body, int point, const SurfaceGap& gap);
  void search(double shift);
  void search_between(const SkinPair& pair);
  void take_plane(Contact& contact, const NearestOnSkin& found, const Eigen::Vector3f& from_foot,
                  const SkinPair& pair);
  void find_gap_between(Contact& contact);
  void choose_found(double shift);
  bool add_entered(double shift);
  bool find_feet_again();
  void thin(int body);
  bool add_places(const Contact& contact);
  void keep_nearest();
  void take_up(double shift, bool goes_on);
  void settle(double shift, bool last, bool goes_on, int most);
  double iterate(double shift, float share);
  bool solve_problem(double shift);
  void find_gaps(double shift);
  void find_gaps_of(int body, double shift);
  void choose_pressed(double shift);
  void go_back(float share);
  void fill_place_forces();
  void run_last_step(double shift, int most);
  void end_step(bool last);
  void end_frame(double largest_move);

  std::span<ContactPart> parts_;
  std::size_t most_;
  ContactProblem problem_;
  std::span<const int> members_;
  std::span<const SkinPair> pairs_;
  ContactLimits limits_;  // of all members
  ContactReport report_;
  double reach_ = 0;         // m: points nearer than this take part in the next iteration
  bool is_stuck_ = false;    // no step of the last iteration could be made
  bool is_entered_ = false;  // by points that do not take part

  std::vector<Contact> contacts_;
  std::vector<Contact> found_;           // all of them in the shape with which a frame begins
  std::vector<Contact> feet_before_;     // those between bodies of the round before
  std::vector<Contact> pressed_;         // those that take part in an iteration,
  std::vector<std::size_t> of_pressed_;  // and which
  std::vector<Eigen::Vector3f> forces_before_;
  std::vector<ProblemBody> bodies_;          // by their number
  std::vector<char> is_contact_;             // by point, of one body
  std::vector<int> queried_points_;          // of one body: points whose gaps are queried,
  std::vector<std::size_t> of_queried_;      // their contacts,
  std::vector<Eigen::Vector3f> queried_at_;  // positions
  std::vector<SurfaceGap> gaps_;             // and gaps
};

}  // namespace palpable
