#include "palpable/common/contact/pressing_bodies.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/yielding_skin.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/refinement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace palpable {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Matrix3Xf;
using Eigen::Vector3f;

constexpr int kMostRounds = 3;
// m: a round that moves no vertex by more is the last one; as TouchSettings::tolerance.
constexpr double kTolerance = 2e-5;
// m between two skins' boxes, beyond which nothing of the one is asked of the other.
constexpr float kBesideBody = 0.004f;

constexpr float kFastest = 0.02f;  // m that a body may come nearer in a frame
// m by which bodies at rest stand off each other at least: what is told of their places is rounded,
// and a force of nothing would keep both awake.
constexpr float kStandsOff = 2e-5f;

double farthest_apart(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>(std::sqrt((a - b).colwise().squaredNorm().maxCoeff()));
}

}  // namespace

// What presses a body: what is seen, or the skin of another one, whichever is nearer.
class PressingBodies::AroundBody : public Obstacles {
 public:
  AroundBody(PressingBodies& all, int body) : all_(&all), body_(body) {}

  void find_gaps(std::span<const Vector3f> places, std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Vector3f& place, float reach) const override;
  void add_compliance(std::span<const YieldingPoint> points, std::span<double> W) const override;

 private:
  PressingBodies* all_;  // whose memory it works in: bodies are answered one after the other
  int body_;
};

// One of the bodies.
struct PressingBodies::Part {
  explicit Part(const Body& the_body)
      : body(the_body),
        skin(*the_body.skin, the_body.tables),
        placed(the_body.skin->vertices.cast<float>()) {
    if (!has_answer()) return;
    if (body.seen != nullptr) body.obstacles = body.seen;
    PALPABLE_EXPECT(body.obstacles != nullptr, "something may press a body that is answered");
    constexpr std::size_t kMost = 4 * TouchSolver::kMostPoints;
    given.reserve(9 * kMost);
    pressed_by.reserve(kMost);
  }

  [[nodiscard]] bool has_answer() const { return body.contact != nullptr; }
  [[nodiscard]] bool is_near_real() const {
    if (body.seen != nullptr) return !body.seen->balls().empty();
    const AlignedBox3f box = skin.surface().bounds();
    return body.obstacles->may_be_within(box.center(), 0.5f * box.diagonal().norm() + kBesideBody);
  }
  // By itself: something presses it, or did in the frame before.
  [[nodiscard]] bool is_awake() const {
    if (!has_answer()) return has_moved;
    return is_near_real() || !body.state->forces.empty() || bears || report.held_back > 0 ||
           body.state->u.cols() == 0;
  }

  Body body;
  YieldingSkin skin;
  Matrix3Xf placed;        // (3 x F) m, where it is
  bool has_moved = false;  // of an obstacle: it is not at rest

  std::optional<AroundBody> around;      // what presses it: what is seen, and other bodies
  std::vector<VertexForce> given;        // N, what other bodies' points press it with
  std::vector<PressedPoint> pressed_by;  // the same where they do
  Vector3f load = Vector3f::Zero();      // N, sum of the given forces of its last answer
  bool bears = false;                    // there were some
  bool takes_part = false;               // in this frame
  Matrix3Xf began, before;               // (3 x W) m: u before the frame, and before a round
  TouchReport report;
};

// Contact points of one body before the skin of another.
struct PressingBodies::Pair {
  int points = 0, skin = 0;
  Eigen::Isometry3f to_skin = Eigen::Isometry3f::Identity();  // from the points' frame
  float overlap = 0;  // m, added to gaps, by which they stand in each other at rest
  bool is_near = false;
};

PressingBodies::PressingBodies(const std::vector<Body>& bodies) {
  for (const Body& body : bodies) parts_.push_back(std::make_unique<Part>(body));
  for (int k = 0; k < static_cast<int>(parts_.size()); ++k) {
    if (part(k).has_answer()) part(k).around.emplace(*this, k);
  }
  pair_up();
  constexpr std::size_t m = TouchSolver::kMostPoints;
  moved_.reserve(2 * m);
  places_.reserve(m);
  gaps_.reserve(m);
  of_one_.reserve(m);
  which_of_one_.reserve(m);
  yield_.resize(m * m);
}
PressingBodies::~PressingBodies() = default;

// Of two bodies with tables the first one's points, before the other one's skin.
void PressingBodies::pair_up() {
  const int count = static_cast<int>(parts_.size());
  for (int points = 0; points < count; ++points) {
    if (!part(points).has_answer()) continue;
    for (int skin = 0; skin < count; ++skin) {
      if (skin == points || (skin < points && part(skin).has_answer())) continue;
      Pair pair{points, skin};
      pair.to_skin = (part(skin).body.world_from_body.inverse() * part(points).body.world_from_body)
                         .cast<float>();
      const MovingSurface& surface = part(skin).skin.surface();
      for (const auto& place : part(points).body.contact->solver().places().colwise()) {
        const auto found = surface.nearest(pair.to_skin * Vector3f(place), kGapReach);
        if (found) pair.overlap = std::max(pair.overlap, kStandsOff - found->distance);
      }
      pairs_.push_back(pair);
    }
  }
}

void PressingBodies::AroundBody::find_gaps(std::span<const Vector3f> places,
                                           std::span<SurfaceGap> gaps) const {
  all_->part(body_).body.obstacles->find_gaps(places, gaps);
  for (const Pair& pair : all_->pairs_) {
    if (pair.points != body_ || !pair.is_near) continue;
    std::vector<Vector3f>& on_skin = all_->places_;
    on_skin.clear();
    for (const Vector3f& place : places) on_skin.push_back(pair.to_skin * place);
    all_->gaps_.resize(places.size());
    all_->part(pair.skin).skin.find_gaps(on_skin, all_->gaps_);
    const Eigen::Matrix3f turn = pair.to_skin.linear();
    for (std::size_t k = 0; k < places.size(); ++k) {
      SurfaceGap& other = all_->gaps_[k];
      other.distance += pair.overlap;
      if (!(other.distance < gaps[k].distance)) continue;
      other.normal = turn.transpose() * other.normal;
      other.curvature = turn.transpose() * other.curvature * turn;
      other.on.body = pair.skin;
      gaps[k] = other;
    }
  }
}

bool PressingBodies::AroundBody::may_be_within(const Vector3f& place, float reach) const {
  if (all_->part(body_).body.obstacles->may_be_within(place, reach)) return true;
  return std::any_of(all_->pairs_.begin(), all_->pairs_.end(), [&](const Pair& pair) {
    return pair.points == body_ && pair.is_near &&
           all_->part(pair.skin).skin.may_be_within(pair.to_skin * place, reach);
  });
}

void PressingBodies::AroundBody::add_compliance(std::span<const YieldingPoint> points,
                                                std::span<double> W) const {
  const std::size_t m = points.size();
  std::vector<YieldingPoint>& of_one = all_->of_one_;
  std::vector<std::size_t>& which = all_->which_of_one_;
  for (const Pair& pair : all_->pairs_) {
    const Part& other = all_->part(pair.skin);
    if (pair.points != body_ || !pair.is_near || !other.skin.gives_way()) continue;
    of_one.clear();
    which.clear();
    for (std::size_t p = 0; p < m; ++p) {
      if (points[p].on.body != pair.skin) continue;
      of_one.push_back({points[p].on, pair.to_skin.linear() * points[p].normal});
      which.push_back(p);
    }
    const std::size_t n = of_one.size();
    const std::span<double> yield(all_->yield_.data(), n * n);
    std::fill(yield.begin(), yield.end(), 0.0);
    other.skin.add_compliance(of_one, yield);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) { W[which[i] * m + which[j]] += yield[i * n + j]; }
    }
  }
}

// Who takes part in this frame, and which skins are so near to each other that they may touch.
void PressingBodies::find_near_pairs() {
  for (const auto& p : parts_) p->takes_part = p->is_awake();
  // What presses one body may bring it to the next.
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (Pair& pair : pairs_) {
      Part &a = part(pair.points), &b = part(pair.skin);
      if (pair.is_near || (!a.takes_part && !b.takes_part)) continue;
      AlignedBox3f box = a.skin.surface().bounds().transformed(pair.to_skin);
      const float beside = kBesideBody + std::min(kFastest, static_cast<float>(move_));
      box.min().array() -= beside;
      box.max().array() += beside;
      if (!box.intersects(b.skin.surface().bounds())) continue;
      pair.is_near = is_new = true;
      a.takes_part = b.takes_part = true;
    }
  }
}

// Forces on a body's skin by the points of others, as they were answered last.
void PressingBodies::gather_given(int body) {
  Part& b = part(body);
  b.given.clear();
  b.pressed_by.clear();
  for (const Pair& pair : pairs_) {
    if (pair.skin != body) continue;
    const Part& a = part(pair.points);
    TouchSolver& solver = a.body.contact->solver();
    solver.find_moved(*a.body.state, moved_);
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      const PointForce& at = a.body.state->forces[k];
      if (at.by != body) continue;
      const Vector3f place = pair.to_skin * (solver.places().col(at.point) + moved_[k]);
      const Vector3f force = -(pair.to_skin.linear() * at.force);
      OtherSkin on;
      if (!b.skin.find(place, on)) {
        report_.imbalance += static_cast<double>(force.norm());
        continue;
      }
      b.skin.add_shares(on, force, b.given);
      Vector3f rest = Vector3f::Zero();
      for (int c = 0; c < 3; ++c) {
        rest += on.weights[c] * b.body.skin->vertices.col(on.corners[c]).cast<float>();
      }
      const float area = solver.points()[static_cast<std::size_t>(at.point)].area;
      b.pressed_by.push_back({place, place - rest, force, area, pair.points});
    }
  }
  if (b.given.empty()) return;
  add_up_by_vertex(b.given);
  keep_largest(b);
}

// As many given forces as a solver has room for.
void PressingBodies::keep_largest(Part& p) {
  if (p.given.size() <= std::size_t{TouchSolver::kMostGiven}) return;
  std::sort(p.given.begin(), p.given.end(), [](const VertexForce& a, const VertexForce& b) {
    const float one = a.force.squaredNorm(), two = b.force.squaredNorm();
    return one != two ? one > two : a.vertex < b.vertex;
  });
  for (std::size_t k = TouchSolver::kMostGiven; k < p.given.size(); ++k) {
    report_.imbalance += static_cast<double>(p.given[k].force.norm());
  }
  p.given.resize(TouchSolver::kMostGiven);
}

// A body's answer to what is seen and to the others as they are now. Returns how far it moved, m.
double PressingBodies::answer(int body, int round) {
  Part& p = part(body);
  TouchState& state = *p.body.state;
  const bool is_first = round == 0;
  double left = move_;
  if (state.u.cols() > 0) {
    if (is_first) p.began = state.u;
    p.before = state.u;
    if (!is_first) left = std::max(0.0, move_ - farthest_apart(p.before, p.began));
  }
  TouchSolver& solver = p.body.contact->solver();
  p.report = solver.advance(state, *p.around, left, p.given);
  p.skin.bear(p.given);
  p.bears = !p.given.empty();
  Vector3f load = Vector3f::Zero();
  for (const VertexForce& force : p.given) load += force.force;
  if (p.report.held_back > 0) {
    const double missing = p.report.held_back / (p.report.held_back + left);
    report_.imbalance += missing * static_cast<double>((load - p.load).norm());
  }
  p.load = load;
  solver.place(state, p.placed);
  p.skin.move(p.placed);
  if (p.before.cols() != state.u.cols()) {
    p.began = p.before = state.u;
    return 0;
  }
  return farthest_apart(state.u, p.before);
}

const PressingReport& PressingBodies::advance() {
  report_ = {};
  move_ = 0;
  for (const auto& p : parts_) {
    if (!p->has_answer()) continue;
    const double of_body = p->body.seen != nullptr ? SkinContact::largest_move(*p->body.seen)
                                                   : std::numeric_limits<double>::infinity();
    move_ = std::max(move_, of_body);
  }
  for (Pair& pair : pairs_) pair.is_near = false;
  find_near_pairs();
  for (int round = 0; round < kMostRounds; ++round) {
    double moved = 0;
    report_.imbalance = 0;
    for (int k = 0; k < static_cast<int>(parts_.size()); ++k) {
      Part& p = part(k);
      if (!p.has_answer() || !p.takes_part) continue;
      gather_given(k);
      const bool is_beside = std::any_of(pairs_.begin(), pairs_.end(), [k](const Pair& pair) {
        return pair.is_near && (pair.points == k || pair.skin == k);
      });
      // Of what stands beside: nothing to answer yet.
      const bool asks = std::any_of(pairs_.begin(), pairs_.end(), [k](const Pair& pair) {
        return pair.is_near && pair.points == k;
      });
      if (!p.is_awake() && p.given.empty() && !asks) continue;
      if (round > 0 && !is_beside) continue;
      const double way = answer(k, round);
      if (is_beside) moved = std::max(moved, way);
    }
    report_.rounds = round + 1;
    if (!(moved > kTolerance)) break;
  }
  find_between();
  return report_;
}

// How deep the points that press a body are in its skin now; and the touches of those.
void PressingBodies::find_between() {
  bool any = false;
  for (int k = 0; k < static_cast<int>(parts_.size()); ++k) {
    if (part(k).has_answer()) any |= part(k).takes_part;
  }
  if (!any) report_.rounds = 0;
  for (const Pair& pair : pairs_) {
    if (!pair.is_near) continue;
    const Part &a = part(pair.points), &b = part(pair.skin);
    TouchSolver& solver = a.body.contact->solver();
    solver.find_moved(*a.body.state, moved_);
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      const PointForce& at = a.body.state->forces[k];
      if (at.by != pair.skin) continue;
      const auto found = b.skin.surface().nearest(
          pair.to_skin * (solver.places().col(at.point) + moved_[k]), kGapReach);
      if (!found) continue;
      const double distance = static_cast<double>(found->distance + pair.overlap);
      report_.between = std::max(report_.between, -distance);
    }
  }
}

bool PressingBodies::is_answered(int body) const { return part(body).has_answer(); }

void PressingBodies::move_obstacle(int body, const Matrix3Xf& vertices) {
  Part& p = part(body);
  PALPABLE_EXPECT(!p.has_answer(), "a body that is answered elsewhere");
  const bool moves = (vertices - p.body.skin->vertices.cast<float>()).cwiseAbs().maxCoeff() > 0;
  if (moves || p.has_moved) p.skin.move(vertices);
  p.has_moved = moves;
}

void PressingBodies::find_touches(int body, std::vector<Touch>& touches) {
  const Part& p = part(body);
  touches.clear();
  if (is_at_rest(body)) return;
  PALPABLE_EXPECT(p.body.seen != nullptr, "a surface was seen");
  p.body.contact->find_touches(*p.body.state, p.body.seen, p.pressed_by, touches);
}

bool PressingBodies::is_at_rest(int body) const {
  const Part& p = part(body);
  return p.body.state->forces.empty() && !p.bears && !(p.report.held_back > 0);
}

const TouchReport& PressingBodies::report_of(int body) const { return part(body).report; }

}  // namespace palpable
