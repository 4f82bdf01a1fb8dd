#include "palpable/common/contact/contact_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Ratio to ContactLimits::band: a point that entered less deep is left to the next frame.
constexpr double kEntered = 0.04;
// Largest number of times that ContactLimits::entry is doubled to reduce the contact points.
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
// A point with an anchor is kept where another one would not be: while obstacles are flatter by
// this ratio than those that need it, and as if it were nearer by so much, m. Without that, points
// at the limit would come and go with the noise of a camera, and each would start anew where it
// is: the skin would creep.
constexpr float kFlatter = 2, kNearerIfAnchored = 2e-4f;

void set_gap(Contact& contact, const SurfaceGap& gap) {
  contact.distance = gap.distance;
  contact.normal = gap.normal;
  contact.curvature = gap.curvature;
  contact.softness = gap.softness;
  contact.given = gap.friction;
  contact.part = gap.part;
}

bool is_same(const Contact& a, const Contact& b) {
  return a.body == b.body && a.point == b.point && a.by == b.by;
}

// m, distance of a position on a skin from the nearest sharp edge.
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
  // Positions inside may be farther from the skin.
  if (!found && bounds.contains(x)) found = skin.nearest(x, kDeepInside);
  return found;
}

// Direction of the force between two skins, in the frame of the other one: the normal of the other
// skin, or, where an edge of it lies on the face around the point, the normal of that face.
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
  // The influence of an edge ends at the distance of the contact points on the face. Where skins
  // are parallel, both normals are equally good.
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

ContactPart::ContactPart(ContactBody& the_body) : body(&the_body), near(the_body) {
  watched.reserve(near.cluster_count());
}

ContactSearch::ContactSearch(std::span<ContactPart> parts, int most)
    : parts_(parts), most_(static_cast<std::size_t>(most)) {
  std::size_t all = 0, largest = 0;
  for (const ContactPart& part : parts) {
    const std::size_t points = part.body->contact_points().points.size();
    all += points;
    largest = std::max(largest, points);
  }
  for (auto* list : {&contacts_, &found_}) list->reserve(all + most_);
  feet_before_.reserve(most_);
  is_contact_.resize(largest, 0);
  queried_points_.reserve(most_);
  of_queried_.reserve(most_);
  queried_at_.reserve(most_);
  gaps_.reserve(most_);
}

void ContactSearch::begin(std::span<const int> members, std::span<const SkinPair> pairs,
                          const ContactLimits& limits) {
  members_ = members;
  pairs_ = pairs;
  limits_ = limits;
  change_obstacles();
}

void ContactSearch::change_obstacles() {
  for (const int k : members_) {
    if (!part(k).body->contact_points().points.empty()) part(k).near.start();
  }
}

const SkinPair& ContactSearch::pair_of(const Contact& contact) const {
  return *std::find_if(pairs_.begin(), pairs_.end(), [&](const SkinPair& pair) {
    return pair.points == contact.body && pair.skin == contact.by;
  });
}

void ContactSearch::add_contact(int body, int point, const SurfaceGap& gap) {
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

void ContactSearch::find(double shift) {
  contacts_.clear();
  for (const int k : members_) {
    ContactPart& one = part(k);
    if (one.obstacles == nullptr) continue;
    one.near.for_each(static_cast<float>(one.body->limits().band - shift), *one.obstacles,
                      [&](int point, const SurfaceGap& gap) { add_contact(k, point, gap); });
    if (!one.body->anchors().empty()) add_anchored(k, shift);
  }
  for (const SkinPair& pair : pairs_) find_between(pair);
}

// Marks the points of a body that are contacts with obstacles in is_contact_.
void ContactSearch::mark_contacts(int body, std::size_t count, char value) {
  for (std::size_t c = 0; c < count; ++c) {
    if (contacts_[c].body != body || contacts_[c].by >= 0) continue;
    is_contact_[static_cast<std::size_t>(contacts_[c].point)] = value;
  }
}

// Adds the points near obstacles that have an anchor and that the search just left out, because
// the obstacle is a little flatter now.
void ContactSearch::add_anchored(int body, double shift) {
  ContactPart& one = part(body);
  const ContactLimits& limits = one.body->limits();
  const auto band = static_cast<float>(limits.band - shift);
  const auto entry = static_cast<float>(limits.entry) / kFlatter;
  const std::size_t known = contacts_.size();
  mark_contacts(body, known, 1);
  for (const PointAnchor& anchor : one.body->anchors()) {
    if (anchor.by >= 0 || is_contact_[static_cast<std::size_t>(anchor.point)] != 0) continue;
    SurfaceGap gap;
    if (!one.near.is_near(anchor.point, band, *one.obstacles, gap)) continue;
    if (one.near.is_needed(anchor.point, gap.curvature, entry)) {
      add_contact(body, anchor.point, gap);
    }
  }
  mark_contacts(body, known, 0);
}

// Gives a contact between bodies the tangent plane at the position nearest to its point.
// @param from_foot  m, the point from the foot, frame of the other body
void ContactSearch::take_plane(Contact& contact, const NearestOnSkin& found,
                               const Vector3f& from_foot, const SkinPair& pair) {
  contact.foot_normal =
      normal_between(part(contact.body), contact.point, part(contact.by), found, pair);
  contact.normal = pair.skin_from_points.linear().transpose() * contact.foot_normal;
  contact.anchor = from_foot;
  contact.anchor_gap = found.distance + pair.overlap;
}

void ContactSearch::find_between(const SkinPair& pair) {
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

// Pressed points move away from the obstacles, and few others come near: the points that were found
// when the frame began are enough.
void ContactSearch::choose_remembered(double shift) {
  contacts_.clear();
  for (const Contact& c : found_) {
    const double band = part(c.body).body->limits().band;
    if (c.by >= 0 || c.distance < static_cast<float>(band - shift)) contacts_.push_back(c);
  }
}

// A skin that springs back after an obstacle left may move by more than the band, so that points
// which were no contacts enter an obstacle.
bool ContactSearch::add_entered(double shift) {
  const std::size_t known = contacts_.size();
  for (const int k : members_) {
    ContactPart& one = part(k);
    const double band = one.body->limits().band;
    if (one.obstacles == nullptr || !one.body->has_moved(band)) continue;
    mark_contacts(k, known, 1);
    one.near.for_each(-static_cast<float>(kEntered * band + shift), *one.obstacles,
                      [&](int point, const SurfaceGap& gap) {
                        if (is_contact_[static_cast<std::size_t>(point)] == 0)
                          add_contact(k, point, gap);
                      });
    mark_contacts(k, known, 0);
  }
  return contacts_.size() > known;
}

bool ContactSearch::find_feet_again() {
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
  for (const SkinPair& pair : pairs_) find_between(pair);
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
    c.friction = before->friction;
    c.rub = before->rub;
    if (!c.friction.isZero(0)) c.force += c.friction;
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
void ContactSearch::thin(int body) {
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
      auto entry = static_cast<float>(std::ldexp(limits.entry, coarser));
      if (c.is_anchored) entry /= kFlatter;
      return !part(body).near.is_needed(c.point, c.curvature, entry);
    });
  }
}

bool ContactSearch::add_places(const Contact& contact) {
  ContactPart& one = part(contact.body);
  if (!one.body->add_place(contact.point)) return false;
  ++one.places;
  if (contact.by < 0) return true;
  ContactPart& other = part(contact.by);
  if (!other.body->add_place(contact.foot)) return false;
  ++other.places;
  return true;
}

// Notes which contacts have an anchor in the states.
void ContactSearch::note_anchored() {
  for (Contact& c : contacts_) {
    const std::vector<PointAnchor>& anchors = part(c.body).body->anchors();
    c.is_anchored = !anchors.empty() && number_of_anchor(anchors, c.point, c.by) >= 0;
  }
}

int ContactSearch::keep_nearest() {
  note_anchored();
  for (const int k : members_) thin(k);
  const auto counts_as = [](const Contact& c) {
    return c.is_anchored ? c.distance - kNearerIfAnchored : c.distance;
  };
  std::sort(contacts_.begin(), contacts_.end(), [&](const Contact& a, const Contact& b) {
    const float one = counts_as(a), other = counts_as(b);
    if (one != other) return one < other;
    return std::array{a.point, a.body, a.by} < std::array{b.point, b.body, b.by};
  });
  for (const int k : members_) {
    part(k).body->clear_places();
    part(k).places = 0;
  }
  std::size_t kept = 0;
  while (kept < contacts_.size() && kept < most_ && add_places(contacts_[kept])) ++kept;
  const auto dropped = static_cast<int>(contacts_.size() - kept);
  contacts_.resize(kept);
  return dropped;
}

// --- gaps

// Gaps of a body's contact points to its obstacles, in one query.
void ContactSearch::find_gaps_of(int body, double shift) {
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
void ContactSearch::find_gap_between(Contact& c) {
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

void ContactSearch::find_gaps(double shift) {
  for (const int k : members_) find_gaps_of(k, shift);
  for (Contact& c : contacts_) {
    if (c.by >= 0) find_gap_between(c);
  }
}

}  // namespace palpable
