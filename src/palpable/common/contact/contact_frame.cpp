#include "palpable/common/contact/contact_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector3f;

// How often an iteration that moves a point too far is halved before it is given up.
constexpr int kHalvings = 4;
// Ratio to ContactLimits::largest_step: a point with a larger gap and no force is left out of an
// iteration. If the iteration moves it into an obstacle, the next one includes it.
constexpr double kTakesPart = 0.4;
// Ratio to the same: the smallest gap that leaves a point out where ContactLimits::narrows.
constexpr double kLeastReach = 0.02;
// Largest number of searches in the last step of a frame. With fewer, points that the solution
// moved into an obstacle, and feet that have slid, are mended only in the next frame.
constexpr int kRounds = 3;
// Ratio to ContactLimits::band: a point that entered less deep is left to the next frame.
constexpr double kEntered = 0.04;
// Ratio to ContactLimits::largest_step: if the last iteration moved a point farther, the solution
// has not converged. The bodies then move by kUnsettledSteps largest steps at most.
constexpr double kUnsettled = 0.4;
constexpr int kUnsettledSteps = 3;
// Smallest share of an iteration that damping (ContactLimits::damped) leaves.
constexpr float kLeastShare = 0.25f;
// How often ContactLimits::entry is doubled to reduce the number of contact points.
constexpr int kCoarser = 8;
// Cosines of the angle between two skins' normals. Below kFacing (46 degrees) the skins do not lie
// on each other. From kAlmostFlat (14 degrees) to kFlat (8) the normal of the contact point gains
// weight in that of the contact.
constexpr float kFacing = 0.7f;
constexpr float kAlmostFlat = 0.97f, kFlat = 0.99f;
// m: a contact that slides farther along another skin is given a new tangent plane there.
constexpr float kSamePlane = 0.0003f;
// m: a contact that slides farther in a step is given a new foot, at which its force acts back.
constexpr float kSameFoot = 0.0005f;
// m^2: smallest area of a contact point, by whose root the compliance under it is divided.
constexpr double kLeastArea = 1e-8;

void set_gap(Contact& contact, const SurfaceGap& gap) {
  contact.distance = gap.distance;
  contact.normal = gap.normal;
  contact.curvature = gap.curvature;
  contact.softness = gap.softness;
}

bool is_same(const Contact& a, const Contact& b) {
  return a.body == b.body && a.point == b.point && a.by == b.by;
}

// m, of a place of a skin from its nearest edge.
float edge_distance_of(const ContactPart& part, const SkinPoint& place) {
  float sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    sum += place.weights[static_cast<int>(k)] *
           part.edge_distance[static_cast<std::size_t>(place.corners[k])];
  }
  return sum;
}

// The place of a skin that is nearest to x; nothing if x is farther outside than `band`, m.
std::optional<NearestOnSkin> nearest_on(const MovingSurface& skin, const Vector3f& x, float band) {
  const Eigen::AlignedBox3f bounds = skin.bounds();
  if (!(bounds.squaredExteriorDistance(x) < band * band)) return std::nullopt;
  auto found = skin.nearest(x, band);
  // What is inside may be farther from the skin.
  if (!found && bounds.contains(x)) found = skin.nearest(x, kDeepInside);
  return found;
}

// Direction of the force between two skins, in the frame of the other one: the other skin's normal.
// Where the other skin has an edge that lies on the face around the point, the normal of that face.
Vector3f normal_between(ContactPart& part, int point, ContactPart& other,
                        const NearestOnSkin& found, const SkinPair& pair) {
  const MovingSurface& surface = other.body->surface();
  const Vector3f normal = surface.rounded_at(found).normal;
  const float from_edge = edge_distance_of(other, surface.place_of(found));
  const SkinPointSet points = part.body->contact_points();
  const Vector3f against = -(pair.skin_from_points.linear() * part.body->normal_at(point));
  const float facing = against.dot(normal);
  // Skins that do not face each other: the gap's own direction.
  if (!(facing > kFacing)) return normal;
  // An edge matters as far as its face's contact points are apart; skins that lie on each other are
  // as good as one another.
  const float nearness = 1 - from_edge / points.between;
  const float flatness = std::clamp((facing - kAlmostFlat) / (kFlat - kAlmostFlat), 0.0f, 1.0f);
  const float share = std::max(nearness, flatness);
  if (!(share > 0)) return normal;
  const float own_weight =
      share * edge_distance_of(part, points.points[static_cast<std::size_t>(point)]);
  if (!(own_weight + from_edge > 0)) return normal;
  return (own_weight * against + from_edge * normal).normalized();
}

}  // namespace

ContactPart::ContactPart(ContactBody& the_body) : body(&the_body), near(the_body) {}

ContactFrame::ContactFrame(std::span<ContactPart> parts, int most)
    : parts_(parts), most_(static_cast<std::size_t>(most)), problem_(most), bodies_(parts.size()) {
  std::size_t all = 0, largest = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    ContactPart& part = parts[k];
    const std::size_t points = part.body->contact_points().points.size();
    all += points;
    largest = std::max(largest, points);
    bodies_[k].body = part.body;
    bodies_[k].normals.reserve(most_);
    bodies_[k].tangents.reserve(most_);
    part.loads.reserve(most_ + 1);
    part.place_forces.reserve(most_ + 1);
  }
  for (auto* list : {&contacts_, &found_}) list->reserve(all + most_);
  for (auto* list : {&feet_before_, &pressed_}) list->reserve(most_);
  of_pressed_.reserve(most_);
  forces_before_.resize(most_);
  is_contact_.resize(largest, 0);
  queried_points_.reserve(most_);
  of_queried_.reserve(most_);
  queried_at_.reserve(most_);
  gaps_.reserve(most_);
}

void ContactFrame::begin(std::span<const int> members, std::span<const SkinPair> pairs) {
  members_ = members;
  pairs_ = pairs;
  report_ = {};
  limits_ = {};
  limits_.largest_step = limits_.tolerance = limits_.largest_change =
      std::numeric_limits<double>::infinity();
  for (const int k : members) {
    if (part(k).body->contact_points().points.empty()) continue;
    part(k).near.start();
    const ContactLimits& one = part(k).body->limits();
    limits_.band = std::max(limits_.band, one.band);
    limits_.largest_step = std::min(limits_.largest_step, one.largest_step);
    limits_.most_steps = std::max(limits_.most_steps, one.most_steps);
    limits_.iterations = std::max(limits_.iterations, one.iterations);
    limits_.last_iterations = std::max(limits_.last_iterations, one.last_iterations);
    limits_.tolerance = std::min(limits_.tolerance, one.tolerance);
    limits_.largest_change = std::min(limits_.largest_change, one.largest_change);
    limits_.damped &= one.damped;
    limits_.narrows |= one.narrows;
  }
}

const SkinPair& ContactFrame::pair_of(const Contact& contact) const {
  return *std::find_if(pairs_.begin(), pairs_.end(), [&](const SkinPair& pair) {
    return pair.points == contact.body && pair.skin == contact.by;
  });
}

// --- search

void ContactFrame::add_contact(int body, int point, const SurfaceGap& gap) {
  Contact contact;
  contact.body = body;
  contact.point = point;
  contact.area =
      std::max(kLeastArea,
               static_cast<double>(
                   part(body).body->contact_points().points[static_cast<std::size_t>(point)].area));
  set_gap(contact, gap);
  contacts_.push_back(contact);
}

// Points that are near something in the present shapes.
void ContactFrame::search(double shift) {
  contacts_.clear();
  for (const int k : members_) {
    ContactPart& one = part(k);
    if (one.obstacles == nullptr) continue;
    one.near.for_each(static_cast<float>(one.body->limits().band - shift), *one.obstacles,
                      [&](int point, const SurfaceGap& gap) { add_contact(k, point, gap); });
  }
  for (const SkinPair& pair : pairs_) search_between(pair);
}

// A contact between bodies gets the plane of the place that is nearest to its point.
// @param from_foot  m, the point from the foot, frame of the other body
void ContactFrame::take_plane(Contact& contact, const NearestOnSkin& found,
                              const Vector3f& from_foot, const SkinPair& pair) {
  contact.foot_normal =
      normal_between(part(contact.body), contact.point, part(contact.by), found, pair);
  contact.normal = pair.skin_from_points.linear().transpose() * contact.foot_normal;
  contact.anchor = from_foot;
  contact.anchor_gap = found.distance + pair.overlap;
}

void ContactFrame::search_between(const SkinPair& pair) {
  ContactPart &one = part(pair.points), &other = part(pair.skin);
  const auto band = static_cast<float>(one.body->limits().band);
  if (one.near.between().empty()) return;
  const Eigen::AlignedBox3f box = one.body->bounds().transformed(pair.skin_from_points);
  if (!(box.squaredExteriorDistance(other.body->bounds()) < band * band)) return;
  const SkinPointSet points = one.body->contact_points();
  const MovingSurface& surface = other.body->surface();
  for (const int point : one.near.between()) {
    const Vector3f x = pair.skin_from_points * one.body->shape_at(point);
    const auto found = nearest_on(surface, x, band);
    if (!found || !(found->distance + pair.overlap <= band)) continue;
    Contact contact;
    contact.body = pair.points;
    contact.point = point;
    contact.by = pair.skin;
    contact.foot = surface.place_of(*found);
    const auto area = static_cast<double>(points.points[static_cast<std::size_t>(point)].area);
    const auto spacing = static_cast<double>(points.between);
    // Points that are compared with other skins lie farther apart than all contact points, so each
    // represents a larger area.
    contact.area = std::max(area, spacing * spacing);
    take_plane(contact, *found, x - other.body->shape_at(contact.foot), pair);
    contact.distance = contact.anchor_gap;
    contacts_.push_back(contact);
  }
}

// Chooses, of the contacts found in the shape with which the frame began, those near the obstacles
// at their present step. Pressed points move away from the obstacles, and few others come near.
void ContactFrame::choose_found(double shift) {
  contacts_.clear();
  for (const Contact& c : found_) {
    const double band = part(c.body).body->limits().band;
    if (c.by >= 0 || c.distance < static_cast<float>(band - shift)) contacts_.push_back(c);
  }
}

// A skin that springs back after an obstacle left may move by more than the band, so that points
// which were no contacts enter an obstacle. Adds those of the shape just formed. False: there are
// none.
bool ContactFrame::add_entered(double shift) {
  const std::size_t known = contacts_.size();
  for (const int k : members_) {
    ContactPart& one = part(k);
    const double band = one.body->limits().band;
    if (one.obstacles == nullptr || !one.body->has_moved(band)) continue;
    const auto mark = [&](char value) {
      for (std::size_t c = 0; c < known; ++c) {
        if (contacts_[c].body != k || contacts_[c].by >= 0) continue;
        is_contact_[static_cast<std::size_t>(contacts_[c].point)] = value;
      }
    };
    mark(1);
    one.near.for_each(-static_cast<float>(kEntered * band + shift), *one.obstacles,
                      [&](int point, const SurfaceGap& gap) {
                        if (is_contact_[static_cast<std::size_t>(point)] == 0)
                          add_contact(k, point, gap);
                      });
    mark(0);
  }
  return contacts_.size() > known;
}

// Searches the contacts between bodies again in the shapes just formed. False: their gaps are those
// of the last iteration, and the contacts are unchanged.
bool ContactFrame::find_feet_again() {
  const bool has_slid = std::any_of(contacts_.begin(), contacts_.end(), [](const Contact& c) {
    return c.by >= 0 && c.pressing > 0 && c.slid > kSameFoot;
  });
  // Points that were too far to be contacts may have come near.
  const bool has_moved =
      !pairs_.empty() && std::any_of(members_.begin(), members_.end(), [this](int k) {
        return part(k).body->has_moved(kTakesPart * limits_.band);
      });
  if (!has_slid && !has_moved) return false;
  feet_before_.clear();
  for (const Contact& c : contacts_) {
    if (c.by >= 0) feet_before_.push_back(c);
  }
  std::erase_if(contacts_, [](const Contact& c) { return c.by >= 0; });
  const std::size_t first = contacts_.size();
  for (const SkinPair& pair : pairs_) search_between(pair);
  bool is_new = false;
  std::size_t pressing = 0;
  for (std::size_t k = first; k < contacts_.size(); ++k) {
    Contact& c = contacts_[k];
    const auto before = std::find_if(feet_before_.begin(), feet_before_.end(),
                                     [&](const Contact& old) { return is_same(c, old); });
    const auto tolerance = static_cast<float>(limits_.tolerance);
    if (before == feet_before_.end()) {
      is_new |= c.distance < -tolerance;
      continue;
    }
    pressing += before->pressing > 0;
    const bool matters = before->pressing > 0 || c.distance < 0;
    is_new |= matters && std::abs(c.distance - before->distance) > tolerance;
    c.pressing = before->pressing;
    c.force = static_cast<float>(c.pressing) * c.normal;
  }
  const auto pressed_before = std::count_if(feet_before_.begin(), feet_before_.end(),
                                            [](const Contact& c) { return c.pressing > 0; });
  if (is_new || pressing != static_cast<std::size_t>(pressed_before)) return true;
  contacts_.resize(first);
  contacts_.insert(contacts_.end(), feet_before_.begin(), feet_before_.end());
  return false;
}

// Makes the contact points of a body coarser until they are no more than
// ContactLimits::thins_above.
void ContactFrame::thin(int body) {
  const ContactLimits& limits = part(body).body->limits();
  const auto is_of_body = [body](const Contact& c) { return c.body == body && c.by < 0; };
  const auto are_many = [&] {
    return limits.thins_above > 0 &&
           std::count_if(contacts_.begin(), contacts_.end(), is_of_body) > limits.thins_above;
  };
  for (int coarser = 0; coarser <= kCoarser && are_many(); ++coarser) {
    std::erase_if(contacts_, [&](const Contact& c) {
      if (!is_of_body(c)) return false;
      if (!(c.distance < static_cast<float>(kTakesPart * limits.band))) return true;
      const auto entry = static_cast<float>(std::ldexp(limits.entry, coarser));
      return !part(body).near.is_needed(c.point, c.curvature, entry);
    });
  }
}

bool ContactFrame::add_places(const Contact& contact) {
  ContactPart& one = part(contact.body);
  if (!one.body->add_place(contact.point)) return false;
  ++one.places;
  if (contact.by < 0) return true;
  ContactPart& other = part(contact.by);
  if (!other.body->add_place(contact.foot)) return false;
  ++other.places;
  return true;
}

// At most as many as there is room for, the deepest first.
void ContactFrame::keep_nearest() {
  for (const int k : members_) thin(k);
  std::sort(contacts_.begin(), contacts_.end(), [](const Contact& a, const Contact& b) {
    if (a.distance != b.distance) return a.distance < b.distance;
    return std::array{a.point, a.body, a.by} < std::array{b.point, b.body, b.by};
  });
  for (const int k : members_) {
    part(k).body->clear_places();
    part(k).places = 0;
  }
  std::size_t kept = 0;
  while (kept < contacts_.size() && kept < most_ && add_places(contacts_[kept])) ++kept;
  report_.dropped += static_cast<int>(contacts_.size() - kept);
  contacts_.resize(kept);
  report_.candidates = std::max(report_.candidates, static_cast<int>(kept));
}

// --- iterations

// Gives the contacts the forces of the states, and numbers their places. A force at a point that is
// no contact any more is dropped. @param goes_on  the contacts keep the forces of the round before
void ContactFrame::take_up(double shift, bool goes_on) {
  for (const int k : members_) {
    part(k).loads.assign(part(k).places, {});
    part(k).places = 0;
  }
  for (Contact& c : contacts_) {
    ContactPart& one = part(c.body);
    const std::vector<PointForce>& forces = one.body->forces();
    const PointForce wanted{c.point, {}, c.by};
    const auto at = std::lower_bound(forces.begin(), forces.end(), wanted, stands_before);
    if (!goes_on && at != forces.end() && !stands_before(wanted, *at)) {
      c.force = at->force;
      c.pressing = std::max(0.0, static_cast<double>(at->force.dot(c.normal)));
    }
    const float entry = std::max(0.0f, -c.distance - static_cast<float>(c.by < 0 ? shift : 0.0));
    c.place = one.places++;
    one.loads[c.place] = {c.force, entry};
    if (c.by < 0) continue;
    ContactPart& other = part(c.by);
    c.on_foot = other.places++;
    other.loads[c.on_foot] = {-(pair_of(c).skin_from_points.linear() * c.force), entry};
  }
}

// Iterates until the contacts' forces and gaps are complementary, at most `most` times.
void ContactFrame::settle(double shift, bool last, bool goes_on, int most) {
  take_up(shift, goes_on);
  for (const int k : members_) part(k).body->begin_step(part(k).loads, last);
  float share = 1;
  reach_ = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most; ++i) {
    ++report_.iterations;
    const double change = iterate(shift, share);
    // Two sets of points that press in turn would alternate for ever.
    if (limits_.damped && i > 0 && change > report_.last_change) {
      share = std::max(kLeastShare, 0.5f * share);
    }
    report_.last_change = change;
    if (change < limits_.tolerance) break;
    reach_ = std::max(kLeastReach * limits_.largest_step, change);
  }
}

// Gaps of a body's contact points to its obstacles, in one query.
void ContactFrame::find_gaps_of(int body, double shift) {
  ContactPart& one = part(body);
  queried_points_.clear();
  of_queried_.clear();
  queried_at_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    if (c.body != body || c.by >= 0) continue;
    queried_points_.push_back(c.point);
    of_queried_.push_back(k);
    queried_at_.push_back(one.body->position(c.place));
  }
  if (queried_points_.empty()) return;
  gaps_.resize(queried_points_.size());
  const auto far = static_cast<float>(2 * kTakesPart * limits_.largest_step - shift);
  one.near.find_gaps(queried_points_, queried_at_, *one.obstacles, far, gaps_);
  for (std::size_t k = 0; k < of_queried_.size(); ++k) {
    Contact& c = contacts_[of_queried_[k]];
    if (std::isfinite(gaps_[k].distance)) {
      set_gap(c, gaps_[k]);
    } else {
      c.distance = static_cast<float>(10 * limits_.band);
    }
  }
}

// Computes the gap of a contact between bodies from its tangent plane, which moves with the foot. A
// contact that has slid gets a new plane, from the other body's shape moved as far as the foot has.
void ContactFrame::find_gap_between(Contact& c) {
  const SkinPair& pair = pair_of(c);
  ContactPart& other = part(c.by);
  const Vector3f x = pair.skin_from_points * part(c.body).body->position(c.place);
  const Vector3f foot = other.body->position(c.on_foot);
  const Vector3f way = x - foot - c.anchor;
  const float along = c.foot_normal.dot(way);
  c.distance = c.anchor_gap + along;
  const float slid = (way - along * c.foot_normal).norm();
  if (slid < kSamePlane) return;
  const auto band = static_cast<float>(part(c.body).body->limits().band);
  const Vector3f in_shape = x - (foot - other.body->shape_at(c.foot));
  const auto found = nearest_on(other.body->surface(), in_shape, band);
  c.slid += slid;
  if (found) {
    take_plane(c, *found, x - foot, pair);
    c.distance = c.anchor_gap;
  } else {
    c.distance = std::max(c.distance, band);
  }
}

// Gaps at the present positions.
void ContactFrame::find_gaps(double shift) {
  for (const int k : members_) find_gaps_of(k, shift);
  for (Contact& c : contacts_) {
    if (c.by >= 0) find_gap_between(c);
  }
}

// Chooses the contacts of an iteration: those that press, or may press after it.
void ContactFrame::choose_pressed(double shift) {
  pressed_.clear();
  of_pressed_.clear();
  double way = kTakesPart * limits_.largest_step;
  if (limits_.narrows) way = std::min(way, reach_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    forces_before_[k] = c.force;
    const auto reach = static_cast<float>(way - (c.by < 0 ? shift : 0.0));
    if (!(c.distance < reach) && c.force.isZero(0)) continue;
    pressed_.push_back(c);
    of_pressed_.push_back(k);
  }
}

// New forces of the contacts that take part. A state on the way may have no positive definite
// tangent; without what is not always positive the step is a shorter one, not a wrong one.
bool ContactFrame::solve_problem(double shift) {
  using Tangent = ContactBody::Tangent;
  const auto solve = [&](bool turning, Tangent tangent) {
    return problem_.solve(pressed_, bodies_, {shift, turning, tangent});
  };
  if (!solve(true, Tangent::kFull) && !solve(false, Tangent::kFull) &&
      !solve(false, Tangent::kSafe)) {
    return false;
  }
  for (std::size_t k = 0; k < of_pressed_.size(); ++k) contacts_[of_pressed_[k]] = pressed_[k];
  return true;
}

// Reduces the change of the forces in this iteration to a share of it.
void ContactFrame::go_back(float share) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& c = contacts_[k];
    c.force = share * c.force + (1 - share) * forces_before_[k];
    c.pressing = std::max(0.0, static_cast<double>(c.force.dot(c.normal)));
  }
}

void ContactFrame::fill_place_forces() {
  for (const int k : members_) part(k).place_forces.assign(part(k).loads.size(), Vector3f::Zero());
  for (const Contact& c : contacts_) {
    part(c.body).place_forces[c.place] = c.force;
    if (c.by < 0) continue;
    part(c.by).place_forces[c.on_foot] = -(pair_of(c).skin_from_points.linear() * c.force);
  }
}

// A share of one step of Newton's method. Returns how far it moved a point, m.
double ContactFrame::iterate(double shift, float share) {
  find_gaps(shift);
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
    // The last time nothing is left of the step: no state is better than one beyond what is known.
    const float part_of_step = halving + 1 < kHalvings ? 0.5f : 0.0f;
    go_back(part_of_step);
    gone *= static_cast<double>(part_of_step);
  }
  return 0;
}

// --- steps

// Solves, forms the shapes, and searches again until nothing more is found.
void ContactFrame::run_last_step(double shift, int most) {
  bool goes_on = false;
  for (int round = 0;; ++round) {
    report_.rounds = round + 1;
    // With other bodies each search may change many contacts, so it gets iterations of its own.
    if (!pairs_.empty()) most = report_.iterations + limits_.last_iterations;
    settle(shift, true, goes_on, most - report_.iterations);
    for (const int k : members_) part(k).body->form_shape(true);
    const bool may_go_on = round + 1 < kRounds && (report_.iterations < most || !pairs_.empty());
    const bool slid = may_go_on && find_feet_again();
    const bool entered = add_entered(shift);
    if (!entered && !slid) return;
    keep_nearest();
    if (!may_go_on) {
      is_entered_ = true;
      return;
    }
    // Slid feet change the solution little, so it goes on from its forces; a skin that entered an
    // obstacle has moved too far, so it starts again from the state.
    goes_on = !entered;
  }
}

// Hands forces and displacements to the states of the bodies.
void ContactFrame::end_step(bool last) {
  // Those that entered last and were not solved have no position.
  std::erase_if(contacts_, [](const Contact& c) { return c.place == Contact::kNoPlace; });
  if (last) find_gaps(0);
  report_.penetration = report_.between = 0;
  for (const int k : members_) {
    part(k).body->forces().clear();
    part(k).penetration = 0;
  }
  for (const Contact& c : contacts_) {
    const double depth = -static_cast<double>(c.distance);
    double& deepest = c.by < 0 ? part(c.body).penetration : report_.between;
    if (c.by < 0 || c.pressing > 0) deepest = std::max(deepest, depth);
    if (c.pressing > 0) part(c.body).body->forces().push_back({c.point, c.force, c.by});
  }
  for (const int k : members_) {
    std::vector<PointForce>& forces = part(k).body->forces();
    std::sort(forces.begin(), forces.end(), stands_before);
    report_.penetration = std::max(report_.penetration, part(k).penetration);
    const bool is_free = report_.last_change < limits_.tolerance &&
                         std::none_of(contacts_.begin(), contacts_.end(),
                                      [k](const Contact& c) { return c.body == k || c.by == k; });
    part(k).body->keep(is_free);
  }
}

// Limits how far each body moves in this frame; the rest of its way is left to later frames.
void ContactFrame::end_frame(double largest_move) {
  for (const int k : members_) part(k).body->end_frame(part(k).penetration);
  const bool settled =
      !is_stuck_ && !is_entered_ && report_.last_change <= kUnsettled * limits_.largest_step;
  if (!settled) {
    largest_move = std::min(largest_move, kUnsettledSteps * limits_.largest_step);
    report_.held_back = report_.last_change;
  }
  for (const int k : members_) {
    const double moved = part(k).body->moved();
    part(k).share_gone = moved > largest_move ? largest_move / moved : 1;
    report_.held_back = std::max(report_.held_back, moved - largest_move);
  }
  // Bodies that press each other go the same share of their way, so that their forces stay
  // opposite.
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (const Contact& c : contacts_) {
      if (c.by < 0 || !(c.pressing > 0)) continue;
      double &one = part(c.body).share_gone, &other = part(c.by).share_gone;
      is_new |= one != other;
      one = other = std::min(one, other);
    }
  }
  for (const int k : members_) {
    if (part(k).share_gone < 1) part(k).body->hold_back(part(k).share_gone);
  }
}

ContactReport ContactFrame::solve(std::span<const int> members, std::span<const SkinPair> pairs,
                                  double largest_move) {
  begin(members, pairs);
  search(0);
  double depth = 0;
  for (const Contact& c : contacts_) {
    if (c.by < 0) depth = std::max(depth, -static_cast<double>(c.distance));
  }
  const auto steps_of = [this](double way) {
    return static_cast<int>(
        std::ceil(std::min(way / limits_.largest_step, 1.0 * limits_.most_steps)));
  };
  const int steps = std::max(1, std::min(steps_of(depth), steps_of(largest_move)));
  is_entered_ = false;
  if (steps > 1) found_ = contacts_;
  for (int step = 1; step <= steps; ++step) {
    // Obstacles are taken back so far that a skin enters them by no more than a step.
    const double shift = std::max(0.0, depth - step * limits_.largest_step);
    const bool last = step == steps;
    if (!last) {
      choose_found(shift);
    } else if (steps > 1 || shift > 0) {
      search(shift);
    }
    // Those that press and have just lost sight of the obstacle lose their force by themselves.
    report_.dropped = 0;
    keep_nearest();
    if (last) {
      run_last_step(shift, report_.iterations + limits_.last_iterations);
    } else {
      settle(shift, false, false, limits_.iterations);
      // Contacts are searched anew in the last step.
      if (step + 1 == steps) {
        for (const int k : members_) part(k).body->form_shape(false);
      }
    }
    ++report_.steps;
    end_step(last);
  }
  end_frame(largest_move);
  return report_;
}

}  // namespace palpable
