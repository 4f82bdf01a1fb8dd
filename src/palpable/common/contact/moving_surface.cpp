#include "palpable/common/contact/moving_surface.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/nth_element.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr int kLeaf = 4;           // triangles in a leaf of the tree, at most
constexpr float kSmooth = 0.766f;  // cosine of 40 degrees; sharper edges stay sharp
constexpr float kOnEdge = 1e-5f;   // corner weights below this count as 0: on an edge or corner

// Weights of the corners at the point of a triangle that is nearest to x (Ericson, Real-Time
// Collision Detection, 5.1.5).
Vector3f nearest_weights_in(const Vector3f& a, const Vector3f& b, const Vector3f& c,
                            const Vector3f& x) {
  const Vector3f ab = b - a, ac = c - a, ax = x - a;
  const float d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vector3f bx = x - b;
  const float d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const float t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const Vector3f cx = x - c;
  const float d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const float t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const float t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const float sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};  // a degenerate triangle
  return Vector3f(va, vb, vc) / sum;
}

}  // namespace

MovingSurface::MovingSurface(const SurfaceMesh& skin)
    : triangles_(skin.triangles), vertices_(Eigen::Matrix4Xf::Zero(4, skin.vertices.cols())) {
  vertices_.topRows<3>() = skin.vertices.cast<float>();
  PALPABLE_EXPECT(skin.triangle_count() > 0, "a skin has triangles");
  order_.resize(static_cast<std::size_t>(triangles_.cols()));
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vector3f> centres;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    centres.emplace_back(
        (vertex(triangles_(0, t)) + vertex(triangles_(1, t)) + vertex(triangles_(2, t))) / 3);
  }
  build(0, static_cast<int>(order_.size()), centres);
  find_corners();
  find_adjacent();
  move(skin.vertices.cast<float>());
}

int MovingSurface::build(int first, int count, const std::vector<Vector3f>& centres) {
  const int box = static_cast<int>(boxes_.size());
  boxes_.emplace_back();
  if (count <= kLeaf) {
    boxes_.back().first = first;
    boxes_.back().count = count;
    return box;
  }
  Eigen::AlignedBox3f around;
  for (int k = first; k < first + count; ++k) around.extend(centres[order_[k]]);
  int axis = 0;
  around.sizes().maxCoeff(&axis);
  const int half = count / 2;
  select_nth(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
             [&](int a, int b) {
               return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
             });
  build(first, half, centres);
  const int second = build(first + half, count - half, centres);
  boxes_[box].second = second;
  return box;
}

void MovingSurface::find_corners() {
  for (Box& box : boxes_) {
    if (box.count == 0) continue;
    box.second = static_cast<int>(corners_.size());
    for (int k = box.first; k < box.first + box.count; ++k) {
      for (const int v : triangles_.col(order_[k])) corners_.push_back(v);
    }
    const auto from = corners_.begin() + box.second;
    std::sort(from, corners_.end());
    corners_.erase(std::unique(from, corners_.end()), corners_.end());
  }
}

void MovingSurface::find_adjacent() {
  std::map<std::pair<int, int>, int> of_edge;  // directed edge: the triangle that has it
  for (int t = 0; t < triangles_.cols(); ++t) {
    for (int k = 0; k < 3; ++k) of_edge[{triangles_(k, t), triangles_((k + 1) % 3, t)}] = t;
  }
  across_.resize(order_.size());
  std::vector<int> count(static_cast<std::size_t>(vertices_.cols()) + 1, 0);
  for (int t = 0; t < triangles_.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto other = of_edge.find({triangles_((k + 1) % 3, t), triangles_(k, t)});
      across_[t][static_cast<std::size_t>(k)] = other == of_edge.end() ? t : other->second;
      ++count[triangles_(k, t) + 1];
    }
  }
  std::partial_sum(count.begin(), count.end(), count.begin());
  first_ = count;
  around_.resize(3 * order_.size());
  for (int t = 0; t < triangles_.cols(); ++t) {
    for (int k = 0; k < 3; ++k) around_[count[triangles_(k, t)]++] = t;
  }
}

void MovingSurface::move(const Eigen::Matrix3Xf& vertices) {
  PALPABLE_EXPECT(vertices.cols() == vertices_.cols(), "as many vertices as at rest");
  vertices_.topRows<3>() = vertices;
  auto last = std::ssize(corners_);
  for (auto box = boxes_.rbegin(); box != boxes_.rend(); ++box) {  // halves come after the whole
    if (box->count == 0) {
      const Box &one = (&*box)[1], &other = boxes_[box->second];
      box->low = one.low.min(other.low);
      box->high = one.high.max(other.high);
      continue;
    }
    Eigen::Array4f low = vertices_.col(corners_[box->second]).array(), high = low;
    for (std::ptrdiff_t k = box->second + 1; k < last; ++k) {
      const Eigen::Array4f at = vertices_.col(corners_[k]).array();
      low = low.min(at);
      high = high.max(at);
    }
    box->low = low;
    box->high = high;
    last = box->second;
  }
}

void MovingSurface::look_into(int box, const Eigen::Array4f& x, Best& best) const {
  const Box& here = boxes_[box];
  if (here.count > 0) {
    for (int k = here.first; k < here.first + here.count; ++k) {
      const int t = order_[k];
      const Vector3f a = vertex(triangles_(0, t)), b = vertex(triangles_(1, t)),
                     c = vertex(triangles_(2, t)), here_x = x.head<3>();
      const Vector3f w = nearest_weights_in(a, b, c, here_x);
      const float square = (here_x - (w[0] * a + w[1] * b + w[2] * c)).squaredNorm();
      if (square < best.square) best = {square, t, w};
    }
    return;
  }
  const int one = box + 1, other = here.second;
  const float to_one = boxes_[one].square_to(x), to_other = boxes_[other].square_to(x);
  const bool one_first = to_one <= to_other;
  if (std::min(to_one, to_other) < best.square) look_into(one_first ? one : other, x, best);
  if (std::max(to_one, to_other) < best.square) look_into(one_first ? other : one, x, best);
}

std::optional<NearestOnSkin> MovingSurface::nearest(const Vector3f& x, float reach) const {
  Best best{reach * reach, -1, Vector3f::Zero()};
  const Eigen::Array4f at(x[0], x[1], x[2], 0);
  if (!(boxes_.front().square_to(at) < best.square)) return std::nullopt;
  look_into(0, at, best);
  if (best.triangle < 0) return std::nullopt;
  NearestOnSkin found;
  found.triangle = best.triangle;
  found.weights = best.weights;
  found.normal = normal_at(best.triangle, best.weights);
  Vector3f y = Vector3f::Zero();
  for (int k = 0; k < 3; ++k) y += best.weights[k] * vertex(triangles_(k, best.triangle));
  const float distance = std::sqrt(best.square);
  found.distance = (x - y).dot(found.normal) < 0 ? -distance : distance;
  // Off the skin the direction to the nearest position is the exact gradient.
  if (distance > 1e-6f) found.normal = (x - y) / found.distance;
  return found;
}

bool MovingSurface::may_be_within(const Vector3f& x, float reach) const {
  const float square = reach * reach;
  const Eigen::Array4f place(x[0], x[1], x[2], 0);
  std::array<int, 64> stack{};
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const int at = stack[--top];
    const Box& box = boxes_[at];
    if (!(box.square_to(place) < square)) continue;
    if (box.count > 0) return true;
    if (top + 2 > stack.size()) return true;
    stack[top++] = at + 1;
    stack[top++] = box.second;
  }
  return false;
}

Vector3f MovingSurface::face_normal(int triangle) const {
  const Vector3f a = vertex(triangles_(0, triangle)), b = vertex(triangles_(1, triangle)),
                 c = vertex(triangles_(2, triangle));
  return (b - a).cross(c - a).normalized();
}

Vector3f MovingSurface::normal_at(int triangle, const Vector3f& weights) const {
  int zeros = 0, gone = -1, left = -1;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] < kOnEdge) {
      ++zeros;
      gone = k;
    } else {
      left = k;
    }
  }
  if (zeros == 0) return face_normal(triangle);
  if (zeros == 1) {  // the edge opposite of `gone`, from the corner behind it
    const int other = across_[triangle][static_cast<std::size_t>((gone + 1) % 3)];
    return (face_normal(triangle) + face_normal(other)).normalized();
  }
  return vertex_normal(triangles_(left, triangle));
}

std::vector<int> MovingSurface::sharp_vertices() const {
  std::set<int> sharp;
  for (int t = 0; t < triangles_.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int other = across_[t][static_cast<std::size_t>(k)];
      if (other != t && face_normal(t).dot(face_normal(other)) > kSmooth) continue;
      sharp.insert({triangles_(k, t), triangles_((k + 1) % 3, t)});
    }
  }
  return {sharp.begin(), sharp.end()};
}

Vector3f MovingSurface::vertex_normal(int v) const {
  return normal_around(v, Vector3f::UnitZ(), -2);
}

// Mean normal of the faces around a vertex, weighted by their angles; only of faces whose normal
// has at least this cosine with `way`.
Vector3f MovingSurface::normal_around(int v, const Vector3f& way, float least_cosine) const {
  const Vector3f here = vertex(v);
  Vector3f sum = Vector3f::Zero();
  for (int k = first_[v]; k < first_[v + 1]; ++k) {
    const int t = around_[k];
    const Vector3f normal = face_normal(t);
    if (!(normal.dot(way) >= least_cosine)) continue;
    int at = 0;
    while (triangles_(at, t) != v) ++at;
    const Vector3f to_next = (vertex(triangles_((at + 1) % 3, t)) - here).normalized(),
                   to_last = (vertex(triangles_((at + 2) % 3, t)) - here).normalized();
    sum += std::acos(std::clamp(to_next.dot(to_last), -1.0f, 1.0f)) * normal;
  }
  return sum.normalized();
}

RoundedSkin MovingSurface::rounded_at(const NearestOnSkin& found) const {
  const int t = found.triangle;
  const Vector3f a = vertex(triangles_(0, t)), b = vertex(triangles_(1, t)),
                 c = vertex(triangles_(2, t));
  const Vector3f twice_area = (b - a).cross(c - a);
  const float square = twice_area.squaredNorm();
  Eigen::Matrix3f corners;
  const Vector3f face = face_normal(t);
  for (int k = 0; k < 3; ++k) corners.col(k) = normal_around(triangles_(k, t), face, kSmooth);
  RoundedSkin skin;
  skin.normal = (corners * found.weights).normalized();
  // In front of a sharp edge or corner, or in a degenerate triangle.
  if (!(skin.normal.dot(found.normal) > kSmooth) || !(square > 0)) {
    return {found.normal, Eigen::Matrix3f::Zero()};
  }
  Eigen::Matrix3f of_weights;  // their gradients, as columns
  of_weights << twice_area.cross(c - b) / square, twice_area.cross(a - c) / square,
      twice_area.cross(b - a) / square;
  const Eigen::Matrix3f turns = corners * of_weights.transpose();
  const Eigen::Matrix3f across =
      Eigen::Matrix3f::Identity() - skin.normal * skin.normal.transpose();
  skin.curvature = across * (0.5f * (turns + turns.transpose())) * across;
  return skin;
}

}  // namespace palpable
