#include "palpable/common/contact/modal_contact.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/complementarity.h"
#include "palpable/common/contact/modal_body.h"
#include "palpable/common/contact/near_points.h"
#include "palpable/common/reduced/small_cholesky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;

// Of a disc of radius a that is pressed evenly by f, the mean: w = 0.54 f (1 - nu^2) / (E a).
constexpr double kDisc = 0.54;
// m: deeper inside another body nothing gets in a frame.
constexpr float kDeepBetween = 0.009f;
// m of sigma that make a point as compliant again as the half space is.
constexpr double kSofter = 10;
// Cosine of the angle between two skins' normals up to which they lie on each other.
constexpr float kFacing = 0.7f;
// So often what may enter between two points is doubled, where there are too many of them.
constexpr int kCoarser = 8;
// Of the band: points that are farther, and do not press, take no part in an iteration. One that is
// entered all the same does in the next.
constexpr double kTakesPartOfBand = 0.4;
// m that a point may be entered by without pressing: nothing.
constexpr double kEnteredFree = 1e-9;
// m: so far from where it was asked last the gap of a point that is farther, and does not press, is
// told by its normal and curvature (near_points.cpp).
constexpr float kSameModalGap = 0.0003f;

// A contact point near something.
struct Candidate {
  int member = 0, point = 0;
  int by = -1;                                        // another member; -1: what is seen
  Eigen::Vector3i corners = Eigen::Vector3i::Zero();  // of the other's triangle
  Vector3f weights = Vector3f::Zero();                // likewise
  Vector3f place = Vector3f::Zero();                  // m, where it is now; the member's frame
  double gap = 0;                                     // m
  double offset = 0;  // m: between members, of the gap from what their places tell along the normal
  Vector3d normal = Vector3d::Zero();        // unit, away from what presses; the member's frame
  Vector3d other_normal = Vector3d::Zero();  // the same in the other's frame
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();  // 1/m
  double softness = 0;                                  // m/N
  double force = 0;                                     // N
  // Where what is seen was asked, m, and what was told: the gap, m, and its normal.
  Vector3f seen_from = Vector3f::Constant(std::numeric_limits<float>::infinity());
  double seen_gap = 0;
  Vector3f seen_normal = Vector3f::Zero();
  Vector3f foot = Vector3f::Zero();  // m, of the other's point at rest
};

// The force at a contact point, as it was found last.
struct KnownForce {
  std::array<int, 3> key{};  // member, other member, point
  double force = 0;          // N
  friend bool operator<(const KnownForce& a, const KnownForce& b) { return a.key < b.key; }
};

// How the modes move a candidate's point along d. @param result  (n)
void rows_along(const Eigen::MatrixXf& rows, std::size_t candidate, Index modes, const Vector3d& d,
                Eigen::Ref<VectorXd> result) {
  const auto first = 3 * static_cast<Index>(candidate);
  result = d[0] * rows.col(first).head(modes).cast<double>() +
           d[1] * rows.col(first + 1).head(modes).cast<double>() +
           d[2] * rows.col(first + 2).head(modes).cast<double>();
}

}  // namespace

struct ModalContact::Work {
  // A body, and its part of a step of Newton's method.
  struct Body : ModalBody {
    Body(const ModalMember& member, const ModalBody* twin)
        : ModalBody(member, twin),
          step(VectorXd::Zero(modes())),
          pull(step),
          factor(modes(), modes()) {}

    VectorXd gradient;  // (n) W'
    MatrixXd hessian;   // (n x n) W''
    VectorXd step;      // (n)
    VectorXd pull;      // (n) L^-1 (- W'): what it would do if nothing pressed
    MatrixXd factor;    // (n x n) of H
    bool active = false;
  };

  ModalSettings settings;
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<Eigen::Isometry3f> transforms;  // (K x K) of from_to()
  std::vector<Candidate> candidates;
  std::vector<KnownForce> known;       // forces, to begin with
  std::vector<std::size_t> near_ones;  // those of the candidates that take part in an iteration
  std::vector<std::size_t> pressed;    // and of these those that may press
  std::vector<std::size_t> to_ask;     // of one member: candidates whose gaps are asked again,
  std::vector<Vector3f> asked;         // their places,
  std::vector<SurfaceGap> told;        // and gaps
  Complementarity complementarity{static_cast<int>(kMostPoints)};
  // Of each candidate, of its member and of the other one:
  Eigen::MatrixXf own_rows, others_rows;  // (n x 3C) how modes move its point
  MatrixXd own_B, others_B;               // (n x C) B, of those that take part
  MatrixXd own, others;                   // (n x C) L^-1 B, of those that may press
  std::vector<double> W, gap, f;
  Index most_modes = 1;

  Work(const std::vector<ModalMember>& members, const ModalSettings& the_settings);
  // Of each member's frame into each other's: they stand still.
  [[nodiscard]] const Eigen::Isometry3f& from_to(int from, int to) const {
    return transforms[static_cast<std::size_t>(from) * bodies.size() +
                      static_cast<std::size_t>(to)];
  }
  ModalBody& showing(int member, const ModalState& state);
  void begin(std::span<ModalState> states);
  void find(std::span<const Obstacles* const> seen, double shift, ModalReport& report);
  void find_seen(int k, const Obstacles& seen, double shift);
  void find_between(int k, int other);
  Vector3f normal_between(Body& b, const Body& o, const Candidate& c, const NearestOnSkin& found,
                          const Eigen::Isometry3f& to_other) const;
  void keep_most(ModalReport& report);
  void look_again(std::span<const Obstacles* const> seen, double shift);
  bool look_beside(std::size_t p, double shift);
  void ask_again(const Obstacles& seen, double shift);
  [[nodiscard]] static bool take_seen(Candidate& c, const SurfaceGap& seen, double shift);
  [[nodiscard]] static bool is_gap_told(const Candidate& c, double shift);
  void wake();
  bool factorise_all();
  void find_B(std::size_t candidate);
  [[nodiscard]] double gap_after_step(std::size_t candidate) const;
  void assemble();
  bool solve_pressed();
  double iterate(ModalReport& report);
  void keep(std::span<ModalState> states, ModalReport& report);
};

ModalContact::Work::Work(const std::vector<ModalMember>& members, const ModalSettings& the_settings)
    : settings(the_settings) {
  for (const ModalMember& member : members) {
    PALPABLE_EXPECT(member.body != nullptr && member.tables != nullptr &&
                        trouble_of(*member.tables, *member.body).empty(),
                    "a body with its tables of modes");
    const auto twin = std::find_if(bodies.begin(), bodies.end(), [&](const auto& body) {
      return are_twins(body->member(), member);
    });
    bodies.push_back(std::make_unique<Body>(member, twin == bodies.end() ? nullptr : twin->get()));
    most_modes = std::max(most_modes, bodies.back()->modes());
  }
  for (const auto& from : bodies) {
    for (const auto& to : bodies) {
      transforms.push_back(
          (to->member().world_from_body.inverse() * from->member().world_from_body).cast<float>());
    }
  }
  const auto m = static_cast<Index>(kMostPoints);
  std::size_t all = 0;
  for (const auto& body : bodies) all += body->points().size();
  candidates.reserve(all);  // those between members are few: far fewer than lie near nothing
  near_ones.reserve(kMostPoints);
  pressed.reserve(kMostPoints);
  to_ask.reserve(kMostPoints);
  asked.reserve(kMostPoints);
  told.reserve(kMostPoints);
  known.reserve(2 * kMostPoints);
  own_rows.setZero(most_modes, 3 * m);
  others_rows.setZero(most_modes, 3 * m);
  own_B.setZero(most_modes, m);
  others_B.setZero(most_modes, m);
  own.setZero(most_modes, m);
  others.setZero(most_modes, m);
  W.resize(kMostPoints * kMostPoints);
  gap.resize(kMostPoints);
  f.resize(kMostPoints);
}

// A member in the state that somebody wants to see.
ModalBody& ModalContact::Work::showing(int member, const ModalState& state) {
  Body& b = *bodies[static_cast<std::size_t>(member)];
  if (state.q.size() == b.modes()) {
    b.set_q(state.q);
  } else {
    b.step.setZero();
    b.set_q(b.step);
  }
  return b;
}

void ModalContact::Work::begin(std::span<ModalState> states) {
  known.clear();
  candidates.clear();
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    for (const SkinForce& force : states[k].forces) {
      if (force.point < 0) continue;  // where another's point presses
      known.push_back(
          {{static_cast<int>(k), force.by, force.point}, static_cast<double>(force.force.norm())});
    }
  }
  std::sort(known.begin(), known.end());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Body& b = *bodies[k];
    ModalState& state = states[k];
    if (state.q.size() != b.modes()) {
      state.q.setZero(b.modes());
      state.forces.clear();
      state.forces.reserve(2 * kMostPoints);
    }
    b.active = !state.q.isZero(0);
    b.set_q(state.q);
  }
}

// Points of a member that are near what is seen, those that an object as sharp needs.
void ModalContact::Work::find_seen(int k, const Obstacles& seen, double shift) {
  Body& b = *bodies[static_cast<std::size_t>(k)];
  const Matrix3Xf& skin = b.skin();
  // m of gap: of more candidates than there is room for those are kept that take part at once.
  double wanted = settings.band;
  for (const HeapBlock& block : b.blocks()) {
    if (candidates.size() > kMostPoints) wanted = kTakesPartOfBand * settings.band;
    const auto band = static_cast<float>(wanted - shift);
    const float around = 0.5f * block.middles.diagonal().norm() + kHeapStretch * block.radius;
    if (!seen.may_be_within(block.middles.center(), band + around)) continue;
    for (int h = block.first; h < block.last; ++h) {
      const SkinCluster& heap = b.heaps()[static_cast<std::size_t>(h)];
      const Vector3f middle = skin.col(heap.vertex);
      if (!seen.may_be_within(middle, band + kHeapStretch * heap.radius)) continue;
      for (int i = heap.first; i < heap.last; ++i) {
        Candidate c;
        c.member = k;
        c.point = b.order()[static_cast<std::size_t>(i)];
        c.place = b.points()[static_cast<std::size_t>(c.point)].at(skin);
        if (!seen.may_be_within(c.place, band)) continue;
        if (!take_seen(c, gap_at(seen, c.place), shift) || c.gap > wanted) continue;
        const float level = b.levels()[static_cast<std::size_t>(c.point)];
        if (is_point_needed(level, largest_curvature(c.curvature),
                            static_cast<float>(settings.entry), b.coarsest(), b.finest())) {
          candidates.push_back(c);
        }
      }
    }
  }
}

// Which way two skins press each other, in the other's frame: along the normal of the one that is
// flat there. Where a body's edge lies on another's face, the edge gives way to the face.
Vector3f ModalContact::Work::normal_between(Body& b, const Body& o, const Candidate& c,
                                            const NearestOnSkin& found,
                                            const Eigen::Isometry3f& to_other) const {
  const SkinPoint& at = b.points()[static_cast<std::size_t>(c.point)];
  const float here = b.from_edge({at.corners[0], at.corners[1], at.corners[2]}, at.weights),
              there = o.from_edge(c.corners, c.weights);
  const Vector3f against = -(to_other.linear() * b.normal(c.point));
  // Skins that do not face each other: the gap's own direction.
  if (!(against.dot(found.normal) > kFacing) || !(here + there > 0)) return found.normal;
  return (here * against + there * found.normal).normalized();
}

// Points of one member that are near another's skin.
void ModalContact::Work::find_between(int k, int other) {
  Body &b = *bodies[static_cast<std::size_t>(k)], &o = *bodies[static_cast<std::size_t>(other)];
  const Eigen::Isometry3f& to_other = from_to(k, other);
  const auto band = static_cast<float>(settings.band);
  const Eigen::AlignedBox3f here = b.bounds().transformed(to_other);
  if (!(here.squaredExteriorDistance(o.bounds()) < band * band)) return;
  const Matrix3Xf& skin = b.skin();
  const Matrix3Xf& others_skin = o.skin();
  const MovingSurface& surface = o.surface();
  const Eigen::AlignedBox3f bounds = surface.bounds();
  for (const int point : b.points_between()) {
    const Vector3f place = b.points()[static_cast<std::size_t>(point)].at(skin);
    const Vector3f there = to_other * place;
    if (!(bounds.squaredExteriorDistance(there) < band * band)) continue;
    auto found = surface.nearest(there, band);
    // What is inside may be farther from the skin.
    if (!found && bounds.contains(there)) found = surface.nearest(there, kDeepBetween);
    if (!found || !(found->distance <= band)) continue;
    Candidate c;
    c.member = k;
    c.point = point;
    c.by = other;
    c.place = place;
    c.gap = static_cast<double>(found->distance);
    c.corners = surface.corners(found->triangle);
    c.weights = found->weights;
    const Vector3f normal = normal_between(b, o, c, *found, to_other);
    c.other_normal = normal.cast<double>();
    c.normal = (to_other.linear().transpose() * normal).cast<double>();
    c.foot = o.rest_place(c.corners, c.weights);
    Vector3f foot = Vector3f::Zero();
    for (int n = 0; n < 3; ++n) foot += c.weights[n] * others_skin.col(c.corners[n]);
    c.offset = c.gap - (there - foot).cast<double>().dot(c.other_normal);
    candidates.push_back(c);
  }
}

// Whether what was seen last tells the gap of a point that has moved.
bool ModalContact::Work::is_gap_told(const Candidate& c, double shift) {
  const float moved = (c.place - c.seen_from).norm();
  return !(c.force > 0) && moved < kSameModalGap &&
         c.seen_gap + shift - static_cast<double>(moved) > static_cast<double>(kSameModalGap);
}

// What was told of where the point is. False: nothing, or no number.
bool ModalContact::Work::take_seen(Candidate& c, const SurfaceGap& seen, double shift) {
  if (!seen.is_told()) return false;
  c.seen_from = c.place;
  c.seen_gap = static_cast<double>(seen.distance);
  c.seen_normal = seen.normal;
  c.gap = c.seen_gap + shift;
  c.normal = seen.normal.cast<double>();
  c.curvature = seen.curvature;
  c.softness = static_cast<double>(seen.softness);
  return true;
}

void ModalContact::Work::find(std::span<const Obstacles* const> seen, double shift,
                              ModalReport& report) {
  if (!candidates.empty()) {
    known.clear();
    for (const Candidate& c : candidates) {
      if (c.force > 0) known.push_back({{c.member, c.by, c.point}, c.force});
    }
    std::sort(known.begin(), known.end());
    candidates.clear();
  }
  const int count = static_cast<int>(bodies.size());
  for (int k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (seen[at] != nullptr) find_seen(k, *seen[at], shift);
  }
  for (const Candidate& c : candidates) bodies[static_cast<std::size_t>(c.member)]->active = true;
  for (int k = 0; k < count; ++k) {
    for (int other = 0; other < count; ++other) {
      if (k == other) continue;
      // Two that are at rest stand off each other.
      if (!bodies[static_cast<std::size_t>(k)]->active &&
          !bodies[static_cast<std::size_t>(other)]->active) {
        continue;
      }
      find_between(k, other);
    }
  }
  keep_most(report);
  for (Candidate& c : candidates) {
    const KnownForce wanted{{c.member, c.by, c.point}, 0};
    const auto at = std::lower_bound(known.begin(), known.end(), wanted);
    if (at != known.end() && at->key == wanted.key) c.force = at->force;
  }
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const Candidate& c = candidates[p];
    const Body& b = *bodies[static_cast<std::size_t>(c.member)];
    const SkinPoint& at = b.points()[static_cast<std::size_t>(c.point)];
    const auto P = static_cast<Index>(p);
    b.find_rows({at.corners[0], at.corners[1], at.corners[2]}, at.weights,
                own_rows.middleCols(3 * P, 3));
    if (c.by < 0) continue;
    bodies[static_cast<std::size_t>(c.by)]->find_rows(c.corners, c.weights,
                                                      others_rows.middleCols(3 * P, 3));
  }
}

// At most as many as there is room for: those that take part at once, of a large object coarser
// ones, then the deepest.
void ModalContact::Work::keep_most(ModalReport& report) {
  if (candidates.size() > kMostPoints) {
    std::erase_if(candidates,
                  [&](const Candidate& c) { return !(c.gap < kTakesPartOfBand * settings.band); });
  }
  double entry = settings.entry;
  for (int coarser = 0; coarser < kCoarser && candidates.size() > kMostPoints; ++coarser) {
    entry *= 2;
    std::erase_if(candidates, [&](const Candidate& c) {
      const Body& b = *bodies[static_cast<std::size_t>(c.member)];
      return c.by < 0 && !is_point_needed(b.levels()[static_cast<std::size_t>(c.point)],
                                          largest_curvature(c.curvature), static_cast<float>(entry),
                                          b.coarsest(), b.finest());
    });
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.gap != b.gap) return a.gap < b.gap;
    return std::array{a.member, a.by, a.point} < std::array{b.member, b.by, b.point};
  });
  if (candidates.size() > kMostPoints) {
    report.dropped += static_cast<int>(candidates.size() - kMostPoints);
    candidates.resize(kMostPoints);
  }
  report.candidates = std::max(report.candidates, static_cast<int>(candidates.size()));
}

// Gaps in the present shape. Of another member the plane that was nearest when the point was found
// is asked again: it moves with its triangle, and what bodies slide in between bends it by
// micrometres.
void ModalContact::Work::look_again(std::span<const Obstacles* const> seen, double shift) {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    to_ask.clear();
    for (std::size_t p = 0; p < candidates.size(); ++p) {
      if (candidates[p].member == static_cast<int>(k) && !look_beside(p, shift))
        to_ask.push_back(p);
    }
    if (!to_ask.empty()) ask_again(*seen[k], shift);
  }
}

// The gap of a point that the obstacles need not be asked for. False: they have to be.
bool ModalContact::Work::look_beside(std::size_t p, double shift) {
  Candidate& c = candidates[p];
  const Body& b = *bodies[static_cast<std::size_t>(c.member)];
  const auto P = static_cast<Index>(p);
  c.place = b.place(b.rest_place(c.point), own_rows.block(0, 3 * P, b.modes(), 3));
  if (c.by >= 0) {
    const Body& o = *bodies[static_cast<std::size_t>(c.by)];
    const Vector3f foot = o.place(c.foot, others_rows.block(0, 3 * P, o.modes(), 3));
    c.gap =
        c.offset + (from_to(c.member, c.by) * c.place - foot).cast<double>().dot(c.other_normal);
    return true;
  }
  if (!is_gap_told(c, shift)) return false;
  const GapBeside beside = gap_beside(c.seen_normal, c.curvature, c.place - c.seen_from);
  c.gap = c.seen_gap + shift + static_cast<double>(beside.farther);
  c.normal = beside.normal.cast<double>();
  return true;
}

// The gaps of `to_ask`, in one call.
void ModalContact::Work::ask_again(const Obstacles& seen, double shift) {
  asked.clear();
  for (const std::size_t p : to_ask) asked.push_back(candidates[p].place);
  told.resize(asked.size());
  seen.find_gaps(asked, told);
  for (std::size_t i = 0; i < to_ask.size(); ++i) {
    Candidate& c = candidates[to_ask[i]];
    if (take_seen(c, told[i], shift)) continue;
    c.gap = 1;  // m: far
    c.force = 0;
    c.seen_from.setConstant(std::numeric_limits<float>::infinity());
  }
}

// Members that something may press take part.
void ModalContact::Work::wake() {
  for (const Candidate& c : candidates) {
    bodies[static_cast<std::size_t>(c.member)]->active = true;
    if (c.by >= 0) bodies[static_cast<std::size_t>(c.by)]->active = true;
  }
}

// H of each member, with what the curvature of things adds where it stays positive definite.
bool ModalContact::Work::factorise_all() {
  for (const auto& body : bodies) {
    Body& b = *body;
    if (!b.active) continue;
    b.evaluate(b.gradient, b.hessian);
    b.factor = b.hessian;
    const Index k = &body - bodies.data();
    for (std::size_t p = 0; p < candidates.size(); ++p) {
      const Candidate& c = candidates[p];
      if (c.member != k || !(c.force > 0) || c.curvature.isZero(0)) continue;
      // Two directions across the normal hold all of it.
      const Vector3d t1 = c.normal.unitOrthogonal(), t2 = c.normal.cross(t1);
      const Eigen::Matrix3d K = c.curvature.cast<double>();
      for (const Vector3d& t : {t1, t2}) {
        const double bend = c.force * t.dot(K * t);
        if (!(bend > 0)) continue;
        rows_along(own_rows, p, b.modes(), t, b.pull);
        for (Index j = 0; j < b.modes(); ++j) b.factor.col(j) -= (bend * b.pull[j]) * b.pull;
      }
    }
    if (factorise_small(b.factor)) continue;
    double shift = 0;
    for (int tries = 0;; ++tries) {
      b.factor = b.hessian;
      if (shift > 0) b.factor.diagonal() += shift * b.hessian.diagonal().cwiseAbs();
      if (factorise_small(b.factor)) break;
      shift = shift == 0 ? 0.01 : 4 * shift;
      if (tries > 20) return false;  // not a number somewhere
    }
  }
  return true;
}

// How the members' modes change a candidate's gap.
void ModalContact::Work::find_B(std::size_t candidate) {
  const Candidate& c = candidates[candidate];
  const auto P = static_cast<Index>(candidate);
  const Body& b = *bodies[static_cast<std::size_t>(c.member)];
  rows_along(own_rows, candidate, b.modes(), c.normal, own_B.col(P).head(b.modes()));
  if (c.by < 0) return;
  const Body& o = *bodies[static_cast<std::size_t>(c.by)];
  rows_along(others_rows, candidate, o.modes(), -c.other_normal, others_B.col(P).head(o.modes()));
}

// m, of one that takes part.
double ModalContact::Work::gap_after_step(std::size_t candidate) const {
  const Candidate& c = candidates[candidate];
  const auto P = static_cast<Index>(candidate);
  const Body& b = *bodies[static_cast<std::size_t>(c.member)];
  double after = c.gap + own_B.col(P).head(b.modes()).dot(b.step);
  if (c.by < 0) return after;
  const Body& o = *bodies[static_cast<std::size_t>(c.by)];
  after += others_B.col(P).head(o.modes()).dot(o.step);
  return after;
}

// The complementarity problem of those that may press.
void ModalContact::Work::assemble() {
  const std::size_t m = pressed.size();
  for (std::size_t p = 0; p < m; ++p) {
    const Candidate& c = candidates[pressed[p]];
    const auto from = static_cast<Index>(pressed[p]), to = static_cast<Index>(p);
    const Body& b = *bodies[static_cast<std::size_t>(c.member)];
    auto column = own.col(to).head(b.modes());
    column = own_B.col(from).head(b.modes());
    solve_lower(b.factor, column);
    gap[p] = c.gap + column.dot(b.pull);
    if (c.by < 0) continue;
    const Body& o = *bodies[static_cast<std::size_t>(c.by)];
    auto other = others.col(to).head(o.modes());
    other = others_B.col(from).head(o.modes());
    solve_lower(o.factor, other);
    gap[p] += other.dot(o.pull);
  }
  for (std::size_t p = 0; p < m; ++p) {
    const Candidate& a = candidates[pressed[p]];
    const auto P = static_cast<Index>(p);
    for (std::size_t r = 0; r <= p; ++r) {
      const Candidate& c = candidates[pressed[r]];
      const auto R = static_cast<Index>(r);
      double sum = 0;
      const auto add = [&](int first, int second, const MatrixXd& one, const MatrixXd& two) {
        if (first < 0 || first != second) return;
        const Index n = bodies[static_cast<std::size_t>(first)]->modes();
        sum += one.col(P).head(n).dot(two.col(R).head(n));
      };
      add(a.member, c.member, own, own);
      add(a.member, c.by, own, others);
      add(a.by, c.member, others, own);
      add(a.by, c.by, others, others);
      W[p * m + r] = sum;
    }
    const Body& b = *bodies[static_cast<std::size_t>(a.member)];
    double area =
        std::max(1e-8, static_cast<double>(b.points()[static_cast<std::size_t>(a.point)].area));
    double half_space = b.member().tables->half_space * (1 + kSofter * a.softness);
    if (a.by >= 0) {
      half_space += bodies[static_cast<std::size_t>(a.by)]->member().tables->half_space;
      // Of few points each stands for more of the skin.
      const auto spacing = static_cast<double>(b.spacing_between());
      area = std::max(area, spacing * spacing);
    }
    W[p * m + p] += kDisc * half_space / std::sqrt(area / std::numbers::pi);
  }
}

// The forces of those that may press, and the steps that they make. False where there is none.
bool ModalContact::Work::solve_pressed() {
  assemble();
  const std::size_t m = pressed.size();
  for (std::size_t p = 0; p < m; ++p) f[p] = candidates[pressed[p]].force;
  if (m > 0 && !complementarity.solve({W.data(), m * m}, {gap.data(), m}, {f.data(), m})) {
    return false;
  }
  for (const auto& body : bodies) {
    if (body->active) body->step = body->pull;
  }
  for (std::size_t p = 0; p < m; ++p) {
    Candidate& c = candidates[pressed[p]];
    c.force = f[p];
    if (!(f[p] > 0)) continue;
    Body& b = *bodies[static_cast<std::size_t>(c.member)];
    b.step += f[p] * own.col(static_cast<Index>(p)).head(b.modes());
    if (c.by < 0) continue;
    Body& o = *bodies[static_cast<std::size_t>(c.by)];
    o.step += f[p] * others.col(static_cast<Index>(p)).head(o.modes());
  }
  for (const auto& body : bodies) {
    if (body->active) solve_upper(body->factor, body->step);
  }
  return true;
}

// One step of Newton's method. Returns how far it moved a vertex, m.
double ModalContact::Work::iterate(ModalReport& report) {
  ++report.iterations;
  wake();
  if (!factorise_all()) return 0;
  for (const auto& body : bodies) {
    Body& b = *body;
    if (!b.active) continue;
    b.pull = -b.gradient;
    solve_lower(b.factor, b.pull);
  }
  near_ones.clear();
  pressed.clear();
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const Candidate& c = candidates[p];
    if (!(c.gap < kTakesPartOfBand * settings.band || c.force > 0)) continue;
    find_B(p);
    if (c.force > 0) {
      pressed.push_back(p);
    } else {
      near_ones.push_back(p);
    }
  }
  // Few of those that take part press. The others do not if nothing enters them, which is asked of
  // them afterwards: the answer is that of all.
  while (true) {
    if (!solve_pressed()) return 0;
    const std::size_t before = pressed.size();
    std::erase_if(near_ones, [&](std::size_t p) {
      if (!(gap_after_step(p) < -kEnteredFree)) return false;
      pressed.push_back(p);
      return true;
    });
    if (pressed.size() == before) break;
  }
  double largest = 0;
  for (const auto& body : bodies) {
    Body& b = *body;
    if (!b.active) continue;
    double moved = b.move(b.step, 1);
    if (moved > settings.largest_move) {
      (void)b.move(b.step, settings.largest_move / moved - 1);
      moved = settings.largest_move;
    }
    largest = std::max(largest, moved);
  }
  return largest;
}

void ModalContact::Work::keep(std::span<ModalState> states, ModalReport& report) {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Body& b = *bodies[k];
    states[k].forces.clear();
    // What is left of a body that nothing holds is rest.
    if (b.active && candidates.empty() && report.last_change < settings.tolerance &&
        b.farthest() < settings.tolerance) {
      b.step.setZero();
      b.set_q(b.step);
    }
    states[k].q = b.q();
  }
  Vector3d sum = Vector3d::Zero();
  for (const bool others_now : {false, true}) {
    for (const Candidate& c : candidates) {
      if ((c.by >= 0) != others_now) continue;
      double& deepest = c.by < 0 ? report.penetration : report.between;
      deepest = std::max(deepest, -c.gap);
      if (!(c.force > 0)) continue;
      Body& b = *bodies[static_cast<std::size_t>(c.member)];
      const SkinPoint& point = b.points()[static_cast<std::size_t>(c.point)];
      const Vector3f force = (c.force * c.normal).cast<float>();
      states[static_cast<std::size_t>(c.member)].forces.push_back({point, force, c.by, c.point});
      if (c.by < 0) continue;
      const Vector3f back = (-c.force * c.other_normal).cast<float>();
      SkinPoint there{{c.corners[0], c.corners[1], c.corners[2]}, c.weights, point.area};
      states[static_cast<std::size_t>(c.by)].forces.push_back({there, back, c.member, -1});
      sum += b.member().world_from_body.linear() * force.cast<double>() +
             bodies[static_cast<std::size_t>(c.by)]->member().world_from_body.linear() *
                 back.cast<double>();
    }
  }
  report.imbalance = sum.norm();
}

ModalContact::ModalContact(const std::vector<ModalMember>& members, const ModalSettings& settings)
    : work_(std::make_unique<Work>(members, settings)) {}
ModalContact::~ModalContact() = default;
ModalContact::ModalContact(ModalContact&&) noexcept = default;

int ModalContact::member_count() const { return static_cast<int>(work_->bodies.size()); }

ModalReport ModalContact::advance(std::span<ModalState> states,
                                  std::span<const Obstacles* const> seen) {
  Work& w = *work_;
  const ModalSettings& s = w.settings;
  PALPABLE_EXPECT(states.size() == w.bodies.size() && seen.size() == states.size(),
                  "a state of each member, and what presses it");
  ModalReport report;
  w.begin(states);
  w.find(seen, 0, report);
  bool any = !w.candidates.empty();
  for (const auto& body : w.bodies) any |= body->active;
  if (!any) {
    for (ModalState& state : states) state.forces.clear();
    return report;
  }
  double depth = 0;
  for (const Candidate& c : w.candidates) {
    if (c.by < 0) depth = std::max(depth, -c.gap);
  }
  const int steps = std::max(
      1, static_cast<int>(std::ceil(std::min(depth / s.largest_step, 1.0 * s.most_steps))));
  for (int step = 1; step <= steps; ++step) {
    const double shift = std::max(0.0, depth - step * s.largest_step);
    const bool last = step == steps;
    // m moved since candidates were found: those above are the first step's, if it is the only one.
    double since = steps == 1 ? 0 : std::numeric_limits<double>::infinity();
    for (int i = 0; i < (last ? s.last_iterations : s.iterations); ++i) {
      if (since > 0.5 * s.band) {
        w.find(seen, shift, report);
        since = 0;
      } else if (i > 0) {
        w.look_again(seen, shift);
      }
      report.last_change = w.iterate(report);
      since += report.last_change;
      if (report.last_change < s.tolerance) break;
    }
  }
  w.look_again(seen, 0);
  w.keep(states, report);
  return report;
}

const Matrix3Xf& ModalContact::place(int member, const ModalState& state) {
  return work_->showing(member, state).skin();
}

void ModalContact::normals(int member, const ModalState& state, Matrix3Xf& normals) {
  work_->showing(member, state).find_normals(normals);
}

void ModalContact::stress(int member, const ModalState& state, std::span<float> von_mises,
                          std::span<float> cauchy) {
  work_->showing(member, state).stress(von_mises, cauchy);
}

}  // namespace palpable
