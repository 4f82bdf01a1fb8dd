#include "palpable/live/things/pressed_bodies.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/moving_surface.h"
#include "palpable/common/contact/sharp_part.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_solver.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace palpable {
namespace {

// Largest number of capsules whose ways are looked at in a call.
constexpr int kMostLooked = 64;

Capsule moved_by(const Rigid3& pose, const Capsule& capsule) {
  return {pose * capsule.a, pose * capsule.b, capsule.ra, capsule.rb};
}

// Whether a thin axis between two points is inside a skin somewhere, deeper than contact leaves.
bool is_inside(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const MovingSurface& skin) {
  return depth_of({a.cast<float>(), b.cast<float>(), 0, 0}, skin) > kReached;
}

// Whether the way of an end or of the middle of a capsule leads through a skin.
bool leads_through(const Capsule& before, const Capsule& now, const MovingSurface& skin) {
  return is_inside(before.a, now.a, skin) || is_inside(before.b, now.b, skin) ||
         is_inside((before.a + before.b) / 2, (now.a + now.b) / 2, skin);
}

}  // namespace

struct PressedBodies::Pressed {
  explicit Pressed(Member member)
      : body(std::move(member.body)),
        world_from_body(member.world_from_body),
        body_from_world(member.world_from_body.inverse()),
        contact(body->body.surface, body->body.fixed, *body->touch,
                {.friction = member.friction, .inertia = member.dynamics}) {
    constexpr std::size_t kMost = 2 * std::size_t{kMostPlacesWithOthers};
    moved.reserve(kMost);
    places.reserve(kMost);
    gaps.reserve(kMost);
  }

  std::shared_ptr<const TouchableBody> body;
  Rigid3 world_from_body, body_from_world;
  SkinContact contact;
  TouchState state;
  CapsuleObstacles obstacles;
  std::vector<Capsule> capsules, capsules_before;  // body frame, of this call and of the last one
  std::optional<StatedError> stated;
  std::vector<Touch> touches;
  // Of the points with force: m, displacement and position, and what presses there.
  std::vector<Eigen::Vector3f> moved, places;
  std::vector<SurfaceGap> gaps;
};

PressedBodies::PressedBodies(std::vector<Member> members) {
  PALPABLE_EXPECT(!members.empty(), "a body to press");
  for (Member& member : members) {
    PALPABLE_EXPECT(member.body->touch.has_value(), "a body with tables of touch");
    bodies_.push_back(std::make_unique<Pressed>(std::move(member)));
  }
  if (bodies_.size() < 2) return;
  std::vector<ContactSolver::Member> solved;
  for (const auto& body : bodies_) {
    body->contact.solver().body().use(body->state);
    solved.push_back({&body->contact.solver().body(), body->world_from_body});
  }
  together_.emplace(solved);
}

PressedBodies::~PressedBodies() = default;

// Takes over the capsules of a call, in the frame of each body, too.
void PressedBodies::take(std::span<const CapsuleThing> things) {
  std::swap(outside_, outside_before_);
  std::swap(runs_, runs_before_);
  count_before_ = capsules_.size();
  capsules_.clear();
  runs_.clear();
  things_.clear();
  friction_.clear();
  for (std::size_t t = 0; t < things.size(); ++t) {
    runs_.push_back({things[t].id, capsules_.size(), things[t].capsules.size()});
    capsules_.insert(capsules_.end(), things[t].capsules.begin(), things[t].capsules.end());
    things_.insert(things_.end(), things[t].capsules.size(), static_cast<int>(t));
    friction_.insert(friction_.end(), things[t].capsules.size(), things[t].friction);
  }
  match_capsules();
  for (const auto& body : bodies_) {
    body->capsules.swap(body->capsules_before);
    body->capsules.clear();
    for (const Capsule& capsule : capsules_) {
      body->capsules.push_back(moved_by(body->body_from_world, capsule));
    }
    body->obstacles.set(body->capsules, things_);
    body->obstacles.set_friction(friction_, body->capsules_before, now_of_);
  }
}

// Finds what has become of each capsule of the last call: the one with its number in the thing with
// its id.
void PressedBodies::match_capsules() {
  now_of_.assign(count_before_, -1);
  for (std::size_t t = 0; t < runs_.size(); ++t) {
    const Run* run = run_before(t);
    if (run == nullptr) continue;
    for (std::size_t k = 0; k < run->count; ++k) {
      now_of_[run->first + k] = static_cast<int>(runs_[t].first + k);
    }
  }
}

ContactReport PressedBodies::solve(std::optional<double> time) {
  if (!together_) {
    Pressed& body = *bodies_.front();
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    const TouchReport report =
        body.contact.solver().advance(body.state, body.obstacles, kNoLimit, time);
    body.stated = report.stated;
    return report;
  }
  near_.clear();
  for (const auto& body : bodies_) near_.push_back({&body->obstacles});
  const ContactReport report = together_->advance(near_, time);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Pressed& body = *bodies_[k];
    body.stated = report_of(body.contact.solver().body(), *together_, static_cast<int>(k)).stated;
  }
  return report;
}

void PressedBodies::find_touches(Pressed& body, int number) {
  std::span<const PressedPoint> others;
  if (together_) others = together_->pressed_by_others(number);
  body.touches.clear();
  // Only several things have to be told apart.
  const bool several = runs_.size() > 1;
  body.contact.find_touches(body.state, several ? &body.obstacles : nullptr, others, body.touches);
  for (Touch& touch : body.touches) {
    touch.body = number;
    if (!several && touch.by < 0) touch.thing = 0;
    touch.coefficient = coefficient_of(touch, body);
  }
}

// Coulomb's coefficient between a body and what presses it.
double PressedBodies::coefficient_of(const Touch& touch, Pressed& body) const {
  const double of_body = body.contact.solver().body().friction();
  if (touch.by >= 0) {
    Pressed& other = *bodies_[static_cast<std::size_t>(touch.by)];
    return friction_between(of_body, other.contact.solver().body().friction());
  }
  const auto thing = static_cast<std::size_t>(touch.thing);
  if (touch.thing < 0 || thing >= runs_.size() || runs_[thing].count == 0) return 0;
  return static_cast<double>(
      friction_coefficient(friction_[runs_[thing].first], static_cast<float>(of_body)));
}

void PressedBodies::show(Pressed& body, SceneBody& shown) const {
  const SurfaceMesh& skin = body.body->body.surface;
  shown.vertices.resize(3, skin.vertex_count());
  shown.normals.resize(3, skin.vertex_count());
  shown.von_mises.resize(static_cast<std::size_t>(skin.vertex_count()));
  body.contact.place(body.state, shown.vertices);
  vertex_normals(shown.vertices, skin.triangles, shown.normals);
  shown.cauchy.resize(extras_.components ? 6 * shown.von_mises.size() : 0);
  body.contact.stress(body.state, shown.von_mises, shown.cauchy);
  shown.contact_pressure.clear();
  if (extras_.contact_pressure) {
    body.contact.find_pressure(shown.vertices, shown.normals, shown.contact_pressure);
  }
  shown.stated_error = body.stated;
}

ContactReport PressedBodies::advance(std::span<const CapsuleThing> things,
                                     std::span<SceneBody> shown, std::vector<Touch>& touches,
                                     std::optional<double> time) {
  PALPABLE_EXPECT(shown.size() == bodies_.size(), "a shown body for each body");
  take(things);
  const ContactReport report = solve(time);
  passed_through_ = count_passed(report.inside() > kReached);
  touches.clear();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Pressed& body = *bodies_[k];
    find_touches(body, static_cast<int>(k));
    const int dropped =
        together_ ? together_->report_of(static_cast<int>(k)).dropped : report.dropped;
    for (Touch& touch : body.touches) touch.left_out = dropped;
    touches.insert(touches.end(), body.touches.begin(), body.touches.end());
    show(body, shown[k]);
  }
  sort_by_force(touches);
  return report;
}

ContactReport PressedBodies::tick(std::span<const CapsuleThing> things,
                                  std::span<ThingForce> forces, double time) {
  PALPABLE_EXPECT(forces.size() == things.size(), "a force for each thing");
  take(things);
  ContactReport report;
  if (together_ || !(time > 0)) {
    report = solve(time);
  } else {
    Pressed& body = *bodies_.front();
    report = body.contact.solver().tick(body.state, body.obstacles, time, way_of_things());
  }
  follow_outside(report.penetration > kReached);
  std::fill(forces.begin(), forces.end(), ThingForce{});
  for (const auto& body : bodies_) add_forces(*body, forces);
  return report;
}

// m, no thing has come farther since the last call; infinite if one was not there.
double PressedBodies::way_of_things() const {
  for (std::size_t t = 0; t < runs_.size(); ++t) {
    if (runs_[t].count > 0 && run_before(t) == nullptr) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return static_cast<double>(bodies_.front()->obstacles.largest_way());
}

// After a tick: capsules that advance by less than their radius, and are not inside of a body, are
// outside now; of others it is not known.
void PressedBodies::follow_outside(bool is_any_inside) {
  outside_ = capsules_;
  for (std::size_t t = 0; t < runs_.size(); ++t) {
    const Run* run = run_before(t);
    if (run == nullptr) continue;
    for (std::size_t k = 0; k < run->count; ++k) {
      const Capsule& was = outside_before_[run->first + k];
      Capsule& is = outside_[runs_[t].first + k];
      const double advanced = std::max((is.a - was.a).norm(), (is.b - was.b).norm());
      if (is_any_inside || advanced > std::min(is.ra, is.rb)) is = was;
    }
  }
}

// Adds what a body does to the things after a tick.
void PressedBodies::add_forces(Pressed& body, std::span<ThingForce> forces) {
  body.contact.solver().find_moved(body.state, body.moved);
  body.places.clear();
  for (std::size_t k = 0; k < body.moved.size(); ++k) {
    body.places.push_back(body.contact.solver().places().col(body.state.forces[k].point) +
                          body.moved[k]);
  }
  body.gaps.resize(body.places.size());
  body.obstacles.find_gaps(body.places, body.gaps);
  for (std::size_t k = 0; k < body.places.size(); ++k) {
    const PointForce& at = body.state.forces[k];
    const int thing = body.gaps[k].thing;
    if (at.by >= 0 || thing < 0) continue;
    ThingForce& sum = forces[static_cast<std::size_t>(thing)];
    const Eigen::Vector3d force = -(body.world_from_body.linear() * at.force.cast<double>());
    sum.force += force;
    sum.torque += (body.world_from_body * body.places[k].cast<double>()).cross(force);
  }
}

PressedBodies::Passage PressedBodies::passage_of(const Capsule& before, const Capsule& now) const {
  Passage passage = Passage::kNone;
  for (const auto& body : bodies_) {
    const Capsule was = moved_by(body->body_from_world, before);
    const Capsule is = moved_by(body->body_from_world, now);
    const MovingSurface& skin = body->contact.solver().body().surface();
    if (is_inside(is.a, is.b, skin)) return Passage::kInto;
    if (!is_inside(was.a, was.b, skin) && leads_through(was, is, skin)) passage = Passage::kThrough;
  }
  return passage;
}

void PressedBodies::forget() {
  for (const auto& body : bodies_) {
    body->state = TouchState();
    body->contact.solver().drop_ticks();
    if (together_) body->contact.solver().body().use(body->state);
  }
  outside_.clear();
  runs_.clear();
  capsules_.clear();
  for (const auto& body : bodies_) body->capsules.clear();
  passed_through_ = 0;
}

// The capsules that the thing had in the last call; null: it was not there, or had another number
// of them.
const PressedBodies::Run* PressedBodies::run_before(std::size_t number) const {
  const Run& now = runs_[number];
  const auto is_same = [&](const Run& run) { return run.id == now.id; };
  // Callers name their things in the same order in most calls.
  const Run* same = number < runs_before_.size() && is_same(runs_before_[number])
                        ? &runs_before_[number]
                        : nullptr;
  if (same == nullptr) {
    const auto found = std::find_if(runs_before_.begin(), runs_before_.end(), is_same);
    if (found != runs_before_.end()) same = &*found;
  }
  return same != nullptr && same->count == now.count ? same : nullptr;
}

// Also remembers where each capsule was outside of the skins for the last time. Capsules that are
// slow are outside, unless an obstacle was reported inside of a body.
int PressedBodies::count_passed(bool is_any_inside) {
  int passed = 0, looked = 0;
  outside_ = capsules_;
  for (std::size_t t = 0; t < runs_.size(); ++t) {
    const Run* run = run_before(t);
    if (run == nullptr) continue;
    for (std::size_t k = 0; k < run->count && looked < kMostLooked; ++k) {
      const Capsule& was = outside_before_[run->first + k];
      const Capsule& is = capsules_[runs_[t].first + k];
      const double advanced = std::max((is.a - was.a).norm(), (is.b - was.b).norm());
      if (!is_any_inside && !(advanced > std::min(is.ra, is.rb))) continue;
      ++looked;
      const Passage passage = passage_of(was, is);
      passed += passage == Passage::kThrough;
      if (passage == Passage::kInto) outside_[runs_[t].first + k] = was;
    }
  }
  return passed;
}

}  // namespace palpable
