#include "palpable/common/response/tables_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/followed_loads.h"
#include "palpable/common/response/inertia.h"
#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/shell_stress.h"
#include "palpable/common/response/tables_tangent.h"
#include "palpable/common/response/touch_skin.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// Iterations of a frame's last step in which the cross terms are evaluated anew. They are of the
// second order, and the forces change little in later iterations.
constexpr int kCrossIterations = 2;
// Largest displacement of a point in one iteration, as a ratio to TouchSettings::largest_step.
constexpr double kLargestChange = 4;
// Share of the indicators `beyond` and `cross` that a full correction takes off. Its true share is
// larger for stress and smaller for displacement, where the error of contact remains
// (docs/lab/touch.md).
constexpr double kCorrected = 0.5;
constexpr float kClusterRadius = 0.006f;  // m, of a cluster of contact points
// m between the contact points that are searched on other bodies' skins.
constexpr float kBetweenSkins = 0.003f;
// Forces of a state after the step limit: those of two frames at most.
constexpr std::size_t kMostForces = 2 * std::size_t{kMostPlacesWithOthers};

std::size_t most_modes(const TouchTables& tables) {
  int most = 16;
  for (const RegionTable& region : tables.regions) most = std::max(most, region.mode_count());
  return static_cast<std::size_t>(most);
}

std::size_t inertia_width(const TouchTables& tables) {
  return tables.vibration ? padded(tables.vibration->omega.size()) : 0;
}

ContactLimits tables_limits(const TouchSettings& s) {
  ContactLimits limits = limits_from(s);
  limits.largest_change = kLargestChange * s.largest_step;
  return limits;
}

}  // namespace

struct TablesBody::Work {
  const TouchTables& tables;
  TouchSettings settings;
  ContactLimits limits;
  TouchSkin skin;
  const Matrix3Xf& rest;
  std::span<const SkinPoint> points;
  SkinClusters clusters;
  Compliance compliance;
  LinearField linear_field;
  RegionMap map;
  NonlinearResponse nonlinear;
  std::optional<ComplianceCache> cache;
  std::optional<ShellStress> shell;
  std::vector<float> coarse_stress, coarse_tensors;  // (V), (6V) Pa, of a coarser skin
  std::optional<ErrorScale> error_scale;             // of the tables' held-out touches
  std::optional<MovingSurface> surface;              // made when it is first queried
  SurfaceMesh rest_skin;                             // the body's skin at rest
  Matrix3Xf placed;                                  // (3 x F) m, its positions now
  bool is_surface_old = true;
  Eigen::AlignedBox3f bounds;  // of the shape; empty: not computed

  // The frame.
  TouchState* state = nullptr;
  Matrix3Xf formed;                  // (3 x W) m, the displacement by form_shape()
  const Matrix3Xf* shape = nullptr;  // the state's displacement, or `formed`
  bool is_formed = false;
  Matrix3Xf began;  // (3 x W) m, displacement when the frame began
  ForcesAtStart forces_at_start{kMostForces};
  TablesReport report;
  std::array<float, 2> correcting{};  // weights of the state's corrections under the loads
  Matrix3Xf linear, without_cross;    // (3 x V) m, `formed` without regions and cross terms,
                                      // and without the cross terms alone
  Matrix3Xf no_displacement;          // (3 x W) 0

  // The step.
  StepPlaces next;                 // places of the next step
  std::vector<Place> places;       // those that take part in the present one,
  std::vector<int> vertices;       // and their vertices
  std::vector<VertexForce> loads;  // the forces at these vertices
  std::vector<float> weights;      // of these vertices, for choosing patches
  std::vector<float> field;        // (3 x slots of the cache) G f
  Matrix3Xf here, before;          // (3 x vertices) displacement now, and at linearise()
  bool is_last = false;
  int iteration = 0;

  TablesTangent tangent;

  // Inertia; none without vibration modes.
  std::optional<Inertia> inertia;
  bool is_timed = false;                  // time passes in this frame
  bool is_bent_at_once = false;           // after a pause: nonlinear terms follow no loads
  std::optional<FollowedLoads> followed;  // with regions
  VibrationState vibration_at_start;
  std::vector<double> q_of_shape;  // modal coordinates when the shape was formed

  Work(const SurfaceMesh& surface_mesh, std::span<const std::uint8_t> fixed,
       const TouchTables& the_tables, const TouchSettings& the_settings);

  void make_room(int most_places, int most_vertices);
  [[nodiscard]] bool is_nonlinear() const { return settings.nonlinear && !tables.regions.empty(); }
  void weigh(std::span<const PlaceLoad> entries);
  [[nodiscard]] bool follows_loads() const { return is_timed && !is_bent_at_once; }
  void choose_patches();
  void keep_vibration(bool is_free);
  void fill_field();
  void evaluate_nonlinear(CrossTerms cross);
  void find_displacements(CrossTerms cross);
  [[nodiscard]] TablesAt tables_now(Tangent kind) {
    // In a step with time the nonlinear terms do not depend on the forces.
    const bool by_regions =
        kind == Tangent::kFull && is_nonlinear() && !(is_timed && inertia->step() > 0);
    return {places, *cache, field, by_regions ? &nonlinear : nullptr,
            is_timed ? &*inertia : nullptr};
  }
  void fill_shape(Eigen::Index nodes);
  void forget_surface() {
    is_surface_old = true;
    bounds.setEmpty();
  }
  template <class ForceOf>
  void set_loads(const ForceOf& force_of);
  [[nodiscard]] CrossTerms cross_terms() const {
    return is_last && iteration <= kCrossIterations ? CrossTerms::kAnew : CrossTerms::kAsBefore;
  }
};

TablesBody::Work::Work(const SurfaceMesh& surface_mesh, std::span<const std::uint8_t> fixed,
                       const TouchTables& the_tables, const TouchSettings& the_settings)
    : tables(the_tables),
      settings(the_settings),
      limits(tables_limits(the_settings)),
      skin(surface_mesh, fixed, tables),
      rest(skin.rest()),
      points(skin.points()),
      clusters(rest, points, skin.places(), skin.levels(), kClusterRadius),
      compliance(tables.compliance),
      linear_field(compliance),
      map(rest, tables.regions, tables.region_reach),
      nonlinear(compliance, tables.regions, map, tables.cross),
      error_scale(palpable::error_scale(the_tables.held_out)),
      rest_skin(surface_mesh),
      formed(Matrix3Xf::Zero(3, compliance.nodes())),
      began(formed),
      linear(3, rest.cols()),
      without_cross(3, rest.cols()),
      no_displacement(formed),
      next(static_cast<std::size_t>(rest.cols())),
      tangent(most_modes(tables), inertia_width(tables)) {
  shape = &no_displacement;
  if (settings.inertia && tables.vibration && Inertia::has_modes(*tables.vibration)) {
    inertia.emplace(*tables.vibration, compliance.nodes());
    inertia->rest(vibration_at_start, {});
    if (is_nonlinear()) {
      followed.emplace(static_cast<int>(rest.cols()), 2 * kMostVertices);
      followed->make_room(vibration_at_start);
    }
  }
  if (skin.is_carried()) {
    coarse_stress.resize(static_cast<std::size_t>(rest.cols()));
    coarse_tensors.resize(6 * coarse_stress.size());
  }
  if (tables.shell.nodes() > 0) shell.emplace(tables.shell, static_cast<int>(rest.cols()));
  make_room(kMostPlaces, kMostVertices);
}

void TablesBody::Work::make_room(int most_places, int most_vertices) {
  const auto P = static_cast<std::size_t>(most_places);
  const auto S = static_cast<std::size_t>(most_vertices);
  cache.emplace(compliance, most_vertices);
  const auto width = static_cast<std::size_t>(cache->blocks().rows());
  next.make_room(P, S, kMostVertices);
  tangent.make_room(P, width);
  places.reserve(P);
  vertices.reserve(S);
  loads.reserve(S);
  weights.reserve(S);
  here.resize(3, most_vertices);
  before.resize(3, most_vertices);
  field.resize(width);
}

TablesBody::TablesBody(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                       const TouchTables& tables, const TouchSettings& settings)
    : work_(std::make_unique<Work>(skin, fixed, tables, settings)) {}
TablesBody::~TablesBody() = default;

std::span<const SkinPoint> TablesBody::points() const { return work_->points; }
const Matrix3Xf& TablesBody::points_at_rest() const { return work_->skin.places(); }
SkinPointSet TablesBody::contact_points() const {
  return {work_->points,
          work_->skin.levels(),
          &work_->clusters,
          static_cast<float>(TouchSkin::kCoarsest),
          static_cast<float>(TouchSkin::kFinest),
          kBetweenSkins,
          static_cast<float>(work_->tables.point_spacing),
          &work_->skin.held()};
}
const ContactLimits& TablesBody::limits() const { return work_->limits; }

// --- frame

void TablesBody::make_room_for_others() {
  work_->make_room(kMostPlacesWithOthers, 2 * kMostVertices);
}

void TablesBody::use(TouchState& state) { work_->state = &state; }

void TablesBody::begin_frame() {
  Work& w = *work_;
  TouchState& state = *w.state;
  w.nonlinear.start();
  state.refinement.blended =
      std::min(1.0f, state.refinement.blended + 1.0f / static_cast<float>(w.settings.blend_frames));
  if (state.u.cols() != w.compliance.nodes()) {
    state.u.setZero(3, w.compliance.nodes());
    state.forces.clear();
    state.forces.reserve(kMostForces);
    state.anchors.clear();
    if (friction() > 0) state.anchors.reserve(kMostForces);
    state.regions.clear();
    state.regions.reserve(NonlinearResponse::kMostPatches);
    state.vibration = {};
    if (w.followed) w.followed->make_room(state.vibration);
    if (w.inertia) w.inertia->rest(state.vibration, {});
  }
  w.skin.update_normals(state.u);
  w.shape = &state.u;
  w.is_formed = false;
  w.forget_surface();
  w.began = state.u;
  w.vibration_at_start = state.vibration;
  w.q_of_shape = state.vibration.q;
  w.forces_at_start.start(state.forces);
}

bool TablesBody::is_at_rest() const {
  const TouchState& state = *work_->state;
  return state.u.cols() > 0 && state.forces.empty() && state.u.isZero(0) && !state.vibration.moves;
}

int TablesBody::steps_in(double time) const {
  return work_->inertia ? work_->inertia->steps_in(time) : 0;
}

void TablesBody::set_time_step(double h) {
  work_->is_timed = true;
  work_->is_bent_at_once = false;
  work_->inertia->set_step(h);
}

void TablesBody::ring_on(double time) {
  Work& w = *work_;
  TouchState& state = *w.state;
  w.is_bent_at_once = true;
  if (!state.vibration.moves) return;
  state.u -= w.inertia->field(state.vibration);
  w.inertia->ring_on(state.vibration, time);
  state.u += w.inertia->field(state.vibration);
  w.shape = &state.u;
  w.forget_surface();
}

void TablesBody::forget_time() { work_->is_timed = false; }

double TablesBody::ringing() const {
  return work_->inertia ? work_->inertia->energy(work_->state->vibration) : 0.0;
}

double TablesBody::largest_speed() const {
  return work_->inertia ? work_->inertia->largest_speed(work_->state->vibration) : 0.0;
}

double TablesBody::way_by_inertia(std::span<const int> vertices) {
  Work& w = *work_;
  if (!w.inertia || vertices.empty()) return 0;
  return w.inertia->largest_way(w.q_of_shape, w.state->vibration, vertices);
}

double TablesBody::amplitude() const {
  return work_->inertia ? work_->inertia->amplitude(work_->state->vibration) : 0.0;
}

std::vector<PointForce>& TablesBody::forces() { return work_->state->forces; }
std::vector<PointAnchor>& TablesBody::anchors() { return work_->state->anchors; }
double TablesBody::friction() const {
  return work_->settings.friction.value_or(work_->tables.friction);
}

// --- shape

Vector3f TablesBody::shape_at(int point) {
  const Work& w = *work_;
  return w.skin.places().col(point) + w.skin.moved(static_cast<std::size_t>(point), *w.shape);
}

Vector3f TablesBody::shape_at_vertex(int vertex) {
  return work_->rest.col(vertex) + work_->shape->col(vertex);
}

Vector3f TablesBody::shape_at(const SkinPoint& foot) {
  const Work& w = *work_;
  Vector3f x = w.skin.rest_at(foot);
  const ForceShares shares = w.skin.shares_of(foot);
  for (std::size_t k = 0; k < shares.count; ++k) {
    x += shares.of[k].weight * w.shape->col(shares.of[k].vertex);
  }
  return x;
}

Vector3f TablesBody::rest_at(const SkinPoint& foot) const { return work_->skin.rest_at(foot); }

Vector3f TablesBody::normal_at(int point) {
  Work& w = *work_;
  if (w.skin.is_carried()) return Vector3f::Zero();
  const MovingSurface& now = surface();
  const SkinPoint& at = w.points[static_cast<std::size_t>(point)];
  Vector3f sum = Vector3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight = at.weights[static_cast<int>(k)];
    if (weight != 0) sum += weight * now.vertex_normal(at.corners[k]);
  }
  return sum.normalized();
}

Eigen::AlignedBox3f TablesBody::bounds() {
  Work& w = *work_;
  if (w.skin.is_carried()) return surface().bounds();
  if (w.bounds.isEmpty()) {
    for (Eigen::Index v = 0; v < w.rest.cols(); ++v) {
      w.bounds.extend(Vector3f(w.rest.col(v) + w.shape->col(v)));
    }
  }
  return w.bounds;
}

const MovingSurface& TablesBody::surface() {
  Work& w = *work_;
  if (!w.surface) {
    w.surface.emplace(w.rest_skin);
    w.placed.resize(3, w.rest_skin.vertex_count());
  }
  if (w.is_surface_old) {
    w.skin.update_normals(*w.shape);
    w.skin.place(*w.shape, w.placed);
    w.surface->move(w.placed);
    w.is_surface_old = false;
  }
  return *w.surface;
}

// --- a step

void TablesBody::clear_places() { work_->next.clear(); }

bool TablesBody::add_place(int point) {
  const Work& w = *work_;
  const auto p = static_cast<std::size_t>(point);
  const SkinPoint& at = w.points[p];
  Place place;
  place.at_rest = w.skin.places().col(point) + w.skin.lift_of(p);
  // All three corners, also those without weight: patches are chosen among them.
  place.shares.count = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    place.shares.of[k] = {at.corners[k], at.weights[static_cast<int>(k)]};
  }
  return work_->next.add(place);
}

bool TablesBody::add_place(const SkinPoint& foot) {
  Place place;
  place.is_foot = true;
  place.at_rest = work_->skin.rest_at(foot);
  place.shares = work_->skin.shares_of(foot);
  return work_->next.add(place);
}

void TablesBody::begin_step(std::span<const PlaceLoad> loads, bool last) {
  Work& w = *work_;
  w.places.assign(w.next.places().begin(), w.next.places().end());
  w.vertices.assign(w.next.vertices().begin(), w.next.vertices().end());
  w.is_last = last;
  w.iteration = 0;
  w.cache->bring(w.vertices);
  w.loads.clear();
  for (const int v : w.vertices) w.loads.push_back({v, Vector3f::Zero()});
  for (Place& place : w.places) {
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      place.slots[k] = w.cache->slot_of(place.shares.of[k].vertex);
    }
  }
  w.set_loads([&](std::size_t p) { return loads[p].force; });
  if (w.is_timed) w.inertia->begin_step(w.state->vibration, w.loads);
  if (w.is_nonlinear()) {
    w.weigh(loads);
    w.choose_patches();
  }
  w.find_displacements(CrossTerms::kAnew);
}

void TablesBody::go_on(std::span<const PlaceLoad> loads) {
  Work& w = *work_;
  w.iteration = 0;
  w.set_loads([&](std::size_t p) { return loads[p].force; });
  if (w.is_timed) w.inertia->begin_step(w.state->vibration, w.loads);
  if (w.followed && w.follows_loads()) w.followed->go_on(*w.inertia);
  w.find_displacements(CrossTerms::kAsBefore);
}

// Weights are the forces, and to a small part the penetration; before the first touch the
// penetration alone.
void TablesBody::Work::weigh(std::span<const PlaceLoad> entries) {
  weights.assign(vertices.size(), 0.0f);
  float pressing = 0;
  for (const VertexForce& load : loads) pressing += load.force.norm();
  const float per_m = pressing > 0 ? 0.1f * pressing / static_cast<float>(settings.band) : 1.0f;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Place& place = places[p];
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      weights[static_cast<std::size_t>(place.local[k])] +=
          place.shares.of[k].weight * (entries[p].force.norm() + per_m * entries[p].entry);
    }
  }
}

// G f at the vertices that take part: G is symmetric, so it is a sum of its rows.
void TablesBody::Work::fill_field() {
  std::fill(field.begin(), field.end(), 0.0f);
  for (const VertexForce& load : loads) {
    if (load.force.isZero(0)) continue;
    const float* of_load = cache->blocks().col(3 * cache->slot_of(load.vertex)).data();
    best_row_kernels().add_float_rows(of_load, field.size(), {load.force.data(), 3}, field);
  }
}

void TablesBody::Work::choose_patches() {
  if (follows_loads()) {
    followed->begin_step(*inertia, *cache, state->vibration, loads, weights, state->regions,
                         nonlinear);
  } else {
    nonlinear.choose_patches(vertices, weights, state->regions);
  }
}

// Hands what moves to the state.
void TablesBody::Work::keep_vibration(bool is_free) {
  VibrationState& vibration = state->vibration;
  if (is_timed) {
    inertia->end_step(vibration, is_free);
  } else {
    inertia->rest(vibration, loads);
  }
  if (!followed) return;
  if (!follows_loads()) {
    FollowedLoads::rest(loads, vibration);
    return;
  }
  followed->end_step(loads, vibration);
  if (!vibration.moves) vibration.followed.clear();
}

// In a step with time begin_step() has evaluated them.
void TablesBody::Work::evaluate_nonlinear(CrossTerms cross) {
  if (!follows_loads()) {
    nonlinear.evaluate(loads, cross);
  } else if (!(inertia->step() > 0)) {
    followed->evaluate(loads, cross, nonlinear);
  }
}

// Computes the displacements of all vertices that take part, under the present loads.
void TablesBody::Work::find_displacements(CrossTerms cross) {
  if (is_timed) inertia->load(loads);
  if (is_nonlinear()) evaluate_nonlinear(cross);
  fill_field();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    here.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Vector3f>(field.data() + 3 * cache->slot_of(vertices[i]));
  }
  const auto n = static_cast<Eigen::Index>(vertices.size());
  correcting = state->refinement.weights_under(loads, here.leftCols(n));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    auto u = here.col(static_cast<Eigen::Index>(i));
    if (is_nonlinear()) u += nonlinear.displacement_at(vertices[i]);
    for (std::size_t k = 0; k < correcting.size(); ++k) {
      if (correcting[k] > 0) {
        u += correcting[k] * state->refinement.corrections[k].field.col(vertices[i]);
      }
    }
    if (is_timed) u += inertia->displacement_at(vertices[i]);
  }
}

Vector3f TablesBody::position(std::size_t place) const {
  return position_of(work_->places[place], work_->here);
}

// --- an iteration

bool TablesBody::linearise() {
  Work& w = *work_;
  ++w.iteration;
  const auto n = static_cast<Eigen::Index>(w.vertices.size());
  w.before.leftCols(n) = w.here.leftCols(n);
  return true;
}

void TablesBody::add_compliance(std::span<const UnitForce> forces, Tangent tangent,
                                std::span<double> W, std::size_t m, std::span<double> q) {
  work_->tangent.add_compliance(work_->tables_now(tangent), forces, W, m, q);
}

void TablesBody::add_tangential(std::span<const UnitForce> forces, Tangent tangent,
                                std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                                std::span<double> q_t) {
  const TablesAt at = work_->tables_now(tangent);
  if (tangent == Tangent::kSafe) {
    work_->tangent.add_tangential(at, forces, W_nt, wide, W_tt, q_t);
  } else {
    work_->tangent.add_all_tangential(at, forces, W_nt, wide, W_tt, q_t);
  }
}

double TablesBody::skin_compliance(double, float softness, bool is_foot) const {
  if (is_foot) return 0;
  return (work_->settings.softness + static_cast<double>(softness)) * work_->tangent.mean();
}

// Sums the forces of the places at their vertices. @param force_of  N, of a place's number
template <class ForceOf>
void TablesBody::Work::set_loads(const ForceOf& force_of) {
  for (VertexForce& load : loads) load.force.setZero();
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Place& place = places[p];
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      loads[static_cast<std::size_t>(place.local[k])].force +=
          place.shares.of[k].weight * force_of(p);
    }
  }
}

double TablesBody::move(std::span<const Vector3f> forces, double) {
  Work& w = *work_;
  w.set_loads([&](std::size_t p) { return forces[p]; });
  w.find_displacements(w.cross_terms());
  const auto n = static_cast<Eigen::Index>(w.vertices.size());
  if (n == 0) return 0;
  return static_cast<double>(
      (w.here.leftCols(n) - w.before.leftCols(n)).colwise().norm().maxCoeff());
}

// --- end of a step

// Computes the displacement of the first nodes under the present loads.
void TablesBody::Work::fill_shape(Eigen::Index nodes) {
  Eigen::Ref<Matrix3Xf> u = formed.leftCols(nodes);
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
    const Matrix3Xf& c = state->refinement.corrections[k].field;
    u += correcting[k] * c.leftCols(nodes);
    linear += correcting[k] * c.leftCols(linear.cols());
    if (is_nonlinear()) without_cross += correcting[k] * c.leftCols(linear.cols());
  }
  if (is_timed) {
    const Matrix3Xf& lag = inertia->field(nodes);
    u += lag.leftCols(nodes);
    linear += lag.leftCols(linear.cols());
    if (is_nonlinear()) without_cross += lag.leftCols(linear.cols());
  }
}

void TablesBody::form_shape(bool all) {
  Work& w = *work_;
  w.fill_shape(all ? w.formed.cols() : w.rest.cols());
  w.shape = &w.formed;
  w.is_formed = true;
  w.q_of_shape = w.state->vibration.q;
  w.forget_surface();
}

bool TablesBody::has_moved(double way) const {
  const Work& w = *work_;
  const Eigen::Index V = w.rest.cols();
  const float moved =
      (w.formed.leftCols(V) - w.state->u.leftCols(V)).colwise().squaredNorm().maxCoeff();
  const auto least = static_cast<float>(way);
  return moved > least * least;
}

void TablesBody::keep(bool is_free) {
  Work& w = *work_;
  TouchState& state = *w.state;
  state.regions.assign(w.nonlinear.regions().begin(), w.nonlinear.regions().end());
  state.refinement.weights = w.correcting;
  if (w.inertia) w.keep_vibration(is_free);
  keep_shape();
}

void TablesBody::keep_shape() {
  Work& w = *work_;
  if (w.is_formed) w.state->u.swap(w.formed);
  w.shape = &w.state->u;
  w.is_formed = false;
}

// --- end of a frame

// Computes the error indicators from the parts of the displacement.
void TablesBody::end_frame(double penetration) {
  Work& w = *work_;
  w.report = {w.nonlinear.patch_count(), static_cast<double>(w.nonlinear.last_share()), {}, {}};
  const bool has_feet = std::any_of(w.places.begin(), w.places.end(),
                                    [](const Place& place) { return place.is_foot; });
  if (w.state->forces.empty() && !has_feet) return;
  double all = 0, beyond = 0, cross = 0, largest = 0;
  for (Eigen::Index v = 0; v < w.linear.cols(); ++v) {
    const Vector3f u = w.state->u.col(v);
    const auto moved = static_cast<double>(u.squaredNorm());
    all += moved;
    largest = std::max(largest, moved);
    beyond += static_cast<double>((u - w.linear.col(v)).squaredNorm());
    if (w.is_nonlinear()) {
      cross += static_cast<double>((u - w.without_cross.col(v)).squaredNorm());
    }
  }
  if (!(all > 0)) return;
  double left = 1;
  for (const float weight : w.correcting) left -= kCorrected * static_cast<double>(weight);
  left = std::max(1 - kCorrected, left);
  w.report.indicators = {std::max(0.0, penetration) / std::sqrt(largest),
                         left * std::sqrt(beyond / all), left * std::sqrt(cross / all)};
  if (w.error_scale) w.report.stated = w.error_scale->stated(w.report.indicators);
}

const TablesReport& TablesBody::report() const { return work_->report; }

double TablesBody::moved() const {
  const Eigen::Index V = work_->rest.cols();
  return static_cast<double>(
      (work_->state->u.leftCols(V) - work_->began.leftCols(V)).colwise().norm().maxCoeff());
}

void TablesBody::limit_step(double share) {
  Work& w = *work_;
  TouchState& state = *w.state;
  const auto s = static_cast<float>(share);
  state.u = w.began + s * (state.u - w.began);
  if (w.is_timed) w.inertia->limit_step(state.vibration, w.vibration_at_start, share);
  w.forces_at_start.limit_step(state.forces, s);
  w.forget_surface();
}

// --- any state

void TablesBody::place(const TouchState& state, Matrix3Xf& skin) {
  work_->skin.update_normals(state.u);
  work_->skin.place(state.u, skin);
}

void TablesBody::find_moved(const TouchState& state, std::vector<Vector3f>& moved) {
  work_->skin.update_normals(state.u);
  moved.clear();
  for (const PointForce& at : state.forces) {
    moved.push_back(work_->skin.moved(static_cast<std::size_t>(at.point), state.u));
  }
}

void TablesBody::stress(const TouchState& state, std::span<float> von_mises,
                        std::span<float> cauchy) {
  Work& w = *work_;
  PALPABLE_EXPECT(w.shell.has_value(), "stress needs tables with a shell");
  const Matrix3Xf& u = state.u.cols() == 0 ? w.no_displacement : state.u;
  if (!w.skin.is_carried()) {
    w.shell->evaluate(u, von_mises, cauchy);
    return;
  }
  const std::span<float> tensors =
      cauchy.empty() ? std::span<float>() : std::span<float>(w.coarse_tensors);
  w.shell->evaluate(u, w.coarse_stress, tensors);
  w.skin.spread(w.coarse_stress, 1, von_mises);
  if (!cauchy.empty()) w.skin.spread(tensors, 6, cauchy);
}

bool TablesBody::request(const TouchState& state, RequestedLoad& load) {
  Work& w = *work_;
  load.forces.clear();
  if (state.forces.empty() || state.refinement.blended < 1) return false;
  load.forces.reserve(6 * std::size_t{kMostPlacesWithOthers});
  for (const PointForce& at : state.forces) {
    const SkinPoint& point = w.points[static_cast<std::size_t>(at.point)];
    for (std::size_t k = 0; k < 3; ++k) {
      const float weight = point.weights[static_cast<int>(k)];
      if (weight > 0) load.forces.push_back({point.corners[k], weight * at.force});
    }
  }
  add_up_by_vertex(load.forces);
  load.linear.resize(3, w.rest.cols());
  w.linear_field.fill(load.forces, load.linear);
  load.tables = state.u;
  for (std::size_t k = 0; k < 2; ++k) {
    const float weight = state.refinement.weights[k];
    if (weight > 0) load.tables -= weight * state.refinement.corrections[k].field;
  }
  if (state.vibration.moves) load.tables -= w.inertia->field(state.vibration);
  return true;
}

void TablesBody::probe(RequestedLoad& load) {
  make_probe(work_->linear_field, static_cast<int>(work_->rest.cols()), work_->compliance.nodes(),
             load);
}

bool TablesBody::refine(TouchState& state, const RequestedLoad& load,
                        const Matrix3Xf& exact) const {
  PALPABLE_EXPECT(exact.cols() == work_->compliance.nodes() && load.tables.cols() == exact.cols() &&
                      load.linear.cols() == work_->rest.cols(),
                  "a solution has as many nodes as the tables");
  return state.refinement.take_up(load, exact);
}

}  // namespace palpable
