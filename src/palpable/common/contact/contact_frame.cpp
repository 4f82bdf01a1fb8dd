#include "palpable/common/contact/contact_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Largest number of times that an iteration that moves a point too far is halved.
constexpr int kHalvings = 6;
// Ratio to ContactLimits::largest_step: the smallest gap that leaves a point out where
// ContactLimits::narrows.
constexpr double kLeastReach = 0.02;
// Largest number of searches in the last step of a frame. With fewer, points that the solution
// moved into an obstacle, and feet that have slid, are corrected only in the next frame.
constexpr int kRounds = 3;
// Ratio to ContactLimits::largest_step: if the last iteration moved a point farther, the solution
// has not converged. The bodies then move by kUnsettledSteps largest steps at most.
constexpr double kUnsettled = 0.4;
constexpr int kUnsettledSteps = 3;
// Smallest share of an iteration that damping (ContactLimits::damped) leaves.
constexpr float kLeastShare = 0.25f;
// Largest number of sharp parts of obstacles near a body that are judged.
constexpr std::size_t kMostSharpParts = 4096;

// A frame has come nearer to its solution if obstacles are less deep inside than before by this
// share of what is left, or by this much, m.
constexpr double kNearerShare = 0.1, kNearer = 0.005;

// The residual, m, that the problem with friction may keep: this share of how far the iteration
// before moved a point, but at least kTightCone and at most kLooseCone times
// ContactLimits::tolerance.
constexpr double kConeOfChange = 0.01, kTightCone = 0.05, kLooseCone = 0.5;
// Ratio to ContactLimits::tolerance: a point that was left out and is inside by less does not
// touch. Under a finger that rests, points beside it are inside by rounding errors.
constexpr double kTouches = 0.1;

// With friction a frame is divided so that in no step an obstacle turns the normal of a pressing
// point by more than this, rad, but into kMostRubbingSteps at most. If a rim moved aside by its
// radius in one step, the points under it would lose contact and friction, and other points would
// be anchored instead. A finger that moves by 1 mm needs one step.
constexpr float kTurnInStep = 0.35f;
constexpr int kMostRubbingSteps = 3;
constexpr float kSharpest = 0.001f;  // m, the smallest radius that is looked after here

// Ratio to ContactLimits::band: with less than 1 no point that was farther away can be inside.
constexpr double kSearchAgain = 0.9;

// Ratio of how far the skin beside the contact points of a tick may move to how far these moved.
constexpr float kBesidePoints = 1.5f;

// m: skin that was farther away when contacts were searched does not come into their band before
// they are searched again.
constexpr float kWatched = 0.012f;

// Steps into which the way of obstacles divides a frame, at most.
constexpr double kMostOfObstacles = 64;

// s. After a longer pause it is not known how obstacles came.
constexpr double kLongestTime = 0.125;

// m, gap of a contact in a load step, in which obstacles stand back by `shift`, m.
float gap_in_step(const Contact& c, double shift) {
  return c.distance + static_cast<float>(c.by < 0 ? shift : 0.0);
}

// Share of a step after which a contact's point met what it presses. @param came  m, by which that
// came nearer in the step
float time_of_meeting(const Contact& c, const ContactFriction& rub, float came, double shift) {
  if (c.force.isZero(0)) return time_of_contact(rub.gap + came, gap_in_step(c, shift));
  // It presses already. If no gap was queried yet, it did so before the step, without an anchor.
  // Else others have pushed it there in this step, and it counts as met where it is.
  return rub.has_gap ? 1.0f : 0.0f;
}

}  // namespace

Reached ContactReport::reached() const {
  if (stuck) return Reached::kNot;
  if (left() <= kReached) return Reached::kYes;
  if (std::max(held_inside, sharp_inside) > std::max(points_inside, kReached)) return Reached::kNot;
  if (points_inside <= kReached) return Reached::kLater;  // only the way of the skin is left
  // Iterations that find no way out move the skin to and fro by some mm.
  const double enough = std::max(kReached, std::min(kNearerShare * points_inside, kNearer));
  return inside_before - points_inside >= enough ? Reached::kLater : Reached::kNot;
}

ContactFrame::ContactFrame(std::span<ContactPart> parts, int most)
    : parts_(parts),
      most_(static_cast<std::size_t>(most)),
      search_(parts, most),
      problem_(most),
      given_(parts.size()),
      bodies_(parts.size()) {
  for (std::size_t k = 0; k < parts.size(); ++k) {
    ContactPart& part = parts[k];
    bodies_[k].body = part.body;
    bodies_[k].normals.reserve(most_);
    bodies_[k].tangents.reserve(most_);
    part.loads.reserve(most_ + 1);
    part.place_forces.reserve(most_ + 1);
    // A body makes its surface when that is first queried: now, so that no frame allocates it.
    if (!part.body->contact_points().points.empty()) static_cast<void>(part.body->surface());
  }
  const bool any_rubs = std::any_of(
      parts.begin(), parts.end(), [](const ContactPart& one) { return one.body->friction() > 0; });
  if (any_rubs) make_room_for_friction();
  parts_near_.reserve(kMostSharpParts);
  pressed_.reserve(most_);
  of_pressed_.reserve(most_);
  forces_before_.resize(most_);
}

void ContactFrame::begin(std::span<const int> members, std::span<const SkinPair> pairs) {
  members_ = members;
  pairs_ = pairs;
  report_ = {};
  limits_ = {};
  limits_.largest_step = limits_.tolerance = limits_.largest_change = least_band_ =
      std::numeric_limits<double>::infinity();
  for (const int k : members) {
    if (part(k).body->contact_points().points.empty()) continue;
    const ContactLimits& one = part(k).body->limits();
    limits_.band = std::max(limits_.band, one.band);
    least_band_ = std::min(least_band_, one.band);
    limits_.largest_step = std::min(limits_.largest_step, one.largest_step);
    limits_.most_steps = std::max(limits_.most_steps, one.most_steps);
    limits_.iterations = std::max(limits_.iterations, one.iterations);
    limits_.last_iterations = std::max(limits_.last_iterations, one.last_iterations);
    limits_.tolerance = std::min(limits_.tolerance, one.tolerance);
    limits_.largest_change = std::min(limits_.largest_change, one.largest_change);
    limits_.damped &= one.damped;
    limits_.narrows |= one.narrows;
  }
  for (const int k : members) given_[static_cast<std::size_t>(k)] = part(k).obstacles;
  search_.begin(members, pairs, limits_);
  rubs_ = may_rub();
  if (rubs_) {
    begin_friction();
  } else {
    for (const int k : members) part(k).body->anchors().clear();
  }
}

// Gives contacts places, and drops those for which there is no room.
void ContactFrame::find_places() {
  report_.dropped += search_.keep_nearest();
  report_.candidates = std::max(report_.candidates, static_cast<int>(search_.contacts().size()));
}

// --- iterations

// The force of the state at a contact point of a part; null: none.
const PointForce* ContactFrame::force_at(const ContactPart& one, int point, int by) {
  const std::vector<PointForce>& forces = one.body->forces();
  const PointForce wanted{point, {}, by};
  const auto at = std::lower_bound(forces.begin(), forces.end(), wanted, stands_before);
  return at == forces.end() || stands_before(wanted, *at) ? nullptr : &*at;
}

// Gives the contacts the forces of the states, and numbers their places. A force at a point that is
// no longer a contact is dropped. @param goes_on  the contacts keep the forces of the round before
void ContactFrame::take_up(double shift, bool goes_on) {
  for (const int k : members_) {
    part(k).loads.assign(part(k).places, {});
    part(k).places = 0;
  }
  for (Contact& c : search_.contacts()) {
    ContactPart& one = part(c.body);
    const PointForce* at = force_at(one, c.point, c.by);
    if (!goes_on && at != nullptr) {
      c.force = at->force;
      c.friction = at->friction;
      c.pressing = std::max(0.0, static_cast<double>(at->force.dot(c.normal)));
    } else if (!goes_on && rubs_) {
      // The step begins again: a point that only pressed in the round before is where it was.
      c.force = c.friction = Vector3f::Zero();
      c.pressing = 0;
    }
    const float entry = std::max(0.0f, -gap_in_step(c, shift));
    c.place = one.places++;
    one.loads[c.place] = {c.force, entry};
    if (c.by < 0) continue;
    ContactPart& other = part(c.by);
    c.on_foot = other.places++;
    other.loads[c.on_foot] = {-(pair_of(c).skin_from_points.linear() * c.force), entry};
  }
}

// Iterates until the contacts' forces and gaps are complementary, at most `most` times.
// @param same_places  as in the step before
void ContactFrame::settle(double shift, bool last, bool goes_on, int most, bool same_places) {
  take_up(shift, goes_on);
  for (const int k : members_) {
    if (same_places) {
      part(k).body->go_on(part(k).loads);
    } else {
      part(k).body->begin_step(part(k).loads, last);
    }
  }
  if (rubs_) start_friction(shift, goes_on);
  // The first iteration is one without the points that begin to press: where it moves them tells
  // where each first met what it presses (make_anchor()).
  const int first = rubs_ && !goes_on && most > 1 && some_begin_to_press() ? 1 : 0;
  float share = 1;
  reach_ = change_ = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most; ++i) {
    ++report_.iterations;
    leaves_out_new_ = i < first;
    const double change = iterate(shift, share);
    // Two sets of points that press in turn would alternate for ever.
    if (limits_.damped && i > first && change > report_.last_change) {
      share = std::max(kLeastShare, 0.5f * share);
    }
    report_.last_change = change_ = change;
    if (change < limits_.tolerance && !(leaves_out_new_ && new_ones_touch(shift))) break;
    reach_ = std::max(kLeastReach * limits_.largest_step, change);
  }
  if (rubs_) make_anchors(shift);
}

// Chooses the contacts of an iteration: those that press, or may press after it.
void ContactFrame::choose_pressed(double shift) {
  pressed_.clear();
  of_pressed_.clear();
  double way = ContactSearch::kTakesPart * limits_.largest_step;
  if (limits_.narrows) way = std::min(way, reach_);
  for (std::size_t k = 0; k < search_.contacts().size(); ++k) {
    Contact& c = search_.contacts()[k];
    forces_before_[k] = c.force;
    if (rubs_) frictions_before_[k] = c.friction;
    if (leaves_out_new_ && begins_to_press(c)) continue;
    const auto reach = static_cast<float>(way - (c.by < 0 ? shift : 0.0));
    if (!(c.distance < reach) && c.force.isZero(0)) continue;
    pressed_.push_back(c);
    of_pressed_.push_back(k);
  }
}

// Computes new forces of the contacts that take part. In an intermediate state the full tangent may
// not be positive definite; without the terms that can cause this the step is shorter but still
// right.
bool ContactFrame::solve_problem(double shift) {
  using Tangent = ContactBody::Tangent;
  const auto solve = [&](bool turning, Tangent tangent) {
    return problem_.solve(pressed_, bodies_, {shift, turning, tangent, cone_tolerance()},
                          rubs_ ? std::span(frictions_) : std::span<ContactFriction>());
  };
  if (!solve(true, Tangent::kFull) && !solve(false, Tangent::kFull) &&
      !solve(false, Tangent::kSafe)) {
    return false;
  }
  for (std::size_t k = 0; k < of_pressed_.size(); ++k)
    search_.contacts()[of_pressed_[k]] = pressed_[k];
  return true;
}

// Reduces the change of the forces in this iteration to a share of it.
void ContactFrame::go_back(float share) {
  for (std::size_t k = 0; k < search_.contacts().size(); ++k) {
    Contact& c = search_.contacts()[k];
    c.force = share * c.force + (1 - share) * forces_before_[k];
    if (rubs_) c.friction = share * c.friction + (1 - share) * frictions_before_[k];
    c.pressing = std::max(0.0, static_cast<double>(c.force.dot(c.normal)));
  }
}

void ContactFrame::fill_place_forces() {
  for (const int k : members_) part(k).place_forces.assign(part(k).loads.size(), Vector3f::Zero());
  for (const Contact& c : search_.contacts()) {
    part(c.body).place_forces[c.place] = c.force;
    if (c.by < 0) continue;
    part(c.by).place_forces[c.on_foot] = -(pair_of(c).skin_from_points.linear() * c.force);
  }
}

// A share of one step of Newton's method. Returns how far it moved a point, m.
double ContactFrame::iterate(double shift, float share) {
  search_.find_gaps(shift);
  if (rubs_) prepare_friction(shift);
  choose_pressed(shift);
  is_stuck_ = true;
  for (const int k : members_) {
    if (!part(k).body->linearise()) return 0;
  }
  if (!solve_problem(shift)) return 0;
  fill_place_forces();
  for (const int k : members_) part(k).body->find_step(part(k).place_forces);
  if (share < 1) go_back(share);
  double gone = static_cast<double>(share);
  for (int halving = 0; halving <= kHalvings; ++halving) {
    fill_place_forces();
    double moved = 0;
    for (const int k : members_) {
      moved = std::max(moved, part(k).body->move(part(k).place_forces, gone));
    }
    if (static_cast<float>(moved) <= static_cast<float>(limits_.largest_change)) {
      is_stuck_ = halving == kHalvings;
      return moved;
    }
    // The last halving takes the whole step back: a state too far away would not be a valid one.
    const float part_of_step = halving + 1 < kHalvings ? 0.5f : 0.0f;
    go_back(part_of_step);
    gone *= static_cast<double>(part_of_step);
  }
  return 0;
}

// --- friction

// m, residual that the present iteration's problem with friction may have. One that is followed by
// others is not solved to the end.
double ContactFrame::cone_tolerance() const {
  return std::clamp(kConeOfChange * change_, kTightCone * limits_.tolerance,
                    kLooseCone * limits_.tolerance);
}

void ContactFrame::make_room_for_friction() {
  problem_.make_room_for_friction();
  frictions_.reserve(static_cast<std::size_t>(kRounds) * most_);  // rounds that go on add to them
  frictions_before_.resize(most_);
  for (ProblemBody& body : bodies_) body.tangents.reserve(2 * most_);
}

// Coulomb's coefficient between two bodies: the root of the product of both, so that a body without
// friction rubs no other one.
float ContactFrame::friction_between(int one, int other) const {
  return static_cast<float>(
      palpable::friction_between(part(one).body->friction(), part(other).body->friction()));
}

float ContactFrame::friction_of(const Contact& contact) const {
  if (contact.by >= 0) return friction_between(contact.body, contact.by);
  return friction_coefficient(contact.given,
                              static_cast<float>(part(contact.body).body->friction()));
}

bool ContactFrame::may_rub() const {
  const bool by_obstacles = std::any_of(members_.begin(), members_.end(), [this](int k) {
    const Obstacles* obstacles = part(k).obstacles;
    return obstacles != nullptr &&
           obstacles->largest_friction(static_cast<float>(part(k).body->friction())) > 0;
  });
  return by_obstacles || std::any_of(pairs_.begin(), pairs_.end(), [this](const SkinPair& pair) {
           return friction_between(pair.points, pair.skin) > 0;
         });
}

// Moves the anchors of the states with the obstacles, and forgets those of obstacles that are gone.
void ContactFrame::begin_friction() {
  make_room_for_friction();
  for (const int k : members_) {
    std::vector<PointAnchor>& anchors = part(k).body->anchors();
    // Those of the points that press now, and of those that pressed when the frame began.
    anchors.reserve(2 * most_);
    std::size_t kept = 0;
    for (PointAnchor& anchor : anchors) {
      anchor.way.setZero();
      if (anchor.by < 0) {
        const Obstacles* obstacles = part(k).obstacles;
        if (obstacles == nullptr) continue;
        const auto now = obstacles->carried({anchor.part, anchor.place});
        if (!now) continue;
        anchor.way = now->place - anchor.place;
        anchor.place = now->place;
        anchor.part = now->part;
      }
      anchors[kept++] = anchor;
    }
    anchors.resize(kept);
  }
}

// The place of a contact's point: in the body's frame; of a contact between bodies from its foot,
// in the other body's frame.
Vector3f ContactFrame::place_now(const Contact& c) const {
  const Vector3f x = part(c.body).body->position(c.place);
  if (c.by < 0) return x;
  return pair_of(c).skin_from_points * x - part(c.by).body->position(c.on_foot);
}

Vector3f ContactFrame::slip_of(const Contact& c, const ContactFriction& rub) const {
  if (!rub.is_anchored) return Vector3f::Zero();
  const Vector3f slip = place_now(c) - rub.held;
  if (c.by < 0) return slip;
  return rub.to_other.transpose() * slip;
}

// Whether a contact may press in this step and did not before it.
bool ContactFrame::begins_to_press(const Contact& c) const {
  return c.force.isZero(0) && !frictions_[static_cast<std::size_t>(c.rub)].is_anchored;
}

// Whether some contacts begin to press, beside others that pressed before.
bool ContactFrame::some_begin_to_press() const {
  bool some = false, others = false;
  for (const Contact& c : search_.contacts()) (begins_to_press(c) ? some : others) = true;
  return some && others;
}

// Whether a point that was left out of an iteration entered what it may press.
bool ContactFrame::new_ones_touch(double shift) {
  search_.find_gaps(shift);
  const auto inside = static_cast<float>(-kTouches * limits_.tolerance);
  return std::any_of(search_.contacts().begin(), search_.contacts().end(), [&](const Contact& c) {
    return begins_to_press(c) && gap_in_step(c, shift) < inside;
  });
}

// Gives each contact of a step its friction: the anchor of the state, where the obstacle is in this
// step. In a round that goes on, only the contacts that were found since.
void ContactFrame::start_friction(double shift, bool goes_on) {
  if (!goes_on) frictions_.clear();
  for (Contact& c : search_.contacts()) {
    if (goes_on && c.rub >= 0) {
      follow_foot(c);
      continue;
    }
    c.rub = static_cast<int>(frictions_.size());
    frictions_.push_back(begun_friction(c, shift));
  }
}

// A contact between bodies whose foot is another one now: its vectors are measured from there.
void ContactFrame::follow_foot(const Contact& c) {
  if (c.by < 0) return;
  ContactBody& other = *part(c.by).body;
  ContactFriction& rub = rub_of(c);
  const Vector3f from_new = other.shape_at(rub.foot) - other.shape_at(c.foot);
  rub.held += from_new;
  rub.begun += from_new;
  rub.foot = c.foot;
}

ContactFriction ContactFrame::begun_friction(const Contact& c, double shift) {
  ContactFriction rub;
  rub.foot = c.foot;
  if (c.by >= 0) rub.to_other = pair_of(c).skin_from_points.linear();
  rub.begun = place_now(c);
  rub.coefficient = friction_of(c);
  if (!(rub.coefficient > 0)) return rub;
  rub.number = number_of_anchor(part(c.body).body->anchors(), c.point, c.by);
  if (rub.number >= 0) {
    take_anchor(c, shift, rub);
  } else if (!c.force.isZero(0) && done_ > 0) {
    // It pressed without friction, or another obstacle that is gone: held from where it is.
    make_anchor(c, shift, rub);
  }
  return rub;
}

// What the obstacle of a contact has yet to come after this step of its way in the frame.
void ContactFrame::take_way_to_come(const Contact& c, double shift, ContactFriction& rub) const {
  rub.to_come = (1 - done_) * rub.anchor.way;
  const float along = std::max(0.0f, rub.anchor.way.dot(c.normal));
  rub.is_farther_back = static_cast<float>(shift) > done_ * along;
}

// Takes over the anchor of the state.
void ContactFrame::take_anchor(const Contact& c, double shift, ContactFriction& rub) const {
  rub.anchor = part(c.body).body->anchors()[static_cast<std::size_t>(rub.number)];
  rub.is_anchored = true;
  if (c.by < 0) {
    take_way_to_come(c, shift, rub);
    rub.held = rub.anchor.place - rub.to_come;
  } else {
    ContactBody& other = *part(c.by).body;
    rub.held = other.shape_at(rub.anchor.on) + rub.anchor.place - other.shape_at(c.foot);
  }
}

// Before an iteration: coefficients and gaps are those of what is nearest now, slips those at the
// present positions. Points that are about to press get their anchors.
void ContactFrame::prepare_friction(double shift) {
  for (const Contact& c : search_.contacts()) {
    ContactFriction& rub = rub_of(c);
    rub.coefficient = friction_of(c);
    if (rub.has_gap) continue;
    rub.gap = gap_in_step(c, shift);
    rub.has_gap = true;
  }
  if (!leaves_out_new_) make_anchors(shift);
  for (const Contact& c : search_.contacts()) {
    ContactFriction& rub = rub_of(c);
    rub.slip = slip_of(c, rub);
  }
}

// The motion in this step of what a contact presses. Where it is not known, it counts as one along
// the normal, by as much as the shift became smaller. Another body counts as standing, because its
// contacts are measured from it.
ContactFrame::Came ContactFrame::find_way(const Contact& c, double shift,
                                          ContactFriction& rub) const {
  Came came;
  if (c.by >= 0) return came;
  rub.anchor.part = c.part;
  const auto way = part(c.body).obstacles->way_of({c.part, place_now(c)});
  if (!way) {
    came.along = static_cast<float>(shift_before_ - shift);
    return came;
  }
  rub.anchor.way = *way / done_;  // obstacles of this step have come so far
  take_way_to_come(c, shift, rub);
  came.way = (done_ - done_before_) * rub.anchor.way;
  came.along = came.way.dot(c.normal);
  return came;
}

// Anchors a contact where its point first met what it presses; from there the anchor came with it.
//
//     x0  where the point was when the step began, g0 its gap then
//     x   where it is at the end without a force of its own, g < 0 its gap there
//     x0 + tau (x - x0),  tau = g0 / (g0 - g)     where it met, on straight ways of both
//
// x is that of the step's first iteration, in which only those take part that pressed before; it
// replaces one in which new points pressed without friction, and costs no more. A point that
// presses is dragged along from the moment it is met, so its place at the end of the step is not
// one to which it would have come freely.
void ContactFrame::make_anchor(const Contact& c, double shift, ContactFriction& rub) const {
  rub.anchor = {};
  rub.anchor.point = c.point;
  rub.anchor.by = c.by;
  const Came came = find_way(c, shift, rub);
  const Vector3f x = place_now(c);
  const float met = time_of_meeting(c, rub, came.along, shift);
  rub.held = rub.begun + met * (x - rub.begun) + (1 - met) * came.way;
  rub.is_anchored = rub.is_new = true;
}

// Anchors the contacts that press, or are about to because they are inside, and have no anchor.
void ContactFrame::make_anchors(double shift) {
  if (!(done_ > 0)) return;  // a correction: what presses new sticks where the way begins
  for (const Contact& c : search_.contacts()) {
    ContactFriction& rub = rub_of(c);
    if (rub.is_anchored || !(rub.coefficient > 0)) continue;
    if (gap_in_step(c, shift) < 0 || !c.force.isZero(0)) make_anchor(c, shift, rub);
  }
}

// Lets the anchor of a point that slides follow it.
void ContactFrame::follow(const Contact& c, ContactFriction& rub) {
  const Vector3f force = c.by < 0 ? c.friction : Vector3f(rub.to_other * c.friction);
  const Vector3f normal = c.by < 0 ? c.normal : c.foot_normal;
  Vector3f way = place_now(c) + rub.compliance * force - rub.held;
  way -= way.dot(normal) * normal;
  // A way along the friction would be one that the last iteration did not foresee: the point begins
  // to stick.
  const float lost = -way.dot(force);
  rub.slides = lost > 0;
  if (!rub.slides) return;
  report_.dissipated += static_cast<double>(lost);
  rub.held += way;
}

// Hands the anchor of a contact that presses to the state.
void ContactFrame::keep_anchor(const Contact& c, bool last) {
  ContactFriction& rub = rub_of(c);
  // After an iteration that was taken back, what slides is that of the solution that was rejected.
  if (is_stuck_) rub.slides = false;
  if (rub.slides) follow(c, rub);
  if ((rub.slides || rub.is_new) && c.by < 0) {
    // In the plane through the point, so that a turn of the obstacle moves it along the skin.
    rub.held += c.normal.dot(place_now(c) - rub.held) * c.normal;
    rub.anchor.place = rub.held + rub.to_come;
  } else if (rub.slides || rub.is_new) {
    rub.anchor.on = c.foot;
    rub.anchor.place = rub.held;
  }
  // From now on it goes with the part that presses its point: the one from which that came may be
  // gone in the next frame.
  if (last && c.by < 0) rub.anchor.part = c.part;
  rub.anchor.presses = true;
  std::vector<PointAnchor>& anchors = part(c.body).body->anchors();
  if (rub.number >= 0) {
    anchors[static_cast<std::size_t>(rub.number)] = rub.anchor;
  } else if (anchors.size() < anchors.capacity()) {
    anchors.push_back(rub.anchor);
  }
}

// Hands the anchors to the states. A shift moves all obstacles back, those too that stand still:
// points that lose contact by it keep their anchors until the last step, and points that press an
// obstacle that is farther back than when the frame began keep them as they were.
void ContactFrame::keep_anchors(bool last, double shift) {
  const bool is_final = last || !(shift > 0);
  for (const int k : members_) {
    for (PointAnchor& anchor : part(k).body->anchors()) anchor.presses = false;
  }
  for (const Contact& c : search_.contacts()) {
    if (!(c.pressing > 0)) continue;
    const ContactFriction& rub = rub_of(c);
    if (!rub.is_anchored || !(rub.coefficient > 0)) continue;
    if (last || rub.number < 0 || !rub.is_farther_back) keep_anchor(c, last);
  }
  for (const int k : members_) {
    std::vector<PointAnchor>& anchors = part(k).body->anchors();
    if (is_final) std::erase_if(anchors, [](const PointAnchor& anchor) { return !anchor.presses; });
    std::sort(anchors.begin(), anchors.end(), anchored_before);
  }
}

// --- steps

// Solves, forms the shapes, and searches again until no new contact is found.
void ContactFrame::run_last_step(double shift, int most) {
  bool goes_on = false;
  for (int round = 0;; ++round) {
    report_.rounds = round + 1;
    // With other bodies each search may change many contacts, so it gets iterations of its own.
    if (!pairs_.empty()) most = report_.iterations + limits_.last_iterations;
    settle(shift, true, goes_on, most - report_.iterations);
    form_shapes(true);
    const bool may_go_on = round + 1 < kRounds && (report_.iterations < most || !pairs_.empty());
    const bool slid = may_go_on && search_.find_feet_again();
    const bool entered = search_.add_entered(shift);
    if (!entered && !slid) return;
    find_places();
    if (!may_go_on) {
      is_entered_ = true;
      return;
    }
    // Slid feet change the solution little, so the next round starts from its forces; a skin that
    // entered an obstacle has moved too far, so it starts again from the state.
    goes_on = !entered;
  }
}

void ContactFrame::form_shapes(bool all) {
  for (const int k : members_) part(k).body->form_shape(all);
}

// Hands forces and displacements to the states of the bodies.
void ContactFrame::end_step(double shift, bool last) {
  // Contacts that entered last and were not solved have no place.
  std::erase_if(search_.contacts(), [](const Contact& c) { return c.place == Contact::kNoPlace; });
  if (last) search_.find_gaps(0);
  report_.penetration = report_.mutual_penetration = 0;
  for (const int k : members_) {
    part(k).body->forces().clear();
    part(k).penetration = 0;
  }
  for (const Contact& c : search_.contacts()) {
    const double depth = -static_cast<double>(c.distance);
    double& deepest = c.by < 0 ? part(c.body).penetration : report_.mutual_penetration;
    if (c.by < 0 || c.pressing > 0) deepest = std::max(deepest, depth);
    if (c.pressing > 0) part(c.body).body->forces().push_back({c.point, c.force, c.by, c.friction});
  }
  if (rubs_) keep_anchors(last, shift);
  for (const int k : members_) {
    std::vector<PointForce>& forces = part(k).body->forces();
    std::sort(forces.begin(), forces.end(), stands_before);
    report_.penetration = std::max(report_.penetration, part(k).penetration);
    const bool is_free = report_.last_change < limits_.tolerance &&
                         std::none_of(search_.contacts().begin(), search_.contacts().end(),
                                      [k](const Contact& c) { return c.body == k || c.by == k; });
    part(k).body->keep(is_free);
  }
  done_before_ = done_;
  shift_before_ = shift;
}

// Whether the last step's iterations have converged.
bool ContactFrame::is_settled() const {
  return !is_stuck_ && !is_entered_ && report_.last_change <= kUnsettled * limits_.largest_step;
}

// Applies the step limit to each body; the rest of its displacement is left to later frames.
void ContactFrame::end_frame(double largest_move) {
  for (const int k : members_) part(k).body->end_frame(part(k).penetration);
  const bool settled = is_settled();
  report_.stuck = is_stuck_;
  // Inertia limits what moves; what obstacles entered by no motion of theirs stays behind them.
  if (is_timed_) {
    largest_move = std::numeric_limits<double>::infinity();
    report_.left_to_move = left_behind_;
  }
  if (!settled) {
    largest_move = std::min(largest_move, kUnsettledSteps * limits_.largest_step);
    report_.left_to_move = report_.last_change;
  }
  for (const int k : members_) {
    const double moved = part(k).body->moved();
    part(k).share_gone = moved > largest_move ? largest_move / moved : 1;
    report_.left_to_move = std::max(report_.left_to_move, moved - largest_move);
  }
  // Bodies that press each other are limited to the same share, so that their forces stay
  // opposite.
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (const Contact& c : search_.contacts()) {
      if (c.by < 0 || !(c.pressing > 0)) continue;
      double &one = part(c.body).share_gone, &other = part(c.by).share_gone;
      is_new |= one != other;
      one = other = std::min(one, other);
    }
  }
  for (const int k : members_) {
    if (part(k).share_gone < 1) part(k).body->limit_step(part(k).share_gone);
  }
  if (rubs_) report_.friction_residual = problem_.residual();
  for (const int k : members_) report_.ringing += part(k).body->ringing();
}

// --- judgement

// Finds the parts of obstacles near a body that are somewhere sharper than `radius`, m.
bool ContactFrame::find_parts(const ContactPart& one, float radius) {
  const auto find = [&](const Eigen::AlignedBox3f& box) {
    parts_near_.clear();
    one.obstacles->add_sharp_parts(box, radius, parts_near_);
    return !parts_near_.empty();
  };
  // The bounds follow the shape only where there is something to judge.
  constexpr float kFar = std::numeric_limits<float>::max();
  const Eigen::AlignedBox3f anywhere(Vector3f::Constant(-kFar), Vector3f::Constant(kFar));
  return find(anywhere) && find(one.body->bounds());
}

// m, how deep parts of obstacles are inside a skin that contact points do not judge: those that are
// sharper than the distance of the points, and those that the skin has closed over.
// @param may_be_enclosed  whether to look for the latter
double ContactFrame::depth_of_parts(ContactPart& one, bool may_be_enclosed) {
  const auto sharpest =
      static_cast<float>(sharpest_radius(static_cast<double>(one.body->contact_points().spacing)));
  constexpr float kAnyRadius = std::numeric_limits<float>::infinity();
  if (!find_parts(one, may_be_enclosed ? kAnyRadius : sharpest)) return 0;
  const MovingSurface& skin = one.body->surface();
  double deepest = 0;
  for (const SharpPart& part : parts_near_) {
    if (std::min(part.radius_a, part.radius_b) < sharpest) {
      deepest = std::max(deepest, depth_of(part, skin));
    }
    if (may_be_enclosed) deepest = std::max(deepest, depth_of_enclosed(part, skin));
  }
  return deepest;
}

void ContactFrame::judge() {
  for (const int k : members_) {
    ContactPart& one = part(k);
    if (one.obstacles == nullptr || one.body->contact_points().points.empty()) continue;
    const auto at_points = static_cast<double>(one.near.depth_of_points(*one.obstacles));
    const auto at_held = static_cast<double>(one.near.depth_of_held(*one.obstacles));
    report_.points_inside = std::max(report_.points_inside, at_points);
    report_.held_inside = std::max(report_.held_inside, at_held);
    // Where contact points are inside of an obstacle, the skin has not closed over it.
    const bool may_be_enclosed = at_points <= kReached && one.obstacles->has_exact_parts();
    report_.sharp_inside = std::max(report_.sharp_inside, depth_of_parts(one, may_be_enclosed));
  }
}

// --- a frame

// The steps that friction needs: obstacles that press when the frame begins do not turn normals by
// more than kTurnInStep in any of them.
int ContactFrame::rubbing_steps() const {
  float largest = 0;
  for (const int k : members_) {
    for (const PointAnchor& anchor : part(k).body->anchors()) {
      if (anchor.by >= 0 || anchor.way.norm() < kTurnInStep * kSharpest) continue;
      const PointForce* at = force_at(part(k), anchor.point, anchor.by);
      if (at == nullptr) continue;
      const Vector3f normal = (at->force - at->friction).normalized();
      const Vector3f aside = anchor.way - anchor.way.dot(normal) * normal;
      const SurfaceGap gap = gap_at(*part(k).obstacles, anchor.place);
      if (gap.is_known()) {
        largest = std::max(largest, largest_curvature(gap.curvature) * aside.norm());
      }
    }
  }
  const float steps = std::ceil(largest / kTurnInStep);
  return static_cast<int>(std::clamp(steps, 1.0f, static_cast<float>(kMostRubbingSteps)));
}

// Moves obstacles to where they were after a share of their ways, as far as these are known.
void ContactFrame::move_obstacles(float done) {
  for (const int k : members_) {
    const Obstacles* given = given_[static_cast<std::size_t>(k)];
    if (given == nullptr) continue;
    const Obstacles* there = done < 1 ? given->on_the_way(done) : nullptr;
    part(k).obstacles = there != nullptr ? there : given;
  }
  search_.change_obstacles();
}

// How far an obstacle is from where the state's force at a contact holds it, as contacts are soft.
ContactFrame::OffForce ContactFrame::off_force(const Contact& c) const {
  const ContactPart& one = part(c.body);
  const SurfaceGap gap = gap_at(*one.obstacles, one.body->shape_at(c.point));
  const PointForce* at = force_at(one, c.point, c.by);
  const float pressing = at != nullptr ? std::max(0.0f, at->force.dot(gap.normal)) : 0.0f;
  const auto compliance =
      static_cast<float>(one.body->skin_compliance(c.area, gap.softness, false));
  return {gap.distance + compliance * pressing, pressing > 0};
}

// m, how much deeper than the forces there hold them obstacles were when the frame began. Of a
// state that was solved it is 0. @pre contacts were searched
double ContactFrame::unsolved_before() {
  move_obstacles(0);
  float deepest = 0;
  for (const Contact& c : search_.contacts()) {
    if (c.by < 0) deepest = std::max(deepest, -off_force(c).distance);
  }
  return deepest > static_cast<float>(kReached) ? static_cast<double>(deepest) : 0.0;
}

// How a frame is divided into steps. Obstacles are moved back so that a skin enters them by no more
// than one step: along the normals, by a shift. With friction they come on their own ways, and a
// shift moves them back only by what was not solved before the frame, or is left to later ones.
ContactFrame::Division ContactFrame::divide(double depth, double largest_move) {
  const auto steps_of = [this](double way) {
    return static_cast<int>(
        std::ceil(std::min(way / limits_.largest_step, 1.0 * limits_.most_steps)));
  };
  Division division;
  division.steps = std::max(1, std::min(steps_of(depth), steps_of(largest_move)));
  division.shift_at_end = std::max(0.0, depth - division.steps * limits_.largest_step);
  division.shift_at_begin = depth;
  if (!rubs_) return division;
  division.steps = std::max(division.steps, rubbing_steps());
  if (division.steps > 1) division.shift_at_begin = unsolved_before();
  return division;
}

// m, by which obstacles are moved back in a step of a frame that was divided.
double ContactFrame::shift_in(int step, const Division& division) const {
  if (!rubs_) return std::max(0.0, division.shift_at_begin - step * limits_.largest_step);
  const double left = static_cast<double>(division.steps - step) / division.steps;
  return division.shift_at_end + left * (division.shift_at_begin - division.shift_at_end);
}

// Finds the contacts of a step and gives them places.
void ContactFrame::find_contacts(Search search, double shift) {
  if (search == Search::kGoesOn) return;
  if (search == Search::kAnew) {
    search_.find(shift);
    watch_skin();
  }
  if (search == Search::kRemembered) search_.choose_remembered(shift);
  // A point with a force that is no longer near an obstacle is no contact, and loses its force.
  report_.dropped = 0;
  find_places();
}

void ContactFrame::run_step(Search search, double shift, bool last) {
  find_contacts(search, shift);
  if (last) {
    run_last_step(shift, report_.iterations + limits_.last_iterations);
  } else {
    // What a step with time leaves unsolved becomes momentum.
    settle(shift, false, false, is_timed_ ? limits_.last_iterations : limits_.iterations,
           search == Search::kGoesOn);
  }
  ++report_.steps;
}

// A frame without time: obstacles advance step by step.
void ContactFrame::run_steps(double depth, double largest_move) {
  const Division division = divide(depth, largest_move);
  const int steps = division.steps;
  const bool is_divided = steps > 1;
  shift_before_ = division.shift_at_begin;
  if (is_divided) search_.remember();
  for (int step = 1; step <= steps; ++step) {
    const double shift = shift_in(step, division);
    const bool last = step == steps;
    done_ = static_cast<float>(step) / static_cast<float>(steps);
    Search search = last ? Search::kKept : Search::kRemembered;
    if (rubs_ && is_divided) move_obstacles(done_);
    if ((rubs_ && is_divided) || (last && (is_divided || shift > 0))) search = Search::kAnew;
    run_step(search, shift, last);
    // Contacts are searched anew in the last step, with friction in each.
    if (!last && (rubs_ || step + 1 == steps)) form_shapes(false);
    end_step(shift, last);
  }
}

// --- time

// The equal steps into which a time (s) is divided; 0: no member has inertia.
int ContactFrame::steps_in(double time) const {
  int steps = 0;
  for (const int k : members_) steps = std::max(steps, part(k).body->steps_in(time));
  return steps;
}

// Whether a member may touch something in this frame. Without it all members move freely, which
// they do exactly in one step.
bool ContactFrame::is_anything_near() const {
  if (!pairs_.empty()) return true;
  return std::any_of(members_.begin(), members_.end(), [this](int k) {
    const ContactPart& one = part(k);
    if (!one.body->forces().empty()) return true;
    const Obstacles* given = given_[static_cast<std::size_t>(k)];
    if (given == nullptr) return false;
    const Eigen::AlignedBox3f box = one.body->bounds();
    const double reach = limits_.band + 2 * one.body->amplitude();
    const float radius = 0.5f * box.diagonal().norm() + static_cast<float>(reach);
    const float way = given->largest_way();
    return !std::isfinite(way) || given->may_be_within(box.center(), radius + way);
  });
}

// m that obstacles come at most in this frame.
double ContactFrame::largest_way_of_obstacles() const {
  float largest = 0;
  for (const int k : members_) {
    const Obstacles* given = given_[static_cast<std::size_t>(k)];
    if (given != nullptr) largest = std::max(largest, given->largest_way());
  }
  return static_cast<double>(largest);
}

// m that a vertex may be moved by inertia in a time (s).
double ContactFrame::largest_way_by_inertia(double time) const {
  double fastest = 0;
  for (const int k : members_) {
    // One without inertia gives way as far as it must.
    if (part(k).body->steps_in(0) == 0) return limits_.band;
    fastest = std::max(fastest, part(k).body->largest_speed());
  }
  return (pairs_.empty() ? 1 : 2) * fastest * time;
}

void ContactFrame::set_time_step(double h) {
  for (const int k : members_) {
    if (part(k).body->steps_in(0) > 0) part(k).body->set_time_step(h);
  }
}

// Before a frame whose obstacles have come no way that counts: the first one, or one after a pause,
// in which bodies ring on under the forces that they had; without time nothing rings.
void ContactFrame::begin_without_way(std::optional<double> time) {
  if (time) set_time_step(0);
  for (const int k : members_) {
    if (!time) {
      part(k).body->forget_time();
    } else if (part(k).body->steps_in(0) > 0) {
      part(k).body->ring_on(std::max(0.0, *time));
    }
  }
}

// Whether obstacles, where they were when the frame began, are elsewhere than the forces hold the
// skin: deeper, or farther away. @pre contacts were searched; obstacles are where they were
bool ContactFrame::is_off_at_begin() const {
  const auto tolerance = static_cast<float>(limits_.tolerance);
  return std::any_of(search_.contacts().begin(), search_.contacts().end(), [&](const Contact& c) {
    if (c.by >= 0) return false;
    const OffForce off = off_force(c);
    return off.presses ? !(std::abs(off.distance) < tolerance) : off.distance < -tolerance;
  });
}

// A frame in which time passes. First what obstacles are inside when it begins is corrected: that
// is not motion but a new measurement, which gives no velocity. Then obstacles come on their ways
// in equal steps, as many as the fastest mode and the obstacles' ways need.
void ContactFrame::run_in_time(double largest_move, double time) {
  const double way_of_obstacles = largest_way_of_obstacles();
  move_obstacles(0);
  search_.find(0);
  const double unsolved = unsolved_before();
  const double within_limit = std::min(unsolved, largest_move);
  int corrections = static_cast<int>(
      std::ceil(std::min(within_limit / limits_.largest_step, 1.0 * limits_.most_steps)));
  if (corrections == 0 && is_off_at_begin()) corrections = 1;
  left_behind_ = std::max(0.0, unsolved - corrections * limits_.largest_step);
  shift_before_ = unsolved;
  // Shapes are formed, and contacts searched in them, where a point may have come through the band
  // in which they were searched.
  bool is_fresh = true;
  const auto run = [&](double shift, double way, bool last) {
    move_obstacles(done_);
    const bool anew = last || is_fresh || may_have_come(way);
    if (anew && !is_fresh) form_shapes(false);
    if (anew) came_ = skin_moved_ = 0;
    came_ += way;
    is_fresh = false;
    run_step(anew ? Search::kAnew : Search::kGoesOn, shift, last);
    end_step(shift, last);
    note_way_of_skin();
  };
  done_ = 0;
  set_time_step(0);
  for (int step = 1; step <= corrections; ++step) {
    run(std::max(left_behind_, unsolved - step * limits_.largest_step), limits_.band, false);
  }
  int steps = 1;
  // Where neither obstacles nor skin move by more than what iterations leave, one step is as good
  // as many: its forces are constant.
  const bool is_still = way_of_obstacles + largest_way_by_inertia(time) < limits_.tolerance;
  if (!is_still && is_anything_near()) {
    const double of_obstacles =
        std::isfinite(way_of_obstacles) ? std::ceil(way_of_obstacles / limits_.largest_step) : 1.0;
    steps = std::max(steps_in(time), static_cast<int>(std::min(of_obstacles, kMostOfObstacles)));
  }
  const double h = time / steps;
  set_time_step(h);
  for (int step = 1; step <= steps; ++step) {
    done_ = static_cast<float>(step) / static_cast<float>(steps);
    run(left_behind_, way_of_obstacles / steps, step == steps);
  }
}

// Contacts were searched: chooses what note_way_of_skin() follows of skin that was not near enough.
void ContactFrame::watch_skin() {
  for (const int k : members_) {
    ContactPart& one = part(k);
    one.watched.clear();
    if (!is_timed_) continue;
    if (!pairs_.empty()) {
      one.near.find_all_vertices(one.watched);
    } else if (one.obstacles != nullptr) {
      one.near.find_near_vertices(kWatched, *one.obstacles, one.watched);
    }
  }
}

// After a step: how far the skin has moved since contacts were searched in its shape. Its contact
// points are followed, and the skin beside them may have moved half as far again; farther away it
// moves by inertia.
void ContactFrame::note_way_of_skin() {
  double moved = 0;
  for (const int k : members_) {
    moved = std::max(moved, part(k).body->way_by_inertia(part(k).watched));
  }
  for (const Contact& c : search_.contacts()) {
    ContactBody& body = *part(c.body).body;
    const float way = kBesidePoints * (body.position(c.place) - body.shape_at(c.point)).norm();
    moved = std::max(moved, static_cast<double>(way));
  }
  if (!pairs_.empty()) moved *= 2;  // towards each other
  skin_moves_ = std::max(0.0, moved - skin_moved_);
  skin_moved_ = moved;
}

// Whether a point may come through the band in which contacts were searched, in a step in which
// obstacles come by `way` (m) and the skin moves on as in the step before.
bool ContactFrame::may_have_come(double way) const {
  return !(came_ + way + skin_moved_ + skin_moves_ < kSearchAgain * least_band_);
}

// Whether contacts must be searched in a new shape for a tick of h, s.
bool ContactFrame::is_shape_due(double h, double way) const {
  return may_have_come(way) || searched_ + 0.5 * h > kLongestShape;
}

ContactReport ContactFrame::tick(std::span<const int> members, double h, double way) {
  begin(members, {});
  is_timed_ = steps_in(h) > 0;
  is_entered_ = false;
  left_behind_ = shift_before_ = 0;
  done_before_ = 0;
  done_ = 1;
  if (is_timed_) {
    set_time_step(h);
  } else {
    begin_without_way({});
  }
  const bool anew = !ticks_ || is_formed_ || is_shape_due(h, way);
  if (anew) {
    if (ticks_ && !is_formed_) form_shapes(false);
    came_ = searched_ = skin_moved_ = 0;
  }
  came_ += way;
  searched_ += h;
  ticks_ = true;
  is_formed_ = false;
  find_contacts(anew ? Search::kAnew : Search::kGoesOn, 0);
  settle(0, false, false, limits_.last_iterations, !anew);
  ++report_.steps;
  end_step(0, true);
  note_way_of_skin();
  // A shape that the next tick will need is formed now: what a tick may cost is divided among two.
  if (is_shape_due(h, way)) {
    form_shapes(false);
    for (const int k : members_) part(k).body->keep_shape();
    is_formed_ = true;
  }
  if (rubs_) report_.friction_residual = problem_.residual();
  report_.stuck = is_stuck_;
  if (!is_settled()) report_.left_to_move = report_.last_change;
  for (const int k : members_) report_.ringing += part(k).body->ringing();
  return report_;
}

void ContactFrame::end_ticks() {
  if (!ticks_) return;
  form_shapes(true);
  for (const int k : members_) part(k).body->keep_shape();
  ticks_ = false;
}

ContactReport ContactFrame::solve(std::span<const int> members, std::span<const SkinPair> pairs,
                                  double largest_move, std::optional<double> time) {
  begin(members, pairs);
  const bool has_inertia = time && steps_in(0) > 0;
  left_behind_ = 0;
  is_timed_ = has_inertia && *time > 0 && *time <= kLongestTime;
  search_.find(0);
  double depth = 0;
  for (const Contact& c : search_.contacts()) {
    if (c.by < 0) depth = std::max(depth, -static_cast<double>(c.distance));
  }
  report_.inside_before = depth;
  is_entered_ = false;
  done_before_ = 0;
  if (is_timed_) {
    run_in_time(largest_move, *time);
  } else {
    begin_without_way(has_inertia ? time : std::nullopt);
    run_steps(depth, largest_move);
  }
  end_frame(largest_move);
  judge();
  return report_;
}

}  // namespace palpable
