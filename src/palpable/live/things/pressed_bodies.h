/// @file
/// Bodies that are pressed by exact capsules instead of what a camera sees, as in a game, by a hand
/// tracker or with a haptic device.
#pragma once

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/contact/contact_frame.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/things/scene_body.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Capsules that belong together, such as those of a hand. World frame.
struct CapsuleThing {
  std::int64_t id = 0;  ///< the same in each call, whatever else presses
  std::span<const Capsule> capsules;
  /// Coulomb's coefficient between it and the skins; kFrictionOfBody: that of each body. Friction
  /// follows a thing from call to call by its id; one whose number of capsules changes begins anew.
  float friction = kFrictionOfBody;
};

/// What the bodies do to a thing.
struct ThingForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N, world frame
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< N m, about the world's origin
};

/// Keeps the state of one body or several from call to call. Several bodies press each other, too
/// (contact/contact_solver.h). A call allocates nothing if an earlier one had at least as many
/// things and capsules.
class PressedBodies {
 public:
  struct Member {
    std::shared_ptr<const TouchableBody> body;  ///< with tables of touch
    Rigid3 world_from_body = Rigid3::Identity();
    /// Coulomb's coefficient of friction of its skin; none: that of its tables
    std::optional<double> friction = {};
    /// Whether it has inertia, if its tables have vibration modes.
    bool dynamics = true;
  };
  /// @param members  at least one
  explicit PressedBodies(std::vector<Member> members);
  ~PressedBodies();
  PressedBodies(const PressedBodies&) = delete;  // one state, one owner
  PressedBodies& operator=(const PressedBodies&) = delete;

  /// @param things   whose ids differ. Touches name them by their place in this list (Touch::thing)
  /// @param shown    one for each body: shape, normals, stress and stated error are overwritten
  /// @param touches  of all bodies, overwritten, the strongest first
  /// @param time     s, since the last call; none: the static state, without inertia
  /// @return of all bodies; its left_to_move and depths are the largest
  ContactReport advance(std::span<const CapsuleThing> things, std::span<SceneBody> shown,
                        std::vector<Touch>& touches, std::optional<double> time = {});
  /// A tick, for force devices: the forces on the things alone, of one body in a fraction of the
  /// time of advance(), about a millisecond after the call before (ContactSolver::tick()). Several
  /// bodies take as long as in advance(). The next advance() goes on from here.
  /// @param things  as for advance()  @param forces  one for each, overwritten
  /// @param time    s, since the last call; 0 in the first one
  ContactReport tick(std::span<const CapsuleThing> things, std::span<ThingForce> forces,
                     double time);
  /// Of the last call of advance(): how many capsules have come out of a skin through which they
  /// passed, from outside to outside, in one call or in several. Only capsules that advance by more
  /// than their radius, or that the skin did not give way to, may do so. A thing whose number of
  /// capsules changed is left out: then it is not known which is which.
  [[nodiscard]] int passed_through() const { return passed_through_; }
  /// Sets the bodies back to rest, as if nothing had ever pressed them.
  void forget();
  /// The additional arrays that shown bodies have from now on; none at first.
  void keep(const SceneExtras& extras) { extras_ = extras; }

 private:
  struct Pressed;  // a body with its state
  // The capsules of a thing within those of a call.
  struct Run {
    std::int64_t id = 0;
    std::size_t first = 0, count = 0;
  };
  void take(std::span<const CapsuleThing> things);
  void match_capsules();
  ContactReport solve(std::optional<double> time);
  void find_touches(Pressed& body, int number);
  void add_forces(Pressed& body, std::span<ThingForce> forces);
  [[nodiscard]] double way_of_things() const;
  void follow_outside(bool is_any_inside);
  [[nodiscard]] double coefficient_of(const Touch& touch, Pressed& body) const;
  void show(Pressed& body, SceneBody& shown) const;
  [[nodiscard]] const Run* run_before(std::size_t number) const;
  // What a capsule did since it was outside of all skins.
  enum class Passage { kNone, kInto, kThrough };
  [[nodiscard]] Passage passage_of(const Capsule& before, const Capsule& now) const;
  int count_passed(bool is_any_inside);

  std::vector<std::unique_ptr<Pressed>> bodies_;
  std::optional<ContactSolver> together_;  // of several bodies
  std::vector<ContactSolver::Near> near_;
  std::vector<Capsule> capsules_;  // world frame, of this call
  // Where each was outside of the skins for the last time, up to this call and up to the last one.
  std::vector<Capsule> outside_, outside_before_;
  std::vector<Run> runs_, runs_before_;
  std::vector<int> things_;  // which thing each capsule belongs to
  // For friction: the coefficient of each capsule, and the number that each capsule of the last
  // call has in this one (-1: it is gone).
  std::vector<float> friction_;
  std::vector<int> now_of_;
  std::size_t count_before_ = 0;  // capsules of the last call
  int passed_through_ = 0;
  SceneExtras extras_;
};

}  // namespace palpable
