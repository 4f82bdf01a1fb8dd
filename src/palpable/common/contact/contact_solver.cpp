#include "palpable/common/contact/contact_solver.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// m. Two skins cannot touch in a frame if their boxes are farther apart than
// kBesideBody + min(kFastest, step limit); kBesideBody covers the band in which contacts are
// sought.
constexpr float kBesideBody = 0.004f, kFastest = 0.05f;
// m, smallest gap between bodies at rest. Without it rounding of positions in single precision
// would cause tiny forces, and bodies at rest would be solved in every frame.
constexpr float kStandsOff = 2e-5f;
// A tick may be late. This many of the steps that a body needs (ContactBody::steps_in()) are one.
constexpr int kMostStepsOfTick = 2;

// (F) m, distance of each vertex from the nearest one on a sharp edge; 1 if there is none.
std::vector<float> distances_from_edges(const MovingSurface& skin) {
  const std::vector<int> edges = skin.sharp_vertices();
  const Eigen::Index F = skin.vertex_count();
  std::vector<float> distances(static_cast<std::size_t>(F), 1.0f);
  for (Eigen::Index v = 0; v < F; ++v) {
    float& nearest = distances[static_cast<std::size_t>(v)];
    for (const int e : edges) {
      nearest = std::min(nearest, (skin.vertex(static_cast<int>(v)) - skin.vertex(e)).norm());
    }
  }
  return distances;
}

}  // namespace

struct ContactSolver::Work {
  struct Member {
    explicit Member(Rigid3 pose) : world_from_body(std::move(pose)) {}
    Rigid3 world_from_body;
    double largest_move = 0;  // m, ContactSolver::Near
    bool is_awake = false;
    int group = 0;  // the lowest index of the members that are solved together
    bool is_at_rest = true;
    ContactReport report;
    std::vector<PressedPoint> pressed, pressed_before;
  };

  explicit Work(const std::vector<ContactSolver::Member>& all);
  void pair_up();
  [[nodiscard]] bool is_obstacle_near(std::size_t k) const;
  [[nodiscard]] bool are_near(const SkinPair& pair, float beside) const;
  void find_groups();
  void solve(int group, std::optional<double> time);
  void find_pressed();
  [[nodiscard]] double imbalance() const;

  std::vector<Member> members;
  std::vector<ContactPart> parts;
  std::vector<SkinPair> pairs;
  std::vector<int> solved;             // members of a group
  std::vector<SkinPair> solved_pairs;  // and their pairs
  std::unique_ptr<ContactFrame> frame;
};

ContactSolver::Work::Work(const std::vector<ContactSolver::Member>& all) {
  PALPABLE_EXPECT(!all.empty(), "a solver has a member");
  parts.reserve(all.size());  // a copy of one would lose the memory that it has reserved
  for (const ContactSolver::Member& one : all) {
    members.emplace_back(one.world_from_body);
    parts.emplace_back(*one.body);
  }
  solved.reserve(all.size());
  if (all.size() == 1) {
    frame = std::make_unique<ContactFrame>(parts, kMostPlaces);
    return;
  }
  for (ContactPart& part : parts) part.body->make_room_for_others();
  pair_up();
  frame = std::make_unique<ContactFrame>(parts, kMostPlacesWithOthers);
  for (Member& member : members) {
    member.pressed.reserve(2 * std::size_t{kMostPlacesWithOthers});
    member.pressed_before.reserve(2 * std::size_t{kMostPlacesWithOthers});
  }
}

// Makes the pairs of bodies. The contact points of the first body of a pair are searched on the
// skin of the second one. The points of the second are searched on the first one's skin as well if
// the second has sharp edges, which may lie between two points of the first, or if the first has no
// points.
void ContactSolver::Work::pair_up() {
  for (ContactPart& part : parts) part.edge_distance = distances_from_edges(part.body->surface());
  const int count = static_cast<int>(parts.size());
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const auto has_points = [&](int k) {
    return !parts[at(k)].body->contact_points().points.empty();
  };
  const auto has_edges = [&](int k) {
    const std::vector<float>& distances = parts[at(k)].edge_distance;
    return std::any_of(distances.begin(), distances.end(), [](float d) { return d < 1; });
  };
  for (int points = 0; points < count; ++points) {
    for (int skin = 0; skin < count; ++skin) {
      if (skin == points || !has_points(points)) continue;
      if (skin < points && has_points(skin) && !has_edges(points)) continue;
      SkinPair pair{points, skin};
      pair.skin_from_points =
          (members[at(skin)].world_from_body.inverse() * members[at(points)].world_from_body)
              .cast<float>();
      const MovingSurface& surface = parts[at(skin)].body->surface();
      for (const int point : parts[at(points)].near.between()) {
        const auto found = surface.nearest(
            pair.skin_from_points * parts[at(points)].body->shape_at(point), kGapReach);
        if (found) pair.overlap = std::max(pair.overlap, kStandsOff - found->distance);
      }
      pairs.push_back(pair);
    }
  }
  solved_pairs.reserve(pairs.size());
}

bool ContactSolver::Work::is_obstacle_near(std::size_t k) const {
  const ContactPart& part = parts[k];
  if (part.obstacles == nullptr) return false;
  const AlignedBox3f box = part.body->bounds();
  return part.obstacles->may_be_within(
      box.center(), 0.5f * box.diagonal().norm() + static_cast<float>(part.body->limits().band));
}

bool ContactSolver::Work::are_near(const SkinPair& pair, float beside) const {
  AlignedBox3f box = parts[static_cast<std::size_t>(pair.points)].body->bounds().transformed(
      pair.skin_from_points);
  box.min().array() -= beside;
  box.max().array() += beside;
  return box.intersects(parts[static_cast<std::size_t>(pair.skin)].body->bounds());
}

// Finds the members that are solved in this frame, in groups: an obstacle that presses one body may
// press it against the next one.
void ContactSolver::Work::find_groups() {
  double largest_move = 0;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Member& member = members[k];
    largest_move = std::max(largest_move, member.largest_move);
    member.group = static_cast<int>(k);
    member.is_awake =
        !parts[k].body->is_at_rest() || member.report.left_to_move > 0 || is_obstacle_near(k);
  }
  double swing = 0;
  for (const ContactPart& part : parts) swing = std::max(swing, part.body->amplitude());
  const float beside = kBesideBody + std::min(kFastest, static_cast<float>(largest_move)) +
                       4 * static_cast<float>(swing);  // both to and fro
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (const SkinPair& pair : pairs) {
      Member &a = members[static_cast<std::size_t>(pair.points)],
             &b = members[static_cast<std::size_t>(pair.skin)];
      if (a.group == b.group || (!a.is_awake && !b.is_awake) || !are_near(pair, beside)) continue;
      const auto [lower, higher] = std::minmax(a.group, b.group);
      for (Member& member : members) {
        if (member.group == higher) member.group = lower;
      }
      is_new = a.is_awake = b.is_awake = true;
    }
  }
}

void ContactSolver::Work::solve(int group, std::optional<double> time) {
  double largest_move = 0;
  solved.clear();
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (members[k].group != group) continue;
    solved.push_back(static_cast<int>(k));
    largest_move = std::max(largest_move, members[k].largest_move);
  }
  solved_pairs.clear();
  for (const SkinPair& pair : pairs) {
    if (members[static_cast<std::size_t>(pair.points)].group == group &&
        members[static_cast<std::size_t>(pair.skin)].group == group) {
      solved_pairs.push_back(pair);
    }
  }
  for (const int k : solved) {
    Member& member = members[static_cast<std::size_t>(k)];
    member.pressed_before.swap(member.pressed);
    member.pressed.clear();
  }
  ContactReport report = frame->solve(solved, solved_pairs, largest_move, time);
  if (!solved_pairs.empty()) find_pressed();
  report.imbalance = imbalance();
  for (const int k : solved) {
    Member& member = members[static_cast<std::size_t>(k)];
    member.report = report;
    member.is_at_rest = parts[static_cast<std::size_t>(k)].body->forces().empty() &&
                        member.pressed.empty() && !(report.left_to_move > 0) &&
                        !(parts[static_cast<std::size_t>(k)].body->ringing() > 0);
  }
}

// Collects the points at which other members press. Where the step limit holds, forces are
// interpolated between the frame before and this one.
void ContactSolver::Work::find_pressed() {
  for (const Contact& c : frame->contacts()) {
    if (c.by < 0 || !(c.pressing > 0)) continue;
    ContactBody& other = *parts[static_cast<std::size_t>(c.by)].body;
    const auto share = static_cast<float>(parts[static_cast<std::size_t>(c.by)].share_gone);
    const Vector3f x = other.shape_at(c.foot);
    members[static_cast<std::size_t>(c.by)].pressed.push_back(
        {x, x - other.rest_at(c.foot),
         -share * (frame->pair_of(c).skin_from_points.linear() * c.force),
         static_cast<float>(c.area), c.body,
         -share * (frame->pair_of(c).skin_from_points.linear() * c.friction)});
  }
  for (const int k : solved) {
    Member& member = members[static_cast<std::size_t>(k)];
    const auto share = static_cast<float>(parts[static_cast<std::size_t>(k)].share_gone);
    if (share == 1) continue;
    for (PressedPoint& point : member.pressed_before) {
      point.force *= 1 - share;
      point.friction *= 1 - share;
      if (member.pressed.size() < member.pressed.capacity()) member.pressed.push_back(point);
    }
  }
}

// N, norm of the sum of all forces between the members that were solved last.
double ContactSolver::Work::imbalance() const {
  Vector3d sum = Vector3d::Zero();
  for (const int k : solved) {
    const Member& member = members[static_cast<std::size_t>(k)];
    Vector3d on_body = Vector3d::Zero();
    for (const PointForce& at : parts[static_cast<std::size_t>(k)].body->forces()) {
      if (at.by >= 0) on_body += at.force.cast<double>();
    }
    for (const PressedPoint& point : member.pressed) on_body += point.force.cast<double>();
    sum += member.world_from_body.linear() * on_body;
  }
  return sum.norm();
}

ContactSolver::ContactSolver(const std::vector<Member>& members)
    : work_(std::make_unique<Work>(members)) {}
ContactSolver::~ContactSolver() = default;
ContactSolver::ContactSolver(ContactSolver&&) noexcept = default;

ContactReport ContactSolver::advance(std::span<const Near> near, std::optional<double> time) {
  Work& w = *work_;
  PALPABLE_EXPECT(near.size() == w.parts.size(), "a Near for each member");
  end_ticks();
  for (std::size_t k = 0; k < w.parts.size(); ++k) {
    w.parts[k].obstacles = near[k].obstacles;
    w.members[k].largest_move = near[k].largest_move;
    w.parts[k].body->begin_frame();
  }
  if (w.parts.size() == 1) {
    w.solve(0, time);
    return w.members.front().report;
  }
  w.find_groups();
  ContactReport all;
  for (std::size_t k = 0; k < w.members.size(); ++k) {
    Work::Member& member = w.members[k];
    if (member.group != static_cast<int>(k)) continue;
    const bool is_awake = std::any_of(w.members.begin(), w.members.end(), [&](const auto& one) {
      return one.group == static_cast<int>(k) && one.is_awake;
    });
    if (!is_awake) {
      member.report = {};
      continue;
    }
    w.solve(static_cast<int>(k), time);
    const ContactReport& one = member.report;
    all.candidates += one.candidates;
    all.dropped += one.dropped;
    all.steps = std::max(all.steps, one.steps);
    all.rounds = std::max(all.rounds, one.rounds);
    all.iterations += one.iterations;
    all.last_change = std::max(all.last_change, one.last_change);
    all.penetration = std::max(all.penetration, one.penetration);
    all.mutual_penetration = std::max(all.mutual_penetration, one.mutual_penetration);
    all.imbalance = std::max(all.imbalance, one.imbalance);
    all.left_to_move = std::max(all.left_to_move, one.left_to_move);
    all.friction_residual = std::max(all.friction_residual, one.friction_residual);
    all.dissipated += one.dissipated;
    all.ringing += one.ringing;
    all.stuck |= one.stuck;
    all.inside_before = std::max(all.inside_before, one.inside_before);
    all.points_inside = std::max(all.points_inside, one.points_inside);
    all.held_inside = std::max(all.held_inside, one.held_inside);
    all.sharp_inside = std::max(all.sharp_inside, one.sharp_inside);
  }
  return all;
}

ContactReport ContactSolver::tick(const Near& near, double h, double way) {
  Work& w = *work_;
  PALPABLE_EXPECT(w.parts.size() == 1 && h > 0, "a tick of one body");
  ContactBody& body = *w.parts.front().body;
  Work::Member& member = w.members.front();
  // Where the solution was not reached, a frame goes on towards it without giving velocity.
  const bool is_solved = !member.report.stuck && !(member.report.left_to_move > kReached);
  if (!is_solved || !(way <= body.limits().largest_step) || body.steps_in(h) > kMostStepsOfTick) {
    return advance({&near, 1}, h);
  }
  w.parts.front().obstacles = near.obstacles;
  if (!w.frame->ticks()) body.begin_frame();
  w.solved.assign(1, 0);
  member.report = w.frame->tick(w.solved, h, way);
  member.is_at_rest = false;
  return member.report;
}

void ContactSolver::end_ticks() { work_->frame->end_ticks(); }
bool ContactSolver::ticks() const { return work_->frame->ticks(); }
void ContactSolver::drop_ticks() { work_->frame->drop_ticks(); }
std::span<const Contact> ContactSolver::contacts() const { return work_->frame->contacts(); }

Eigen::Vector3f ContactSolver::position_of(const Contact& contact) const {
  return work_->parts[static_cast<std::size_t>(contact.body)].body->position(contact.place);
}

const ContactReport& ContactSolver::report_of(int member) const {
  return work_->members[static_cast<std::size_t>(member)].report;
}

double ContactSolver::penetration_of(int member) const {
  return work_->parts[static_cast<std::size_t>(member)].penetration;
}

std::span<const PressedPoint> ContactSolver::pressed_by_others(int member) const {
  return work_->members[static_cast<std::size_t>(member)].pressed;
}

bool ContactSolver::is_at_rest(int member) const {
  return work_->members[static_cast<std::size_t>(member)].is_at_rest;
}

}  // namespace palpable
