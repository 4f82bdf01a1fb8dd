#include "palpable/common/response/tables_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/response/compliance_cache.h"
#include "palpable/common/response/linear_field.h"
#include "palpable/common/response/nonlinear_answer.h"
#include "palpable/common/response/shell_stress.h"
#include "palpable/common/response/touch_skin.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// Iterations of a frame's last step in which what patches do to each other is evaluated anew: it is
// of the second order, and the forces change little after them.
constexpr int kCrossIterations = 2;
// Of TouchSettings::largest_step: an iteration moves no point by more.
constexpr double kLargestChange = 4;
// Of the tables' part in a state's own error, what an exact answer takes out: of the stress' error
// more, of the displacement's less, since contact's own is left (docs/touch.md).
constexpr double kCorrected = 0.5;
constexpr float kClusterRadius = 0.006f;  // m, of contact points
// m between points that are compared with other bodies' skins.
constexpr float kBetweenSkins = 0.003f;
// Forces of a state that was held back: those of two frames.
constexpr std::size_t kMostForces = 2 * std::size_t{kMostPlacesWithOthers};

int most_modes(const TouchTables& tables) {
  int most = 16;
  for (const RegionTable& region : tables.regions) most = std::max(most, region.mode_count());
  return most;
}

ContactLimits tables_limits(const TouchSettings& s) {
  ContactLimits limits = limits_from(s);
  limits.largest_change = kLargestChange * s.largest_step;
  return limits;
}

// A place that takes part: vertices that the tables know, with weights.
struct Place {
  ForceShares shares;
  Vector3f at_rest = Vector3f::Zero();  // m, and what a height over a coarser skin adds
  std::array<int, 9> local{};           // of the shares, among the vertices that take part,
  std::array<int, 9> slots{};           // and in the compliance
  bool is_foot = false;                 // of another body's contact point
};

// direction . field at a place, whose field has three values a slot.
float along(const Place& place, const Vector3f& direction, const float* field) {
  float sum = 0;
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    const float* at = field + 3 * place.slots[k];
    sum += place.shares.of[k].weight *
           (direction[0] * at[0] + direction[1] * at[1] + direction[2] * at[2]);
  }
  return sum;
}

// Vertices of places, each once in the order in which they were added.
struct PlaceList {
  std::vector<Place> places;
  std::vector<int> vertices;
};

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
  NonlinearAnswer nonlinear;
  std::optional<ComplianceCache> cache;
  std::optional<ShellStress> shell;
  std::vector<float> carrying_stress, carrying_tensors;  // (V), (6V) Pa of a coarser skin
  std::optional<ErrorScale> error_scale;                 // of the tables' held-out touches
  std::optional<MovingSurface> surface;                  // made when another body asks for it
  SurfaceMesh rest_skin;                                 // of which it is made
  Matrix3Xf placed;                                      // (3 x F) m
  bool is_surface_old = true;

  // The frame.
  TouchState* state = nullptr;
  Matrix3Xf ahead;  // (3 x W) m, formed by form_shape()
  const Matrix3Xf* shape = nullptr;
  bool is_formed = false;
  Matrix3Xf began;  // (3 x W) m
  ForcesBegun forces_began{kMostForces};
  TablesReport report;
  std::array<float, 2> correcting{};  // weights of the state's corrections, under these loads
  Matrix3Xf linear, without_cross;    // (3 x V) the shape without the tables' beyond, and
                                      // without what patches do to each other
  Matrix3Xf no_displacement;          // (3 x W)

  // The step.
  PlaceList next, now;               // places of the next step, and those that take part
  std::vector<int> local_of_vertex;  // (V) in next.vertices; -1: not among them
  std::vector<VertexForce> loads;    // at now.vertices
  std::vector<float> weights;        // of these, for choosing patches
  std::vector<float> field;          // (3 x slots of the cache) G f
  Matrix3Xf here, before;            // (3 x vertices) displacement now, and at linearise()
  std::size_t most_places = 0;
  int most_vertices = 0;  // of all places,
  int own_vertices = 0;   // and so many of next.vertices are of contact points
  bool is_last = false;
  int iteration = 0;

  // The tangent: rows of unit forces.
  struct PatchRows {                  // of one patch, rising, and where its mode rows begin
    std::size_t first = 0, last = 0;  // in order
    std::size_t at = 0;               // in mode_rows and turned
  };
  std::size_t width = 0, modes_wide;     // 3 slots, r of the largest region
  std::vector<float> rows;               // (P x width) G d
  std::vector<float> mode_rows, turned;  // (P x r) d U, d U H, patch by patch
  std::vector<std::size_t> order;        // (P) unit forces, patch by patch
  std::vector<PatchRows> patches;
  std::vector<int> patch_of;             // (P) whose modes a row is of; -1: none
  std::vector<float> turned_code, sums;  // (r), (P)
  std::vector<float> tangent_row;        // (width)
  std::vector<UnitForce> normals;        // of the last add_compliance()
  double mean = 0;                       // m/N, of the places' own compliance

  Work(const SurfaceMesh& surface_mesh, std::span<const std::uint8_t> fixed,
       const TouchTables& the_tables, const TouchSettings& the_settings);

  void make_room(int places, int vertices);
  [[nodiscard]] bool is_nonlinear() const { return settings.nonlinear && !tables.regions.empty(); }
  bool add(const Place& place);
  void choose_patches(std::span<const PlaceLoad> entries);
  void find_displacements(CrossTerms cross);
  void weigh_corrections();
  void add_row(const Place& place, const Vector3f& direction, std::span<float> row) const;
  void find_mode_rows(std::span<const UnitForce> forces);
  void add_modes(std::span<const UnitForce> forces, std::span<double> W, std::size_t m,
                 std::span<double> q);
  void fill_shape(Eigen::Index nodes);
  void set_loads(std::span<const Vector3f> forces);
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
      ahead(Matrix3Xf::Zero(3, compliance.nodes())),
      began(ahead),
      linear(3, rest.cols()),
      without_cross(3, rest.cols()),
      no_displacement(ahead),
      local_of_vertex(static_cast<std::size_t>(rest.cols()), -1),
      modes_wide(static_cast<std::size_t>(most_modes(tables))) {
  shape = &no_displacement;
  if (skin.is_carried()) {
    carrying_stress.resize(static_cast<std::size_t>(rest.cols()));
    carrying_tensors.resize(6 * carrying_stress.size());
  }
  if (tables.shell.nodes() > 0) shell.emplace(tables.shell, static_cast<int>(rest.cols()));
  patches.reserve(NonlinearAnswer::kMostBlobs);
  turned_code.resize(modes_wide);
  make_room(kMostPlaces, kMostVertices);
}

void TablesBody::Work::make_room(int places, int vertices) {
  most_places = static_cast<std::size_t>(places);
  most_vertices = vertices;
  cache.emplace(compliance, vertices);
  width = static_cast<std::size_t>(cache->blocks().rows());
  PALPABLE_EXPECT(width == padded(width), "a compliance has whole rows' steps");
  for (PlaceList* list : {&next, &now}) {
    list->places.reserve(most_places);
    list->vertices.reserve(static_cast<std::size_t>(vertices));
  }
  loads.reserve(static_cast<std::size_t>(vertices));
  weights.reserve(static_cast<std::size_t>(vertices));
  here.resize(3, vertices);
  before.resize(3, vertices);
  field.resize(width);
  tangent_row.resize(width);
  rows.resize(most_places * width);
  mode_rows.resize(most_places * modes_wide);
  turned.resize(most_places * modes_wide);
  order.resize(most_places);
  patch_of.resize(most_places);
  sums.resize(most_places);
  normals.reserve(most_places);
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
          kBetweenSkins};
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
    state.regions.clear();
    state.regions.reserve(NonlinearAnswer::kMostBlobs);
  }
  w.skin.face_as(state.u);
  w.shape = &state.u;
  w.is_formed = false;
  w.is_surface_old = true;
  w.began = state.u;
  w.forces_began.start(state.forces);
}

bool TablesBody::is_at_rest() const {
  return work_->state->u.cols() > 0 && work_->state->forces.empty() && work_->state->u.isZero(0);
}

std::vector<PointForce>& TablesBody::forces() { return work_->state->forces; }

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
  const Work& w = *work_;
  if (w.skin.is_carried()) return surface().bounds();
  Eigen::AlignedBox3f box;
  for (Eigen::Index v = 0; v < w.rest.cols(); ++v) {
    box.extend(Vector3f(w.rest.col(v) + w.shape->col(v)));
  }
  return box;
}

const MovingSurface& TablesBody::surface() {
  Work& w = *work_;
  if (!w.surface) {
    w.surface.emplace(w.rest_skin);
    w.placed.resize(3, w.rest_skin.vertex_count());
  }
  if (w.is_surface_old) {
    w.skin.face_as(*w.shape);
    w.skin.place(*w.shape, w.placed);
    w.surface->move(w.placed);
    w.is_surface_old = false;
  }
  return *w.surface;
}

// --- a step

void TablesBody::clear_places() {
  Work& w = *work_;
  for (const int v : w.next.vertices) w.local_of_vertex[static_cast<std::size_t>(v)] = -1;
  w.next.vertices.clear();
  w.next.places.clear();
  w.own_vertices = 0;
}

// Whether its vertices find room.
bool TablesBody::Work::add(const Place& place) {
  const std::span shares(place.shares.of.data(), place.shares.count);
  const auto missing = std::count_if(shares.begin(), shares.end(), [&](const ForceShare& share) {
    return local_of_vertex[static_cast<std::size_t>(share.vertex)] < 0;
  });
  const int more = static_cast<int>(missing);
  if (next.places.size() == most_places ||
      static_cast<int>(next.vertices.size()) + more > most_vertices ||
      (!place.is_foot && own_vertices + more > kMostVertices)) {
    return false;
  }
  if (!place.is_foot) own_vertices += more;
  next.places.push_back(place);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    int& local = local_of_vertex[static_cast<std::size_t>(shares[k].vertex)];
    if (local < 0) {
      local = static_cast<int>(next.vertices.size());
      next.vertices.push_back(shares[k].vertex);
    }
    next.places.back().local[k] = local;
  }
  return true;
}

bool TablesBody::add_place(int point) {
  const Work& w = *work_;
  const auto p = static_cast<std::size_t>(point);
  const SkinPoint& at = w.points[p];
  Place place;
  place.at_rest = w.skin.places().col(point) + w.skin.lifted(p);
  // All three corners, those without weight, too: patches are chosen among them.
  place.shares.count = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    place.shares.of[k] = {at.corners[k], at.weights[static_cast<int>(k)]};
  }
  return work_->add(place);
}

bool TablesBody::add_place(const SkinPoint& foot) {
  Place place;
  place.is_foot = true;
  place.at_rest = work_->skin.rest_at(foot);
  place.shares = work_->skin.shares_of(foot);
  return work_->add(place);
}

void TablesBody::begin_step(std::span<const PlaceLoad> loads, bool last) {
  Work& w = *work_;
  w.now.places.assign(w.next.places.begin(), w.next.places.end());
  w.now.vertices.assign(w.next.vertices.begin(), w.next.vertices.end());
  w.is_last = last;
  w.iteration = 0;
  w.cache->bring(w.now.vertices);
  w.loads.clear();
  for (const int v : w.now.vertices) w.loads.push_back({v, Vector3f::Zero()});
  for (std::size_t p = 0; p < w.now.places.size(); ++p) {
    Place& place = w.now.places[p];
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      const ForceShare& share = place.shares.of[k];
      place.slots[k] = w.cache->slot_of(share.vertex);
      w.loads[static_cast<std::size_t>(place.local[k])].force += share.weight * loads[p].force;
    }
  }
  if (w.is_nonlinear()) w.choose_patches(loads);
  w.find_displacements(CrossTerms::kAnew);
}

// What presses decides; before the first touch what is deepest in the obstacle.
void TablesBody::Work::choose_patches(std::span<const PlaceLoad> entries) {
  weights.assign(now.vertices.size(), 0.0f);
  float pressing = 0;
  for (const VertexForce& load : loads) pressing += load.force.norm();
  const float per_m = pressing > 0 ? 0.1f * pressing / static_cast<float>(settings.band) : 1.0f;
  for (std::size_t p = 0; p < now.places.size(); ++p) {
    const Place& place = now.places[p];
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      weights[static_cast<std::size_t>(place.local[k])] +=
          place.shares.of[k].weight * (entries[p].force.norm() + per_m * entries[p].entry);
    }
  }
  nonlinear.choose_blobs(now.vertices, weights, state->regions);
}

// Of all vertices that take part, under the present loads.
void TablesBody::Work::find_displacements(CrossTerms cross) {
  if (is_nonlinear()) nonlinear.evaluate(loads, cross);
  // G is symmetric: what a load does everywhere are its rows.
  std::fill(field.begin(), field.end(), 0.0f);
  for (const VertexForce& load : loads) {
    if (load.force.isZero(0)) continue;
    const float* of_load = cache->blocks().col(3 * cache->slot_of(load.vertex)).data();
    best_row_kernels().add_float_rows(of_load, field.size(), {load.force.data(), 3}, field);
  }
  for (std::size_t i = 0; i < now.vertices.size(); ++i) {
    here.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Vector3f>(field.data() + 3 * cache->slot_of(now.vertices[i]));
  }
  weigh_corrections();
  for (std::size_t i = 0; i < now.vertices.size(); ++i) {
    auto u = here.col(static_cast<Eigen::Index>(i));
    if (is_nonlinear()) u += nonlinear.displacement_at(now.vertices[i]);
    for (std::size_t k = 0; k < correcting.size(); ++k) {
      if (correcting[k] > 0) {
        u += correcting[k] * state->refinement.corrections[k].field.col(now.vertices[i]);
      }
    }
  }
}

// How far each correction holds under the present loads. @pre `here` is their linear answer
void TablesBody::Work::weigh_corrections() {
  const Refinement& refinement = state->refinement;
  correcting.fill(0.0f);
  if (!refinement.acts()) return;
  float work = 0;
  std::array<float, 2> shared{};
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Vector3f& f = loads[i].force;
    work += f.dot(here.col(static_cast<Eigen::Index>(i)));
    for (std::size_t k = 0; k < shared.size(); ++k) {
      const ExactCorrection& c = refinement.corrections[k];
      if (c.work > 0) shared[k] += f.dot(c.linear.col(now.vertices[i]));
    }
  }
  const std::array blended{1 - refinement.blended, refinement.blended};
  for (std::size_t k = 0; k < shared.size(); ++k) {
    correcting[k] = blended[k] * correction_weight(work, shared[k], refinement.corrections[k].work);
  }
}

Vector3f TablesBody::position(std::size_t place) const {
  const Work& w = *work_;
  const Place& p = w.now.places[place];
  Vector3f x = p.at_rest;
  for (std::size_t k = 0; k < p.shares.count; ++k) {
    x += p.shares.of[k].weight * w.here.col(p.local[k]);
  }
  return x;
}

// --- an iteration

bool TablesBody::linearise() {
  Work& w = *work_;
  ++w.iteration;
  const auto n = static_cast<Eigen::Index>(w.now.vertices.size());
  w.before.leftCols(n) = w.here.leftCols(n);
  return true;
}

// row = G times a force of 1 N at a place.
void TablesBody::Work::add_row(const Place& place, const Vector3f& direction,
                               std::span<float> row) const {
  std::fill(row.begin(), row.end(), 0.0f);
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    const float weight = place.shares.of[k].weight;
    if (weight == 0) continue;
    const Vector3f force = weight * direction;
    best_row_kernels().add_float_rows(
        cache->blocks().data() + static_cast<std::size_t>(3 * place.slots[k]) * width, width,
        {force.data(), 3}, row);
  }
}

// mode_rows and turned of unit forces, patch by patch.
void TablesBody::Work::find_mode_rows(std::span<const UnitForce> forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const ForceShares& shares = now.places[forces[i].place].shares;
    const auto* heaviest = std::max_element(
        shares.of.begin(), shares.of.begin() + shares.count,
        [](const ForceShare& a, const ForceShare& b) { return a.weight < b.weight; });
    patch_of[i] = nonlinear.blob_of(heaviest->vertex);
  }
  patches.clear();
  std::size_t next_row = 0;
  for (int patch = 0; patch < nonlinear.blob_count(); ++patch) {
    const auto r = static_cast<std::size_t>(nonlinear.region_of(patch).mode_count());
    PatchRows of_patch{next_row, next_row, next_row * modes_wide};
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (patch_of[i] != patch) continue;
      const Place& place = now.places[forces[i].place];
      const std::size_t at = of_patch.at + (next_row - of_patch.first) * r;
      const std::span<float> row(mode_rows.data() + at, r);
      std::fill(row.begin(), row.end(), 0.0f);
      for (std::size_t k = 0; k < place.shares.count; ++k) {
        const auto [vertex, weight] = place.shares.of[k];
        if (weight != 0) nonlinear.add_mode_row(patch, vertex, weight * forces[i].direction, row);
      }
      nonlinear.times(patch, row, {turned.data() + at, r});
      order[next_row++] = i;
    }
    of_patch.last = next_row;
    patches.push_back(of_patch);
  }
}

// What the regions add to W and q.
void TablesBody::Work::add_modes(std::span<const UnitForce> forces, std::span<double> W,
                                 std::size_t m, std::span<double> q) {
  find_mode_rows(forces);
  for (int patch = 0; patch < nonlinear.blob_count(); ++patch) {
    const PatchRows& of_patch = patches[static_cast<std::size_t>(patch)];
    const std::span<const float> code = nonlinear.code(patch);
    const std::span<float> turned_now(turned_code.data(), code.size());
    nonlinear.times(patch, code, turned_now);
    best_row_kernels().dots_floats(mode_rows.data() + of_patch.at, of_patch.last - of_patch.first,
                                   turned_now, sums.data());
    for (std::size_t i = of_patch.first; i < of_patch.last; ++i) {
      q[forces[order[i]].row] -= static_cast<double>(sums[i - of_patch.first]);
    }
    const std::size_t r = code.size();
    for (std::size_t i = 0; i < of_patch.last - of_patch.first; ++i) {
      best_row_kernels().dots_floats(mode_rows.data() + of_patch.at, i + 1,
                                     {turned.data() + of_patch.at + i * r, r}, sums.data());
      double* row = W.data() + forces[order[of_patch.first + i]].row * m;
      for (std::size_t j = 0; j <= i; ++j) {
        row[forces[order[of_patch.first + j]].row] += static_cast<double>(sums[j]);
      }
    }
  }
}

void TablesBody::add_compliance(std::span<const UnitForce> forces, Tangent tangent,
                                std::span<double> W, std::size_t m, std::span<double> q) {
  Work& w = *work_;
  w.normals.assign(forces.begin(), forces.end());
  const auto place_of = [&](const UnitForce& f) -> const Place& { return w.now.places[f.place]; };
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const UnitForce& f = forces[i];
    const std::span<float> row(w.rows.data() + i * w.width, w.width);
    w.add_row(place_of(f), f.direction, row);
    q[f.row] -= static_cast<double>(along(place_of(f), f.direction, w.field.data()));
    for (std::size_t j = 0; j <= i; ++j) {
      W[f.row * m + forces[j].row] +=
          static_cast<double>(along(place_of(forces[j]), forces[j].direction, row.data()));
    }
  }
  if (tangent == Tangent::kFull && w.is_nonlinear()) w.add_modes(forces, W, m, q);
  w.mean = 0;
  for (const UnitForce& f : forces) {
    w.mean += W[f.row * m + f.row] / static_cast<double>(forces.size());
  }
}

// By the linear answer alone: the turning of normals is a small part of the tangent.
void TablesBody::add_tangential(std::span<const UnitForce> forces, std::span<float> W_nt,
                                std::size_t wide, std::span<double> W_tt, std::span<double> q_t) {
  Work& w = *work_;
  const std::size_t t = q_t.size();
  const auto place_of = [&](const UnitForce& f) -> const Place& { return w.now.places[f.place]; };
  for (std::size_t p = 0; p < w.normals.size(); ++p) {
    float* to = W_nt.data() + w.normals[p].row * wide;
    for (const UnitForce& f : forces) {
      to[f.row] += along(place_of(f), f.direction, w.rows.data() + p * w.width);
    }
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const UnitForce& f = forces[i];
    w.add_row(place_of(f), f.direction, w.tangent_row);
    for (std::size_t j = 0; j <= i; ++j) {
      const UnitForce& other = forces[j];
      const auto value =
          static_cast<double>(along(place_of(other), other.direction, w.tangent_row.data()));
      W_tt[f.row * t + other.row] += value;
      if (i != j) W_tt[other.row * t + f.row] += value;
    }
    q_t[f.row] -= static_cast<double>(along(place_of(f), f.direction, w.field.data()));
  }
}

double TablesBody::skin_compliance(double, float softness, bool is_foot) const {
  if (is_foot) return 0;
  return (work_->settings.softness + static_cast<double>(softness)) * work_->mean;
}

void TablesBody::Work::set_loads(std::span<const Vector3f> forces) {
  for (VertexForce& load : loads) load.force.setZero();
  for (std::size_t p = 0; p < now.places.size(); ++p) {
    const Place& place = now.places[p];
    for (std::size_t k = 0; k < place.shares.count; ++k) {
      loads[static_cast<std::size_t>(place.local[k])].force +=
          place.shares.of[k].weight * forces[p];
    }
  }
}

double TablesBody::move(std::span<const Vector3f> forces, double) {
  Work& w = *work_;
  w.set_loads(forces);
  w.find_displacements(w.cross_terms());
  const auto n = static_cast<Eigen::Index>(w.now.vertices.size());
  if (n == 0) return 0;
  return static_cast<double>(
      (w.here.leftCols(n) - w.before.leftCols(n)).colwise().norm().maxCoeff());
}

// --- end of a step

// The first nodes' displacement under the present loads.
void TablesBody::Work::fill_shape(Eigen::Index nodes) {
  Eigen::Ref<Matrix3Xf> u = ahead.leftCols(nodes);
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
}

void TablesBody::form_shape(bool all) {
  Work& w = *work_;
  w.fill_shape(all ? w.ahead.cols() : w.rest.cols());
  w.shape = &w.ahead;
  w.is_formed = true;
  w.is_surface_old = true;
}

bool TablesBody::has_moved(double way) const {
  const Work& w = *work_;
  const Eigen::Index V = w.rest.cols();
  const float moved =
      (w.ahead.leftCols(V) - w.state->u.leftCols(V)).colwise().squaredNorm().maxCoeff();
  const auto least = static_cast<float>(way);
  return moved > least * least;
}

void TablesBody::keep(bool) {
  Work& w = *work_;
  TouchState& state = *w.state;
  state.regions.assign(w.nonlinear.regions().begin(), w.nonlinear.regions().end());
  state.refinement.weights = w.correcting;
  if (w.is_formed) state.u.swap(w.ahead);
  w.shape = &state.u;
  w.is_formed = false;
}

// --- end of a frame

// What the state says of its own error, by what was added up to its shape.
void TablesBody::end_frame(double penetration) {
  Work& w = *work_;
  w.report = {w.nonlinear.blob_count(), static_cast<double>(w.nonlinear.last_share()), {}, {}};
  const bool has_feet = std::any_of(w.now.places.begin(), w.now.places.end(),
                                    [](const Place& place) { return place.is_foot; });
  if (w.state->forces.empty() && !has_feet) return;
  double all = 0, beyond = 0, between = 0, largest = 0;
  for (Eigen::Index v = 0; v < w.linear.cols(); ++v) {
    const Vector3f u = w.state->u.col(v);
    const auto moved = static_cast<double>(u.squaredNorm());
    all += moved;
    largest = std::max(largest, moved);
    beyond += static_cast<double>((u - w.linear.col(v)).squaredNorm());
    if (w.is_nonlinear()) {
      between += static_cast<double>((u - w.without_cross.col(v)).squaredNorm());
    }
  }
  if (!(all > 0)) return;
  double left = 1;
  for (const float weight : w.correcting) left -= kCorrected * static_cast<double>(weight);
  left = std::max(1 - kCorrected, left);
  w.report.signs = {std::max(0.0, penetration) / std::sqrt(largest), left * std::sqrt(beyond / all),
                    left * std::sqrt(between / all)};
  if (w.error_scale) w.report.stated = w.error_scale->stated(w.report.signs);
}

const TablesReport& TablesBody::report() const { return work_->report; }

double TablesBody::moved() const {
  const Eigen::Index V = work_->rest.cols();
  return static_cast<double>(
      (work_->state->u.leftCols(V) - work_->began.leftCols(V)).colwise().norm().maxCoeff());
}

void TablesBody::hold_back(double share) {
  Work& w = *work_;
  TouchState& state = *w.state;
  const auto s = static_cast<float>(share);
  state.u = w.began + s * (state.u - w.began);
  w.forces_began.hold_back(state.forces, s);
  w.is_surface_old = true;
}

// --- any state

void TablesBody::place(const TouchState& state, Matrix3Xf& skin) {
  work_->skin.face_as(state.u);
  work_->skin.place(state.u, skin);
}

void TablesBody::find_moved(const TouchState& state, std::vector<Vector3f>& moved) {
  work_->skin.face_as(state.u);
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
      cauchy.empty() ? std::span<float>() : std::span<float>(w.carrying_tensors);
  w.shell->evaluate(u, w.carrying_stress, tensors);
  w.skin.spread(w.carrying_stress, 1, von_mises);
  if (!cauchy.empty()) w.skin.spread(tensors, 6, cauchy);
}

bool TablesBody::ask(const TouchState& state, AskedLoad& asked) {
  Work& w = *work_;
  asked.forces.clear();
  if (state.forces.empty() || state.refinement.blended < 1) return false;
  asked.forces.reserve(6 * std::size_t{kMostPlacesWithOthers});
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

void TablesBody::probe(AskedLoad& asked) {
  make_probe(work_->linear_field, static_cast<int>(work_->rest.cols()), work_->compliance.nodes(),
             asked);
}

bool TablesBody::refine(TouchState& state, const AskedLoad& asked, const Matrix3Xf& exact) const {
  PALPABLE_EXPECT(exact.cols() == work_->compliance.nodes() &&
                      asked.tables.cols() == exact.cols() &&
                      asked.linear.cols() == work_->rest.cols(),
                  "an answer has as many nodes as the tables");
  return state.refinement.take_up(asked, exact);
}

}  // namespace palpable
