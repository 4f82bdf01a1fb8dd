#include "palpable/common/contact/touch_solver.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/contact_problem.h"
#include "palpable/common/contact/hold_back.h"
#include "palpable/common/contact/near_points.h"
#include "palpable/common/contact/touch_skin.h"
#include "palpable/common/response/compliance_cache.h"
#include "palpable/common/response/linear_field.h"
#include "palpable/common/response/nonlinear_answer.h"
#include "palpable/common/response/row_kernels.h"
#include "palpable/common/response/shell_stress.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// In steps of the object: a step of Newton's method that moves a touched vertex by more is halved.
constexpr double kLargestMove = 4;
constexpr int kHalvings = 4;
// Of a step of the object: points that are farther from it, and do not press, take no part in an
// iteration. One that the skin enters all the same does in the next.
constexpr double kTakesPart = 0.4;
// A frame's last step is looked at so many times for points that its answer enters though they were
// too far to be asked (TouchSolver::Work::add_entered).
constexpr int kRounds = 3;
// Of the candidates' band: what enters by less is left to the next frame.
constexpr double kEntered = 0.04;
// Of a step: an answer whose last iteration moved a touched vertex by more is none yet, and is gone
// towards by no more than so many steps.
constexpr double kUnsettled = 0.4;
constexpr int kUnsettledSteps = 3;
// Of a step of Newton's method that is taken where the iteration does not come nearer.
constexpr float kLeastShare = 0.25f;
// Iterations of a frame's last step in which what patches do to each other is evaluated anew: it is
// of the second order, and the forces change little after them.
constexpr int kCrossIterations = 2;

// Of the tables' part in a state's own error, what an exact answer takes out: of the stress' error
// more, of the displacement's less, since contact's own is left (docs/touch.md).
constexpr double kCorrected = 0.5;

void set_gap(ContactCandidate& candidate, const SurfaceGap& gap) {
  candidate.distance = gap.distance;
  candidate.normal = gap.normal;
  candidate.curvature = gap.curvature;
  candidate.softness = gap.softness;
  candidate.on = gap.on;
}

int most_modes(const TouchTables& tables) {
  int most = 16;
  for (const RegionTable& region : tables.regions) most = std::max(most, region.mode_count());
  return most;
}

}  // namespace

struct TouchSolver::Work {
  const TouchTables& tables;
  TouchSettings settings;
  TouchSkin skin;
  const Matrix3Xf& rest;
  std::span<const SkinPoint> points;
  NearPoints near_points;
  Compliance compliance;
  LinearField linear_field;
  RegionMap map;
  NonlinearAnswer nonlinear;
  ComplianceCache cache;
  ContactProblem problem;
  std::optional<ShellStress> shell;
  std::vector<float> carrying_stress, carrying_tensors;  // (V), (6V) Pa of a coarser skin
  std::optional<ErrorScale> error_scale;                 // of the tables' held-out touches

  std::vector<ContactCandidate> candidates;
  std::vector<ContactCandidate> found;  // all of them in the shape with which a frame begins
  std::vector<ContactCandidate> given;  // forces of other bodies, each at a vertex
  std::vector<int> vertices;            // of the candidates, and of what is given
  std::vector<int> local_of_vertex;     // (V) -1: not among them
  std::vector<float> weights;           // of `vertices`, for choosing blobs
  std::vector<VertexForce> loads;       // at `vertices`
  std::vector<int> looked_points;       // of the candidates, when the obstacles are asked: points,
  std::vector<Vector3f> looked_places;  // where they are, m,
  std::vector<SurfaceGap> looked_gaps;  // and their gaps
  Matrix3Xf linear, without_cross;      // (3 x V) the last field without the tables' beyond, and
                                        // without what patches do to each other
  Matrix3Xf no_displacement;            // (3 x W)
  Matrix3Xf here, before;               // (3 x vertices) displacement of `vertices`
  Matrix3Xf ahead;                      // (3 x W) what the step would hand over
  std::vector<char> is_candidate;       // by point
  HoldBack hold_back;
  const Refinement* refinement = nullptr;  // of the state that advances
  std::array<float, 2> correcting{};       // weights of its corrections, under the present loads
  std::vector<Vector3f> forces_before;
  std::vector<ContactCandidate> pressed;  // those of the candidates that take part,
  std::vector<std::size_t> of_pressed;    // and which
  std::vector<float> field;               // (3 x slots of the cache) G f
  bool stuck = false;                     // no step of the last iteration could be made

  Work(const SurfaceMesh& surface, std::span<const std::uint8_t> fixed,
       const TouchTables& the_tables, const TouchSettings& the_settings)
      : tables(the_tables),
        settings(the_settings),
        skin(surface, fixed, tables),
        rest(skin.rest()),
        points(skin.points()),
        near_points(skin, the_settings.entry),
        compliance(tables.compliance),
        linear_field(compliance),
        map(rest, tables.regions, tables.region_reach),
        nonlinear(compliance, tables.regions, map, tables.cross),
        cache(compliance, kMostVertices),
        problem(cache.blocks(), kMostPoints, most_modes(tables)),
        error_scale(palpable::error_scale(the_tables.held_out)),
        local_of_vertex(static_cast<std::size_t>(rest.cols()), -1),
        linear(3, rest.cols()),
        without_cross(3, rest.cols()),
        no_displacement(Matrix3Xf::Zero(3, compliance.nodes())),
        here(3, kMostVertices),
        before(3, kMostVertices),
        ahead(Matrix3Xf::Zero(3, compliance.nodes())),
        is_candidate(points.size(), 0),
        hold_back(compliance.nodes(), rest.cols(), 2 * kMostPoints) {
    if (skin.is_carried()) {
      carrying_stress.resize(static_cast<std::size_t>(rest.cols()));
      carrying_tensors.resize(6 * carrying_stress.size());
    }
    if (tables.shell.nodes() > 0) shell.emplace(tables.shell, static_cast<int>(rest.cols()));
    candidates.reserve(points.size());
    looked_points.reserve(kMostPoints);
    looked_places.reserve(kMostPoints);
    looked_gaps.reserve(kMostPoints);
    found.reserve(points.size());
    given.reserve(kMostGiven);
    vertices.reserve(static_cast<std::size_t>(rest.cols()));
    loads.reserve(kMostVertices);
    weights.reserve(kMostVertices);
    forces_before.resize(kMostPoints);
    pressed.reserve(kMostPoints);
    of_pressed.reserve(kMostPoints);
    field.resize(std::size_t{3} * kMostVertices);
  }

  [[nodiscard]] bool is_nonlinear() const { return settings.nonlinear && !tables.regions.empty(); }
  void set_given(std::span<const VertexForce> forces);
  void add_candidate(int point, const SurfaceGap& seen);
  void find_candidates(const TouchState& state, const Obstacles& obstacles, double shift);
  void choose_found(double shift);
  void keep_nearest(TouchReport& report);
  bool add_vertices(const ContactCandidate& candidate);
  void take_up(const TouchState& state);
  void add_up_loads();
  void choose_blobs(const TouchState& state, double shift);
  void find_displacements(CrossTerms cross);
  void look_at_gaps(const Obstacles& obstacles, double shift);
  double iterate(const Obstacles& obstacles, double shift, CrossTerms cross, float share);
  void choose_pressed(double shift);
  void go_back(float share);
  void settle(const TouchState& state, const Obstacles& obstacles, double shift, bool last,
              int most, TouchReport& report);
  bool add_entered(const TouchState& state, const Obstacles& obstacles, double shift,
                   TouchReport& report);
  void weigh_corrections();
  void fill_field(Matrix3Xf& on_nodes, Eigen::Index nodes);
  void hand_over(TouchState& state, const Obstacles& obstacles, bool last, TouchReport& report);
  void read_signs(const TouchState& state, TouchReport& report) const;
};

void TouchSolver::Work::set_given(std::span<const VertexForce> forces) {
  PALPABLE_EXPECT(forces.size() <= std::size_t{kMostGiven}, "no more given forces than fit");
  given.clear();
  for (const VertexForce& load : forces) {
    ContactCandidate at;
    at.vertices.fill(load.vertex);
    at.weights = Vector3f::UnitX();
    at.pressing = static_cast<double>(load.force.norm());
    if (!(at.pressing > 0)) continue;
    at.force = load.force;
    at.normal = load.force / static_cast<float>(at.pressing);
    given.push_back(at);
  }
}

void TouchSolver::Work::add_candidate(int point, const SurfaceGap& seen) {
  ContactCandidate candidate;
  candidate.point = point;
  candidate.weights = points[static_cast<std::size_t>(point)].weights;
  set_gap(candidate, seen);
  candidates.push_back(candidate);
}

// Points that are near the object in the state's shape, and those that press.
void TouchSolver::Work::find_candidates(const TouchState& state, const Obstacles& obstacles,
                                        double shift) {
  candidates.clear();
  near_points.for_each(state.u, static_cast<float>(settings.band - shift), obstacles,
                       [&](int point, const SurfaceGap& seen) { add_candidate(point, seen); });
}

// Those of the shape with which the frame began that are near the object where it is taken back to:
// what it presses goes away from it, and little else comes near on the way.
void TouchSolver::Work::choose_found(double shift) {
  candidates.clear();
  const auto band = static_cast<float>(settings.band - shift);
  for (const ContactCandidate& c : found) {
    if (c.distance < band) candidates.push_back(c);
  }
}

// Where an object leaves, the skin follows it over more than the candidates' band, and points that
// were too far to be asked may enter it. Those of the shape `ahead` join the candidates. False if
// there are none.
bool TouchSolver::Work::add_entered(const TouchState& state, const Obstacles& obstacles,
                                    double shift, TouchReport& report) {
  const Eigen::Index V = rest.cols();
  const float moved = (ahead.leftCols(V) - state.u.leftCols(V)).colwise().squaredNorm().maxCoeff();
  const auto band = static_cast<float>(settings.band);
  if (!(moved > band * band)) return false;
  for (const ContactCandidate& c : candidates) is_candidate[static_cast<std::size_t>(c.point)] = 1;
  const std::size_t known = candidates.size();
  near_points.for_each(ahead, -static_cast<float>(kEntered * settings.band + shift), obstacles,
                       [&](int point, const SurfaceGap& seen) {
                         if (is_candidate[static_cast<std::size_t>(point)] == 0)
                           add_candidate(point, seen);
                       });
  for (std::size_t k = 0; k < known; ++k)
    is_candidate[static_cast<std::size_t>(candidates[k].point)] = 0;
  if (candidates.size() == known) return false;
  keep_nearest(report);
  return true;
}

// At most as many as there is room for, the deepest first; in the order of the points.
void TouchSolver::Work::keep_nearest(TouchReport& report) {
  const auto nearer = [](const ContactCandidate& a, const ContactCandidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
  };
  std::sort(candidates.begin(), candidates.end(), nearer);
  for (const int v : vertices) local_of_vertex[v] = -1;
  vertices.clear();
  for (const ContactCandidate& at : given) {
    local_of_vertex[at.vertices[0]] = static_cast<int>(vertices.size());
    vertices.push_back(at.vertices[0]);
  }
  std::size_t kept = 0;
  for (ContactCandidate& candidate : candidates) {
    if (kept + given.size() == kMostPoints || !add_vertices(candidate)) break;
    candidates[kept++] = candidate;
  }
  report.dropped += static_cast<int>(candidates.size() - kept);
  candidates.resize(kept);
  report.candidates = std::max(report.candidates, static_cast<int>(kept));
}

// Whether its corners find room among the vertices.
bool TouchSolver::Work::add_vertices(const ContactCandidate& candidate) {
  const SkinPoint& point = points[static_cast<std::size_t>(candidate.point)];
  int missing = 0;
  for (std::size_t k = 0; k < 3; ++k) missing += local_of_vertex[point.corners[k]] < 0;
  if (vertices.size() + static_cast<std::size_t>(missing) > kMostVertices) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    int& local = local_of_vertex[point.corners[k]];
    if (local < 0) {
      local = static_cast<int>(vertices.size());
      vertices.push_back(point.corners[k]);
    }
  }
  return true;
}

// The forces of the state at the candidates; those at points that are none any more are let go.
void TouchSolver::Work::take_up(const TouchState& state) {
  for (ContactCandidate& candidate : candidates) {
    const SkinPoint& point = points[static_cast<std::size_t>(candidate.point)];
    for (std::size_t k = 0; k < 3; ++k) {
      candidate.vertices[k] = point.corners[k];
      candidate.local[k] = local_of_vertex[point.corners[k]];
      candidate.slots[k] = cache.slot_of(point.corners[k]);
    }
    const auto at =
        std::lower_bound(state.forces.begin(), state.forces.end(), candidate.point,
                         [](const PointForce& force, int wanted) { return force.point < wanted; });
    if (at == state.forces.end() || at->point != candidate.point) continue;
    candidate.force = at->force;
    candidate.pressing = std::max(0.0, static_cast<double>(at->force.dot(candidate.normal)));
  }
  for (ContactCandidate& at : given) {
    at.local.fill(local_of_vertex[at.vertices[0]]);
    at.slots.fill(cache.slot_of(at.vertices[0]));
  }
  loads.clear();
  for (const int v : vertices) loads.push_back({v, Vector3f::Zero()});
  add_up_loads();
}

void TouchSolver::Work::add_up_loads() {
  for (VertexForce& load : loads) load.force.setZero();
  for (const ContactCandidate& at : given) {
    loads[static_cast<std::size_t>(at.local[0])].force += at.force;
  }
  for (const ContactCandidate& candidate : candidates) {
    for (std::size_t k = 0; k < 3; ++k) {
      loads[static_cast<std::size_t>(candidate.local[k])].force +=
          candidate.weights[static_cast<int>(k)] * candidate.force;
    }
  }
}

// What presses decides; before the first touch what is deepest in the object.
void TouchSolver::Work::choose_blobs(const TouchState& state, double shift) {
  weights.assign(vertices.size(), 0.0f);
  float pressing = 0;
  for (const VertexForce& load : loads) pressing += load.force.norm();
  const float per_m = pressing > 0 ? 0.1f * pressing / static_cast<float>(settings.band) : 1.0f;
  for (const ContactCandidate& c : candidates) {
    const float entry = std::max(0.0f, -c.distance - static_cast<float>(shift));
    for (std::size_t k = 0; k < 3; ++k) {
      weights[static_cast<std::size_t>(c.local[k])] +=
          c.weights[static_cast<int>(k)] * (c.force.norm() + per_m * entry);
    }
  }
  for (const ContactCandidate& at : given) {
    weights[static_cast<std::size_t>(at.local[0])] += at.force.norm();
  }
  nonlinear.choose_blobs(vertices, weights, state.regions);
}

// Of all vertices that may touch, under the present loads.
void TouchSolver::Work::find_displacements(CrossTerms cross) {
  if (is_nonlinear()) nonlinear.evaluate(loads, cross);
  // G is symmetric: what a load does everywhere are its rows.
  std::fill(field.begin(), field.end(), 0.0f);
  for (const VertexForce& load : loads) {
    if (load.force.isZero(0)) continue;
    const float* rows = cache.blocks().col(3 * cache.slot_of(load.vertex)).data();
    best_row_kernels().add_float_rows(rows, field.size(), {load.force.data(), 3}, field);
  }
  for (std::size_t i = 0; i < vertices.size(); ++i)
    here.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Vector3f>(field.data() + 3 * cache.slot_of(vertices[i]));
  weigh_corrections();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    auto u = here.col(static_cast<Eigen::Index>(i));
    if (is_nonlinear()) u += nonlinear.displacement_at(vertices[i]);
    for (std::size_t k = 0; k < correcting.size(); ++k) {
      if (correcting[k] > 0) u += correcting[k] * refinement->corrections[k].field.col(vertices[i]);
    }
  }
}

// How far each correction holds under the present loads. @pre `here` is their linear answer
void TouchSolver::Work::weigh_corrections() {
  correcting.fill(0.0f);
  if (!refinement->acts()) return;
  float work = 0;
  std::array<float, 2> shared{};
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Vector3f& f = loads[i].force;
    work += f.dot(here.col(static_cast<Eigen::Index>(i)));
    for (std::size_t k = 0; k < shared.size(); ++k) {
      const ExactCorrection& c = refinement->corrections[k];
      if (c.work > 0) shared[k] += f.dot(c.linear.col(vertices[i]));
    }
  }
  const std::array blended{1 - refinement->blended, refinement->blended};
  for (std::size_t k = 0; k < shared.size(); ++k)
    correcting[k] =
        blended[k] * correction_weight(work, shared[k], refinement->corrections[k].work);
}

void TouchSolver::Work::look_at_gaps(const Obstacles& obstacles, double shift) {
  const auto far = static_cast<float>(2 * kTakesPart * settings.largest_step - shift);
  looked_points.clear();
  looked_places.clear();
  for (const ContactCandidate& candidate : candidates) {
    const auto p = static_cast<std::size_t>(candidate.point);
    Vector3f x = skin.places().col(candidate.point) + skin.lifted(p);
    for (std::size_t k = 0; k < 3; ++k) {
      x += candidate.weights[static_cast<int>(k)] * here.col(candidate.local[k]);
    }
    looked_points.push_back(candidate.point);
    looked_places.push_back(x);
  }
  looked_gaps.resize(candidates.size());
  near_points.find_gaps(looked_points, looked_places, obstacles, far, looked_gaps);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (std::isfinite(looked_gaps[k].distance)) {
      set_gap(candidates[k], looked_gaps[k]);
    } else {
      candidates[k].distance = static_cast<float>(10 * settings.band);
    }
  }
}

// A share of one step of Newton's method from `here`. Returns how far it moved a vertex, m.
double TouchSolver::Work::iterate(const Obstacles& obstacles, double shift, CrossTerms cross,
                                  float share) {
  look_at_gaps(obstacles, shift);
  const auto n = static_cast<Eigen::Index>(vertices.size());
  before.leftCols(n) = here.leftCols(n);
  choose_pressed(shift);
  const NonlinearAnswer* tangent = is_nonlinear() ? &nonlinear : nullptr;
  // A state on the way may have no positive definite tangent; without what is not always positive
  // the step is a shorter one, not a wrong one.
  const auto solve = [&](const NonlinearAnswer* answer, bool turning) {
    return problem.solve(pressed, field, answer,
                         {shift, settings.softness, turning, given.size(), obstacles});
  };
  stuck = true;
  if (!solve(tangent, true) && !solve(tangent, false) && !solve(nullptr, false)) return 0;
  for (std::size_t k = 0; k < of_pressed.size(); ++k) {
    candidates[of_pressed[k]] = pressed[given.size() + k];
  }
  if (share < 1) go_back(share);
  for (int halving = 0; halving <= kHalvings; ++halving) {
    add_up_loads();
    find_displacements(cross);
    const float moved =
        n > 0 ? (here.leftCols(n) - before.leftCols(n)).colwise().norm().maxCoeff() : 0.0f;
    if (moved <= static_cast<float>(kLargestMove * settings.largest_step)) {
      stuck = halving == kHalvings;
      return static_cast<double>(moved);
    }
    // The last time nothing is left of the step: no state is better than one beyond the tables.
    go_back(halving + 1 < kHalvings ? 0.5f : 0.0f);
  }
  return 0;
}

// Those that press, or may do so next, behind the forces that are given.
void TouchSolver::Work::choose_pressed(double shift) {
  pressed.assign(given.begin(), given.end());
  of_pressed.clear();
  const auto reach = static_cast<float>(kTakesPart * settings.largest_step - shift);
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const ContactCandidate& c = candidates[p];
    forces_before[p] = c.force;
    if (!(c.distance < reach) && c.force.isZero(0)) continue;
    pressed.push_back(c);
    of_pressed.push_back(p);
  }
}

// To a share of the way from the forces before.
void TouchSolver::Work::go_back(float share) {
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    ContactCandidate& c = candidates[p];
    c.force = share * c.force + (1 - share) * forces_before[p];
    c.pressing = std::max(0.0, static_cast<double>(c.force.dot(c.normal)));
  }
}

// The answer to the candidates, from the state's forces.
void TouchSolver::Work::settle(const TouchState& state, const Obstacles& obstacles, double shift,
                               bool last, int most, TouchReport& report) {
  cache.bring(vertices);
  take_up(state);
  if (is_nonlinear()) choose_blobs(state, shift);
  find_displacements(CrossTerms::kAnew);
  float share = 1;
  for (int i = 0; i < most; ++i) {
    ++report.iterations;
    const CrossTerms cross =
        last && i < kCrossIterations ? CrossTerms::kAnew : CrossTerms::kAsBefore;
    const double change = iterate(obstacles, shift, cross, share);
    // Two sets of points that press in turn would go on for ever.
    if (i > 0 && change > report.last_change) share = std::max(kLeastShare, 0.5f * share);
    report.last_change = change;
    if (change < settings.tolerance) break;
  }
}

// The first nodes' displacement under the present loads.
void TouchSolver::Work::fill_field(Matrix3Xf& on_nodes, Eigen::Index nodes) {
  Eigen::Ref<Matrix3Xf> u = on_nodes.leftCols(nodes);
  linear_field.fill(loads, u);
  linear = u.leftCols(linear.cols());
  if (is_nonlinear()) {
    nonlinear.find_far_targets();
    compliance.add_beyond(nonlinear.far_targets(), u);
    nonlinear.add_near(u);
    without_cross = u.leftCols(linear.cols());
    nonlinear.add_cross(u);
  }
  for (std::size_t k = 0; k < correcting.size(); ++k) {
    if (!(correcting[k] > 0)) continue;
    const Matrix3Xf& c = refinement->corrections[k].field;
    u += correcting[k] * c.leftCols(nodes);
    linear += correcting[k] * c.leftCols(linear.cols());
    if (is_nonlinear()) without_cross += correcting[k] * c.leftCols(linear.cols());
  }
}

// What the field just filled tells of its own error.
void TouchSolver::Work::read_signs(const TouchState& state, TouchReport& report) const {
  if (state.forces.empty() && given.empty()) return;
  double all = 0, beyond = 0, between = 0, largest = 0;
  for (Eigen::Index v = 0; v < linear.cols(); ++v) {
    const double moved = static_cast<double>(state.u.col(v).squaredNorm());
    all += moved;
    largest = std::max(largest, moved);
    beyond += static_cast<double>((state.u.col(v) - linear.col(v)).squaredNorm());
    if (is_nonlinear())
      between += static_cast<double>((state.u.col(v) - without_cross.col(v)).squaredNorm());
  }
  if (!(all > 0)) return;
  double left = 1;
  for (const float weight : correcting) left -= kCorrected * static_cast<double>(weight);
  left = std::max(1 - kCorrected, left);
  report.signs = {std::max(0.0, report.penetration) / std::sqrt(largest),
                  left * std::sqrt(beyond / all), left * std::sqrt(between / all)};
  if (error_scale) report.stated = error_scale->stated(report.signs);
}

void TouchSolver::Work::hand_over(TouchState& state, const Obstacles& obstacles, bool last,
                                  TouchReport& report) {
  // Those that entered last and are not answered are not where `here` is told.
  std::erase_if(candidates, [](const ContactCandidate& c) { return c.local[0] < 0; });
  if (last) look_at_gaps(obstacles, 0);
  state.forces.clear();
  report.penetration = 0;
  for (const ContactCandidate& candidate : candidates) {
    if (candidate.on.body < 0) {
      report.penetration = std::max(report.penetration, -static_cast<double>(candidate.distance));
    }
    if (candidate.pressing > 0) {
      state.forces.push_back({candidate.point, candidate.force, candidate.on.body});
    }
  }
  std::sort(state.forces.begin(), state.forces.end(),
            [](const PointForce& a, const PointForce& b) { return a.point < b.point; });
  state.regions.assign(nonlinear.regions().begin(), nonlinear.regions().end());
  report.blobs = nonlinear.blob_count();
  report.last_share = static_cast<double>(nonlinear.last_share());
  state.refinement.weights = correcting;
}

TouchSolver::TouchSolver(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                         const TouchTables& tables, const TouchSettings& settings)
    : work_(std::make_unique<Work>(skin, fixed, tables, settings)) {}
TouchSolver::~TouchSolver() = default;
TouchSolver::TouchSolver(TouchSolver&&) noexcept = default;

std::span<const SkinPoint> TouchSolver::points() const { return work_->points; }
const Matrix3Xf& TouchSolver::places() const { return work_->skin.places(); }

TouchReport TouchSolver::advance(TouchState& state, const Obstacles& obstacles, double largest_move,
                                 std::span<const VertexForce> given) {
  Work& w = *work_;
  const TouchSettings& s = w.settings;
  TouchReport report;
  w.near_points.start();
  w.nonlinear.start();
  state.refinement.blended =
      std::min(1.0f, state.refinement.blended + 1.0f / static_cast<float>(s.blend_frames));
  w.refinement = &state.refinement;
  if (state.u.cols() != w.compliance.nodes()) {
    state.u.setZero(3, w.compliance.nodes());
    state.forces.clear();
    state.forces.reserve(2 * kMostPoints);  // those of two frames, where one is held back
    state.regions.clear();
    state.regions.reserve(NonlinearAnswer::kMostBlobs);
  }
  w.skin.face_as(state.u);
  w.set_given(given);
  w.find_candidates(state, obstacles, 0);
  double depth = 0;
  for (const ContactCandidate& c : w.candidates)
    depth = std::max(depth, -static_cast<double>(c.distance));
  const auto steps_of = [&s](double way) {
    return static_cast<int>(std::ceil(std::min(way / s.largest_step, 1.0 * s.most_steps)));
  };
  const int steps = std::max(1, std::min(steps_of(depth), steps_of(largest_move)));
  bool entered = false;  // by points that are not answered
  w.hold_back.start(state);
  if (steps > 1) w.found = w.candidates;
  for (int step = 1; step <= steps; ++step) {
    // The object is taken back so far that the skin enters it by no more than a step.
    const double shift = std::max(0.0, depth - step * s.largest_step);
    const bool last = step == steps;
    if (!last) {
      w.choose_found(shift);
    } else if (steps > 1 || shift > 0) {
      w.find_candidates(state, obstacles, shift);
    }
    // Those that press and have just lost the object out of sight let go by themselves.
    report.dropped = 0;
    w.keep_nearest(report);
    const int most = report.iterations + (last ? s.last_iterations : s.iterations);
    // All of the shape is wanted at the end, and where candidates are found anew the skin's.
    const Eigen::Index shape = last ? w.ahead.cols() : step + 1 == steps ? w.rest.cols() : 0;
    for (int round = 0;; ++round) {
      w.settle(state, obstacles, shift, last, most - report.iterations, report);
      if (shape > 0) w.fill_field(w.ahead, shape);
      if (!last || !w.add_entered(state, obstacles, shift, report)) break;
      entered = round + 1 == kRounds || report.iterations >= most;
      if (entered) break;
    }
    ++report.steps;
    w.hand_over(state, obstacles, last, report);
    if (shape > 0) state.u.swap(w.ahead);
  }
  w.read_signs(state, report);
  const bool settled = !w.stuck && !entered && report.last_change <= kUnsettled * s.largest_step;
  if (!settled) {
    largest_move = std::min(largest_move, kUnsettledSteps * s.largest_step);
    report.held_back = report.last_change;
  }
  report.held_back = std::max(report.held_back, w.hold_back.bound(state, largest_move));
  if (!settled || report.held_back > 0) report.stated.reset();
  return report;
}

bool TouchSolver::ask(const TouchState& state, AskedLoad& asked) {
  Work& w = *work_;
  asked.forces.clear();
  if (state.forces.empty() || state.refinement.blended < 1) return false;
  asked.forces.reserve(6 * kMostPoints);
  for (const PointForce& at : state.forces) {
    const SkinPoint& point = w.points[static_cast<std::size_t>(at.point)];
    for (std::size_t k = 0; k < 3; ++k) {
      const float weight = point.weights[static_cast<int>(k)];
      if (weight > 0) asked.forces.push_back({point.corners[k], weight * at.force});
    }
  }
  add_up_by_vertex(asked.forces);
  asked.linear.resize(3, w.rest.cols());
  w.linear_field.fill(asked.forces, asked.linear);
  asked.tables = state.u;
  for (std::size_t k = 0; k < 2; ++k) {
    const float weight = state.refinement.weights[k];
    if (weight > 0) asked.tables -= weight * state.refinement.corrections[k].field;
  }
  return true;
}

void TouchSolver::probe(AskedLoad& asked) {
  make_probe(work_->linear_field, static_cast<int>(work_->rest.cols()), work_->compliance.nodes(),
             asked);
}

bool TouchSolver::agrees(const AskedLoad& probe, const Matrix3Xf& exact) {
  return is_of_probed_body(probe, exact);
}

bool TouchSolver::refine(TouchState& state, const AskedLoad& asked, const Matrix3Xf& exact) const {
  PALPABLE_EXPECT(exact.cols() == work_->compliance.nodes() &&
                      asked.tables.cols() == exact.cols() &&
                      asked.linear.cols() == work_->rest.cols(),
                  "an answer has as many nodes as the tables");
  return state.refinement.take_up(asked, exact);
}

void TouchSolver::stress(const TouchState& state, std::span<float> von_mises,
                         std::span<float> cauchy) const {
  PALPABLE_EXPECT(work_->shell.has_value(), "stress needs tables with a shell");
  Work& w = *work_;
  const Matrix3Xf& u = state.u.cols() == 0 ? w.no_displacement : state.u;
  if (!w.skin.is_carried()) {
    w.shell->evaluate(u, von_mises, cauchy);
    return;
  }
  const std::span<float> tensors =
      cauchy.empty() ? std::span<float>() : std::span<float>(w.carrying_tensors);
  w.shell->evaluate(u, w.carrying_stress, tensors);
  w.skin.spread(w.carrying_stress, 1, von_mises);
  if (!cauchy.empty()) w.skin.spread(tensors, 6, cauchy);
}

void TouchSolver::place(const TouchState& state, Matrix3Xf& skin) const {
  work_->skin.face_as(state.u);
  work_->skin.place(state.u, skin);
}

void TouchSolver::find_moved(const TouchState& state, std::vector<Vector3f>& moved) const {
  work_->skin.face_as(state.u);
  moved.clear();
  for (const PointForce& at : state.forces) {
    moved.push_back(work_->skin.moved(static_cast<std::size_t>(at.point), state.u));
  }
}

}  // namespace palpable
