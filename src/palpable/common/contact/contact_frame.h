/// @file
/// One frame of contact of bodies that are solved together: the steps and iterations that
/// contact_solver.h draws.
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/contact_problem.h"
#include "palpable/common/contact/contact_search.h"
#include "palpable/common/contact/sharp_part.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// m: fine contact points may be deeper by this than those that took part, where an obstacle that a
/// camera sees is uneven.
inline constexpr double kMissed = 1e-3;

/// Whether a frame's state is that in which no obstacle is inside the skin.
enum class Reached {
  kYes,    ///< to within kReached
  kLater,  ///< not yet: this frame came nearer to it, and later ones go on
  kNot  ///< the frame came no nearer: the obstacle is sharper than the contact points, presses what
        ///< the support holds, or the skin is so deep inside that the iterations find no way out
};

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
  /// m, of the last iteration's problem with friction (ConeOutcome::residual); 0 without friction.
  double friction_residual = 0;
  double dissipated = 0;  ///< J, by friction in this frame, before the step limit
  double ringing = 0;     ///< J, ContactBody::ringing() when the frame ends
  bool stuck = false;  ///< the last iteration could make no step, so that left_to_move is not known

  // Penetration depths of obstacles into the skin, m, measured after the step limit was applied.
  // They include places at which no contact was solved: an obstacle that contains the whole body
  // has no contact point near its surface, and a needle may stand between all contact points.
  double inside_before = 0;  ///< of the contact points near obstacles, when the frame began
  double points_inside = 0;  ///< of all contact points
  double held_inside = 0;    ///< of the vertices that the support holds
  /// Of obstacles that are sharper than the contact points, and of those that the skin encloses
  /// (sharp_part.h).
  double sharp_inside = 0;

  /// m, the deepest of all.
  [[nodiscard]] double inside() const {
    return std::max({points_inside, held_inside, sharp_inside});
  }
  /// m, how far the state is from one in which nothing is inside.
  [[nodiscard]] double left() const { return std::max(left_to_move, inside()); }
  [[nodiscard]] Reached reached() const;
  /// m, how deep an obstacle is inside where contact was not solved; 0 unless that is deeper than
  /// at the contacts by more than kMissed. Then the state is not the solution for this obstacle.
  [[nodiscard]] double missed() const {
    const double deepest = std::max(points_inside, sharp_inside);
    return deepest > penetration + kMissed ? deepest : 0;
  }
  /// m, how far the state is from equilibrium: left_to_move, or missed() if that is more.
  [[nodiscard]] double unsolved() const { return std::max(left_to_move, missed()); }
};

/// Solves the contact of bodies that touch one another in one frame, by steps and iterations. The
/// bodies of a session are `parts`; those that are solved together are the members of a group
/// (ContactSolver finds the groups). Its memory is used again in each frame.
class ContactFrame {
 public:
  /// Allocates what friction needs if one of the bodies has a coefficient. Otherwise the first
  /// frame with a thing that has one of its own does.
  /// @param parts  outlive this
  /// @param most   contacts at a time, at most
  ContactFrame(std::span<ContactPart> parts, int most);

  /// @param members  indices of parts, in rising order; begin_frame() was called for their bodies
  /// @param pairs    of these members
  /// @param largest_move  m, step limit: no vertex moves farther in this frame
  /// @param time          s, since the frame before; none: nothing has inertia
  ContactReport solve(std::span<const int> members, std::span<const SkinPair> pairs,
                      double largest_move, std::optional<double> time = {});

  // Ticks: single time steps of one body, between which a frame stays open. A tick does what a step
  // of solve() does, and nothing else: shapes are formed and contacts searched only when a point
  // may have come through the band in which they were searched, or kLongestShape has passed.

  /// s, for which contacts, shapes and nonlinear terms may stay as they were found.
  static constexpr double kLongestShape = 0.008;

  /// One tick. The first one begins from the body's state, for which begin_frame() was called.
  /// @param members  one, as in the ticks before
  /// @param h        s, above 0
  /// @param way      m, no obstacle has come farther since the tick before
  ContactReport tick(std::span<const int> members, double h, double way);
  [[nodiscard]] bool ticks() const { return ticks_; }
  /// The body's state becomes that under its forces, in all parts. Another frame may follow.
  void end_ticks();
  /// The ticks ended: the body's state is another one now.
  void drop_ticks() { ticks_ = is_formed_ = false; }

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
  [[nodiscard]] static const PointForce* force_at(const ContactPart& one, int point, int by);
  void take_up(double shift, bool goes_on);
  void settle(double shift, bool last, bool goes_on, int most, bool same_places = false);
  double iterate(double shift, float share);
  bool solve_problem(double shift);
  void choose_pressed(double shift);
  [[nodiscard]] double cone_tolerance() const;
  void make_room_for_friction();
  [[nodiscard]] float friction_between(int one, int other) const;
  [[nodiscard]] float friction_of(const Contact& contact) const;
  [[nodiscard]] bool may_rub() const;
  [[nodiscard]] ContactFriction& rub_of(const Contact& contact) {
    return frictions_[static_cast<std::size_t>(contact.rub)];
  }
  [[nodiscard]] bool begins_to_press(const Contact& contact) const;
  [[nodiscard]] bool some_begin_to_press() const;
  [[nodiscard]] bool new_ones_touch(double shift);
  void begin_friction();
  void start_friction(double shift, bool goes_on);
  [[nodiscard]] ContactFriction begun_friction(const Contact& contact, double shift);
  void take_way_to_come(const Contact& contact, double shift, ContactFriction& rub) const;
  void take_anchor(const Contact& contact, double shift, ContactFriction& rub) const;
  void follow_foot(const Contact& contact);
  [[nodiscard]] Eigen::Vector3f place_now(const Contact& contact) const;
  [[nodiscard]] Eigen::Vector3f slip_of(const Contact& contact, const ContactFriction& rub) const;
  void prepare_friction(double shift);
  struct Came {
    Eigen::Vector3f way = Eigen::Vector3f::Zero();  // m, body frame
    float along = 0;                                // m, towards the body
  };
  [[nodiscard]] Came find_way(const Contact& contact, double shift, ContactFriction& rub) const;
  void make_anchor(const Contact& contact, double shift, ContactFriction& rub) const;
  void make_anchors(double shift);
  void follow(const Contact& contact, ContactFriction& rub);
  void keep_anchor(const Contact& contact, bool last);
  void keep_anchors(bool last, double shift);
  void go_back(float share);
  void fill_place_forces();
  void run_last_step(double shift, int most);
  void form_shapes(bool all);
  void end_step(double shift, bool last);
  [[nodiscard]] bool is_settled() const;
  void end_frame(double largest_move);
  void judge();
  bool find_parts(const ContactPart& one, float radius);
  [[nodiscard]] double depth_of_parts(ContactPart& one, bool may_be_enclosed);

  struct Division {
    int steps = 1;
    double shift_at_begin = 0, shift_at_end = 0;  // m
  };
  [[nodiscard]] Division divide(double depth, double largest_move);
  [[nodiscard]] double shift_in(int step, const Division& division) const;
  [[nodiscard]] int rubbing_steps() const;
  void move_obstacles(float done);
  struct OffForce {
    float distance = 0;    // m, < 0: deeper than the force holds it
    bool presses = false;  // there is a force
  };
  [[nodiscard]] OffForce off_force(const Contact& contact) const;
  [[nodiscard]] double unsolved_before();
  // Which contacts a step has. kGoesOn: those of the step before, at the same places.
  enum class Search { kAnew, kRemembered, kKept, kGoesOn };
  void find_contacts(Search search, double shift);
  void run_step(Search search, double shift, bool last);
  void run_steps(double depth, double largest_move);
  [[nodiscard]] int steps_in(double time) const;
  [[nodiscard]] bool is_anything_near() const;
  [[nodiscard]] double largest_way_of_obstacles() const;
  [[nodiscard]] double largest_way_by_inertia(double time) const;
  [[nodiscard]] bool is_off_at_begin() const;
  void watch_skin();
  void note_way_of_skin();
  [[nodiscard]] bool may_have_come(double way) const;
  [[nodiscard]] bool is_shape_due(double h, double way) const;
  void set_time_step(double h);
  void begin_without_way(std::optional<double> time);
  void run_in_time(double largest_move, double time);

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
  bool is_timed_ = false;    // bodies have inertia in this frame
  bool ticks_ = false;       // a frame is open
  // Of ticks, since contacts were searched: m that obstacles have come, and points moved; m that
  // these moved in the last tick; s
  double came_ = 0, skin_moved_ = 0, skin_moves_ = 0, searched_ = 0;
  bool is_formed_ = false;  // the shapes are those at the end of the last tick
  double left_behind_ = 0;  // m, by which obstacles are kept back in it
  double least_band_ = 0;   // m, of the members

  std::vector<Contact> pressed_;         // contacts that take part in an iteration,
  std::vector<std::size_t> of_pressed_;  // and their indices among all contacts
  std::vector<Eigen::Vector3f> forces_before_;
  // With friction.
  bool rubs_ = false;                    // something may rub in this frame
  bool leaves_out_new_ = false;          // this iteration is without the points that begin to press
  std::vector<const Obstacles*> given_;  // by part: the obstacles of the frame
  // What obstacles have come of their ways in the frame when this step ends, and when it began; and
  // the shift (m) then.
  float done_ = 1, done_before_ = 0;
  double shift_before_ = 0;
  double change_ = 0;  // m, by the iteration before; infinite in a step's first
  std::vector<ContactFriction> frictions_;         // of the contacts of a step (Contact::rub)
  std::vector<Eigen::Vector3f> frictions_before_;  // as forces_before_
  std::vector<ProblemBody> bodies_;                // by their number
  std::vector<SharpPart> parts_near_;              // of obstacles near one body
};

}  // namespace palpable
