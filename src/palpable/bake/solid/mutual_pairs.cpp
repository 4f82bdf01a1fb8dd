#include "palpable/bake/solid/mutual_pairs.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace palpable {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// Cosine of 30 degrees: triangles that meet at less than this angle form one smooth skin, and their
// normals are averaged.
constexpr double kSmooth = 0.866;
// Smallest cosine, between the normal of a face and the direction opposite to a contact point's own
// normal, at which the two face each other. The sides of a box are perpendicular to its top: their
// cosine is 0 to rounding.
constexpr double kFacing = 0.1;
// A point lies over a face, not beside it, if its tangential distance from the nearest point there
// is at most kAside times the gap (about twice the tangent of half of kSmooth's angle), plus
// kOverhang mean edges. kOverhang lets equal blocks stand on each other whose rims coincide to
// rounding. For a pair with force it is kKept times as large, so that rounding does not make and
// break the contact.
constexpr double kAside = 0.6, kOverhang = 1e-3, kKept = 4.0;
// Depth up to which a point inside another component is pushed out, ratio to the smallest side of
// that component's box.
constexpr double kDeepest = 1.0 / 3.0;

auto mutual_key(const MutualPair& pair) { return std::tuple(pair.point, pair.component); }
bool mutual_comes_before(const MutualPair& a, const MutualPair& b) {
  return mutual_key(a) < mutual_key(b);
}

Vector3d sum_of(const MutualPair& pair, const Matrix3Xd& positions, int first, int last) {
  Vector3d sum = Vector3d::Zero();
  for (int k = first; k < last; ++k) sum += pair.shape[k] * positions.col(pair.nodes[k]);
  return sum;
}

Vector3d y_of(const MutualPair& pair, const Matrix3Xd& positions) {
  return -sum_of(pair, positions, pair.own_count, pair.count);
}

}  // namespace

// The skins of all components at given positions of the nodes.
class MutualPairs::Moved {
 public:
  Moved(const MutualPairs& all, const Matrix3Xd& at)
      : positions(at), all_(all), distances_(all.bodies_.size()) {
    vertices = positions(Eigen::all, all.boundary_.node_of_vertex);
    const Eigen::Matrix3Xi& triangles = all.boundary_.surface.triangles;
    face_normals_.resize(3, triangles.cols());
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const Vector3d a = vertices.col(triangles(0, t));
      face_normals_.col(t) =
          (vertices.col(triangles(1, t)) - a).cross(vertices.col(triangles(2, t)) - a);
    }
    for (const Body& body : all.bodies_) {
      AlignedBox3d& box = boxes.emplace_back();
      for (const int v : body.vertices) box.extend(vertices.col(v));
    }
  }

  // Distance to the skin of a component. Its triangles are numbered as in Body::triangles.
  const SurfaceDistance& distance(int component) const {
    std::optional<SurfaceDistance>& made = distances_[component];
    if (!made) {
      made.emplace(SurfaceMesh{vertices, all_.boundary_.surface.triangles(
                                             Eigen::all, all_.bodies_[component].triangles)});
    }
    return *made;
  }

  // Outward normal of the skin at a contact point: the mean over the faces that share the point.
  [[nodiscard]] Vector3d normal(int point) const {
    Vector3d sum = Vector3d::Zero();
    for (int i = all_.first_face_[point]; i < all_.first_face_[point + 1]; ++i) {
      sum += face_normal(all_.faces_[i]);
    }
    return sum.normalized();
  }

  [[nodiscard]] Vector3d face_normal(int triangle) const {
    return face_normals_.col(triangle).normalized();
  }

  [[nodiscard]] Vector3d smooth_normal(int triangle, const Vector3d& weights) const {
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      Vector3d at_corner = Vector3d::Zero();
      for (int i = all_.first_smooth_[3 * triangle + k];
           i < all_.first_smooth_[3 * triangle + k + 1]; ++i) {
        at_corner += face_normals_.col(all_.smooth_[i]);
      }
      normal += weights[k] * at_corner.normalized();
    }
    return normal.normalized();
  }

  const Matrix3Xd& positions;
  Matrix3Xd vertices;
  std::vector<AlignedBox3d> boxes;  // by component

 private:
  const MutualPairs& all_;
  Matrix3Xd face_normals_;  // their length is twice the area of the face
  mutable std::vector<std::optional<SurfaceDistance>> distances_;
};

MutualPairs::MutualPairs(const TetAssembly& assembly, const TetMesh& mesh, const Boundary& boundary,
                         const ContactPoints& points, VectorXd penalties, double edge,
                         const Friction& friction)
    : boundary_(boundary),
      points_(points),
      penalties_(std::move(penalties)),
      edge_(edge),
      friction_(friction),
      free_of_node_(assembly.node_count(), -1) {
  if (mesh.is_quadratic()) {
    throw Error(
        "bodies of 10-node tetrahedra cannot press each other yet, only rigid obstacles: mesh them "
        "with 4-node tetrahedra");
  }
  const std::vector<int>& free = assembly.free_nodes();
  for (std::size_t m = 0; m < free.size(); ++m) free_of_node_[free[m]] = static_cast<int>(m);
  assembly.gather(Matrix3Xd::Ones(3, assembly.node_count()), mask_);

  const std::vector<int> component = node_components(mesh);
  bodies_.resize(*std::max_element(component.begin(), component.end()) + 1);
  for (int v = 0; v < boundary.surface.vertex_count(); ++v) {
    bodies_[component[boundary.node_of_vertex[v]]].vertices.push_back(v);
  }
  for (int t = 0; t < boundary.surface.triangle_count(); ++t) {
    const int node = boundary.node_of_vertex[boundary.surface.triangles(0, t)];
    bodies_[component[node]].triangles.push_back(t);
  }
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    bodies_[component[points.points[i].nodes[0]]].points.push_back(static_cast<int>(i));
  }
  for (Body& body : bodies_) {
    AlignedBox3d box;
    for (const int v : body.vertices) box.extend(boundary.surface.vertices.col(v));
    body.deepest = kDeepest * box.sizes().minCoeff();
  }
  find_smooth_neighbours();
  find_faces_of_points();
}

void MutualPairs::find_faces_of_points() {
  std::vector<std::pair<int, int>> all;
  for (int t = 0; t < boundary_.surface.triangle_count(); ++t) {
    for (int i = points_.first[t]; i < points_.first[t + 1]; ++i) {
      all.emplace_back(points_.of_triangle[i], t);
    }
  }
  std::sort(all.begin(), all.end());
  first_face_.assign(points_.points.size() + 1, 0);
  for (const auto& [point, triangle] : all) {
    ++first_face_[point + 1];
    faces_.push_back(triangle);
  }
  for (std::size_t i = 0; i < points_.points.size(); ++i) first_face_[i + 1] += first_face_[i];
}

void MutualPairs::find_smooth_neighbours() {
  const SurfaceMesh& skin = boundary_.surface;
  std::vector<std::vector<int>> at_vertex(skin.vertex_count());
  Matrix3Xd normals(3, skin.triangle_count());
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const Vector3d a = skin.vertices.col(skin.triangles(0, t));
    normals.col(t) = (skin.vertices.col(skin.triangles(1, t)) - a)
                         .cross(skin.vertices.col(skin.triangles(2, t)) - a)
                         .normalized();
    for (int k = 0; k < 3; ++k) at_vertex[skin.triangles(k, t)].push_back(t);
  }
  first_smooth_ = {0};
  for (int t = 0; t < skin.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      for (const int other : at_vertex[skin.triangles(k, t)]) {
        if (other == t || normals.col(t).dot(normals.col(other)) > kSmooth) {
          smooth_.push_back(other);
        }
      }
      first_smooth_.push_back(static_cast<int>(smooth_.size()));
    }
  }
}

const MutualPair* MutualPairs::pair_of(int point, int component) const {
  const MutualPair wanted{.point = point, .component = component};
  const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), wanted, mutual_comes_before);
  return found != pairs_.end() && mutual_key(*found) == mutual_key(wanted) ? &*found : nullptr;
}

// Adds the pair of a contact point and another component to `detected`, if the point is near the
// component's skin.
void MutualPairs::add_pair(const Moved& skin, int component, int point, Detection& detected) const {
  const ContactPoint& own = points_.points[point];
  const Body& body = bodies_[component];
  const Vector3d x = position_of(own, skin.positions);
  AlignedBox3d near = skin.boxes[component];
  near.min().array() -= edge_;
  near.max().array() += edge_;
  if (!near.contains(x)) return;
  const SurfaceDistance& distance = skin.distance(component);
  const NearestOnSurface nearest = distance.nearest(x);
  if (nearest.distance > edge_) return;

  const MutualPair* before = pair_of(point, component);
  const bool pressed = before != nullptr && before->force > 0.0;
  const double overhang = kOverhang * edge_ * (pressed ? kKept : 1.0);
  const Vector3d against = -skin.normal(point);
  NearestOnSurface found = distance.nearest_facing(x, against, kFacing);
  int triangle = body.triangles[found.triangle];
  Vector3d normal = skin.smooth_normal(triangle, found.weights);
  double gap = normal.dot(x - found.point);
  const double aside = (x - found.point - gap * normal).norm();
  bool is_over = skin.face_normal(triangle).dot(against) >= kFacing && gap <= edge_ &&
                 gap >= -body.deepest && aside <= kAside * std::abs(gap) + overhang;
  // The point is behind the face but outside the component: beyond its far side, or beside its rim.
  if (gap < 0.0 && nearest.distance > overhang) is_over = false;
  if (!is_over) {
    if (nearest.distance >= 0.0) return;
    if (nearest.distance < -body.deepest) {
      ++detected.buried;
      return;
    }
    found = nearest;
    triangle = body.triangles[found.triangle];
    normal = skin.smooth_normal(triangle, found.weights);
    gap = normal.dot(x - found.point);
  }

  MutualPair pair{
      .point = point, .component = component, .faces = is_over, .normal = normal, .gap = gap};
  double series = 0.0;
  for (int k = 0; k < own.count; ++k) {
    pair.nodes[pair.count] = own.nodes[k];
    pair.shape[pair.count++] = own.shape[k];
    series += own.shape[k] * penalties_[own.nodes[k]];
  }
  pair.own_count = pair.count;
  double other = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (found.weights[k] == 0.0) continue;
    const int node = boundary_.node_of_vertex[boundary_.surface.triangles(k, triangle)];
    pair.nodes[pair.count] = node;
    pair.shape[pair.count++] = -found.weights[k];
    other += found.weights[k] * penalties_[node];
  }
  pair.penalty = series * other / (series + other);
  pair.triangle = triangle;
  if (before != nullptr) {
    pair.multiplier = before->multiplier;
    pair.force = before->force;
    pair.friction = before->friction;
    pair.friction.normal = normal;
    pair.anchor_nodes = before->anchor_nodes;
    pair.anchor_shape = before->anchor_shape;
  }
  detected.pairs.push_back(pair);
}

MutualPairs::Detection MutualPairs::detect(const Matrix3Xd& positions) const {
  Detection detected;
  const Moved skin(*this, positions);
  for (int owner = 0; owner < component_count(); ++owner) {
    for (int component = 0; component < component_count(); ++component) {
      if (component == owner) continue;
      AlignedBox3d near = skin.boxes[component];
      near.min().array() -= edge_;
      near.max().array() += edge_;
      if (!near.intersects(skin.boxes[owner])) continue;
      for (const int point : bodies_[owner].points) {
        const std::size_t pairs = detected.pairs.size();
        add_pair(skin, component, point, detected);
        if (detected.pairs.size() > pairs) detected.pairs.back().owner = owner;
      }
    }
  }
  // While the facing sides of two blocks penetrate each other, points on their other sides lie
  // inside, too. They come out together with the facing sides. Forces on them alone would squash
  // the elements there, so they form no pairs meanwhile.
  double deepest = 0.0;
  for (const MutualPair& pair : detected.pairs) {
    if (pair.faces) deepest = std::min(deepest, pair.gap);
  }
  if (deepest < -kOverhang * edge_) {
    std::erase_if(detected.pairs,
                  [](const MutualPair& pair) { return !pair.faces && pair.multiplier == 0.0; });
  }
  for (const MutualPair& pair : detected.pairs) {
    detected.smallest_gap = std::min(detected.smallest_gap, pair.gap);
  }
  std::sort(detected.pairs.begin(), detected.pairs.end(), mutual_comes_before);

  double squares = 0.0, shifts = 0.0;
  for (const MutualPair& before : pairs_) {
    if (before.force == 0.0) continue;
    const double square = before.force * before.force;
    squares += square;
    const auto now =
        std::lower_bound(detected.pairs.begin(), detected.pairs.end(), before, mutual_comes_before);
    if (now == detected.pairs.end() || mutual_key(*now) != mutual_key(before)) {
      shifts += square;
      continue;
    }
    const Vector3d moved = y_of(*now, positions) - y_of(before, positions);
    shifts += square *
              ((now->normal - before.normal).squaredNorm() + moved.squaredNorm() / (edge_ * edge_));
  }
  if (squares > 0.0) detected.shift = std::sqrt(shifts / squares);
  return detected;
}

MutualPairs::Stencil MutualPairs::stencil_of(const MutualPair& pair) {
  return {pair.nodes, pair.shape, pair.count, pair.own_count};
}

MutualPairs::Stencil MutualPairs::stencil_of_friction(const MutualPair& pair) {
  Stencil stencil{pair.nodes, pair.shape, pair.own_count, pair.own_count};
  for (int k = 0; k < 3; ++k) {
    stencil.nodes[stencil.count] = pair.anchor_nodes[k];
    stencil.shape[stencil.count++] = -pair.anchor_shape[k];
  }
  return stencil;
}

void MutualPairs::begin_step(const Matrix3Xd& positions_before) {
  positions_before_ = predicted_ = positions_before;
  for (MutualPair& pair : pairs_) {
    if (pair.multiplier == 0.0) pair.friction = {};
  }
}

// Anchors a pair where the line through `at` along its normal meets the plane of y's triangle.
void MutualPairs::set_anchor(const Matrix3Xd& positions, const Vector3d& at,
                             MutualPair& pair) const {
  for (int k = 0; k < 3; ++k) {
    pair.anchor_nodes[k] = boundary_.node_of_vertex[boundary_.surface.triangles(k, pair.triangle)];
  }
  const Vector3d origin = positions.col(pair.anchor_nodes[0]);
  Matrix3d directions;  // two edges, and the normal
  directions << positions.col(pair.anchor_nodes[1]) - origin,
      positions.col(pair.anchor_nodes[2]) - origin, pair.normal;
  const Vector3d v = directions.partialPivLu().solve(at - origin);
  pair.anchor_shape = {1.0 - v[0] - v[1], v[0], v[1]};
}

// The place of the other skin, as it is at `positions`, that a point touched first. Both skins
// moved there in straight lines since the step began.
Vector3d MutualPairs::place_of_contact(const Matrix3Xd& positions, const MutualPair& pair) const {
  const Vector3d from = sum_of(pair, positions_before_, 0, pair.count);
  const double time = time_of_contact(pair.normal.dot(from),
                                      pair.normal.dot(sum_of(pair, predicted_, 0, pair.count)));
  const Vector3d slid = sum_of(pair, positions, 0, pair.count) - from;
  return sum_of(pair, positions, 0, pair.own_count) - (1.0 - time) * slid;
}

double MutualPairs::update_friction(const Matrix3Xd& positions) {
  double largest = 0.0;
  for (MutualPair& pair : pairs_) {
    largest = std::max(largest, update_cone(friction_, pair.penalty, pair.multiplier, pair.force,
                                            pair.normal, pair.friction));
    if (pair.friction.anchored || pair.force == 0.0) continue;
    pair.friction.anchored = true;
    set_anchor(positions, place_of_contact(positions, pair), pair);
  }
  return largest;
}

double MutualPairs::end_step(const Matrix3Xd& positions) {
  double sum = 0.0;
  for (MutualPair& pair : pairs_) {
    sum += dissipated(pair.friction);
    if (pair.multiplier == 0.0) {
      pair.friction.anchored = false;
    } else if (pair.friction.slips) {
      const Vector3d x = sum_of(pair, positions, 0, pair.own_count);
      set_anchor(positions, x - elastic_slip(pair.friction), pair);
    }
  }
  return sum;
}

double MutualPairs::evaluate(const Matrix3Xd& positions, bool glued) {
  double energy = 0.0;
  for (MutualPair& pair : pairs_) {
    pair.gap = pair.normal.dot(sum_of(pair, positions, 0, pair.count));
    pair.force = pair.multiplier - pair.penalty * pair.gap;
    if (!(glued && pair.multiplier > 0.0)) pair.force = std::max(0.0, pair.force);
    energy += 0.5 / pair.penalty * (pair.force + pair.multiplier) * (pair.force - pair.multiplier);
    if (!pair.friction.anchored) continue;
    Vector3d apart = Vector3d::Zero();
    const Stencil stencil = stencil_of_friction(pair);
    for (int k = 0; k < stencil.count; ++k) {
      apart += stencil.shape[k] * positions.col(stencil.nodes[k]);
    }
    energy +=
        evaluate_friction(friction_, pair.penalty, pair.multiplier, apart, glued, pair.friction);
  }
  return energy;
}

void MutualPairs::add_forces(Matrix3Xd& force) const {
  for (const MutualPair& pair : pairs_) {
    if (pair.force == 0.0) continue;
    for (int k = 0; k < pair.count; ++k) {
      force.col(pair.nodes[k]) += pair.shape[k] * pair.force * pair.normal;
    }
  }
  for (const MutualPair& pair : pairs_) {
    if (pair.friction.limit == 0.0) continue;
    const Stencil stencil = stencil_of_friction(pair);
    for (int k = 0; k < stencil.count; ++k) {
      force.col(stencil.nodes[k]) += stencil.shape[k] * pair.friction.force;
    }
  }
}

void MutualPairs::add_product(const VectorXd& x, VectorXd& y) const {
  for (const MutualPair& pair : pairs_) {
    if (pair.force == 0.0) continue;
    double closer = 0.0;
    for (int k = 0; k < pair.count; ++k) {
      const int free = free_of_node_[pair.nodes[k]];
      if (free >= 0) closer += pair.shape[k] * pair.normal.dot(x.segment<3>(3 * free));
    }
    const Vector3d pull = pair.penalty * closer * pair.normal;
    for (int k = 0; k < pair.count; ++k) {
      const int free = free_of_node_[pair.nodes[k]];
      if (free < 0) continue;
      y.segment<3>(3 * free) += pair.shape[k] * pull.cwiseProduct(mask_.segment<3>(3 * free));
    }
  }
  for (const MutualPair& pair : pairs_) {
    if (pair.friction.limit != 0.0) add_friction_product(pair, x, y);
  }
}

void MutualPairs::add_friction_product(const MutualPair& pair, const VectorXd& x,
                                       VectorXd& y) const {
  const Stencil stencil = stencil_of_friction(pair);
  Vector3d moves = Vector3d::Zero();
  for (int k = 0; k < stencil.count; ++k) {
    const int free = free_of_node_[stencil.nodes[k]];
    if (free >= 0) moves += stencil.shape[k] * x.segment<3>(3 * free);
  }
  const Vector3d pull = friction_stiffness(pair.friction) * moves;
  for (int k = 0; k < stencil.count; ++k) {
    const int free = free_of_node_[stencil.nodes[k]];
    if (free < 0) continue;
    y.segment<3>(3 * free) += stencil.shape[k] * pull.cwiseProduct(mask_.segment<3>(3 * free));
  }
}

// Calls add(block, i, j, row, column) for all pairs of free nodes of a stencil. If the pattern
// lacks a block between the two components, the blocks between them are left out.
template <class Add>
void MutualPairs::visit_blocks(const BlockPattern& pattern, const Stencil& stencil,
                               const Add& add) const {
  std::array<int, 36> places{};
  bool all_there = true;
  for (int i = 0; i < stencil.count; ++i) {
    for (int j = 0; j < stencil.count; ++j) {
      const int row = free_of_node_[stencil.nodes[i]], column = free_of_node_[stencil.nodes[j]];
      const bool is_free = row >= 0 && column >= 0;
      places[6 * i + j] = is_free ? pattern.find(row, column) : -1;
      if (is_free && places[6 * i + j] < 0) all_there = false;
    }
  }
  for (int i = 0; i < stencil.count; ++i) {
    for (int j = 0; j < stencil.count; ++j) {
      const int at = places[6 * i + j];
      const bool across = (i < stencil.own_count) != (j < stencil.own_count);
      if (at < 0 || (across && !all_there)) continue;
      add(at, i, j, free_of_node_[stencil.nodes[i]], free_of_node_[stencil.nodes[j]]);
    }
  }
}

void MutualPairs::add_tangent(BlockMatrix& K) const {
  for (const MutualPair& pair : pairs_) {
    if (pair.force != 0.0) {
      visit_blocks(K.pattern(), stencil_of(pair), [&](int at, int i, int j, int row, int column) {
        const Vector3d left = pair.normal.cwiseProduct(mask_.segment<3>(3 * row));
        const Vector3d right = pair.normal.cwiseProduct(mask_.segment<3>(3 * column));
        K.block(at) += pair.penalty * pair.shape[i] * pair.shape[j] * left * right.transpose();
      });
    }
    if (pair.friction.limit == 0.0) continue;
    const Stencil stencil = stencil_of_friction(pair);
    const Matrix3d stiff = friction_stiffness(pair.friction);
    visit_blocks(K.pattern(), stencil, [&](int at, int i, int j, int row, int column) {
      K.block(at) += stencil.shape[i] * stencil.shape[j] * mask_.segment<3>(3 * row).asDiagonal() *
                     stiff * mask_.segment<3>(3 * column).asDiagonal();
    });
  }
}

template <class Visit>
void MutualPairs::visit_blocks_between(const MutualPair& pair, const Visit& visit) const {
  const auto visit_stencil = [&](const Stencil& stencil) {
    for (int i = 0; i < stencil.own_count; ++i) {
      const int row = free_of_node_[stencil.nodes[i]];
      for (int j = stencil.own_count; j < stencil.count && row >= 0; ++j) {
        const int column = free_of_node_[stencil.nodes[j]];
        if (column >= 0) visit(row, column);
      }
    }
  };
  if (pair.force != 0.0) visit_stencil(stencil_of(pair));
  if (pair.friction.limit != 0.0) visit_stencil(stencil_of_friction(pair));
}

bool MutualPairs::fits(const BlockPattern& pattern) const {
  bool all_there = true;
  for (const MutualPair& pair : pairs_) {
    visit_blocks_between(pair, [&](int row, int column) {
      all_there = all_there && pattern.find(row, column) >= 0;
    });
  }
  return all_there;
}

BlockPattern MutualPairs::widened(const BlockPattern& pattern) const {
  std::vector<std::pair<int, int>> blocks;
  for (const MutualPair& pair : pairs_) {
    visit_blocks_between(pair, [&](int row, int column) {
      blocks.emplace_back(row, column);
      blocks.emplace_back(column, row);
    });
  }
  for (int row = 0; row < pattern.rows(); ++row) {
    for (int p = pattern.row_start[row]; p < pattern.row_start[row + 1]; ++p) {
      blocks.emplace_back(row, pattern.column[p]);
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  BlockPattern wide;
  wide.row_start.assign(pattern.rows() + 1, 0);
  for (const auto& [row, column] : blocks) {
    ++wide.row_start[row + 1];
    wide.column.push_back(column);
  }
  for (int row = 0; row < pattern.rows(); ++row) wide.row_start[row + 1] += wide.row_start[row];
  return wide;
}

double MutualPairs::update_multipliers() {
  double largest = 0.0;
  for (MutualPair& pair : pairs_) {
    largest = std::max(largest, std::abs(pair.force - pair.multiplier) / pair.penalty);
    pair.multiplier = pair.force;
  }
  return largest;
}

Matrix3Xd MutualPairs::force_on_components() const {
  Matrix3Xd force = Matrix3Xd::Zero(3, component_count());
  for (const MutualPair& pair : pairs_) {
    force.col(pair.owner) += pair.force * pair.normal;
    force.col(pair.component) -= pair.force * pair.normal;
    if (pair.friction.limit == 0.0) continue;
    force.col(pair.owner) += pair.friction.force;
    force.col(pair.component) -= pair.friction.force;
  }
  return force;
}

}  // namespace palpable
