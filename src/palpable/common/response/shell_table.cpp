#include "palpable/common/response/shell_table.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/quadratic_shape.h"
#include "palpable/common/geometry/quadrature.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

namespace palpable {
namespace {

constexpr double kFarthest = 1e4;  // m: coordinates beyond this are invalid
constexpr float kHeaviest = 1e6f;  // weights of the recovery beyond this are invalid

// dN_a/dL at point q, with L the last three barycentric coordinates.
Eigen::Matrix3Xd slopes(int element_nodes, int q) {
  if (element_nodes == 4) {
    Eigen::Matrix3Xd linear(3, 4);
    linear << -Eigen::Vector3d::Ones(), Eigen::Matrix3d::Identity();
    return linear;
  }
  return quadratic_shape(four_point_rule()[static_cast<std::size_t>(q)].barycentric).slope;
}

// dX/dL at point q.
Eigen::Matrix3d stretch(const ShellTable& table, int element, const Eigen::Matrix3Xd& slope) {
  Eigen::Matrix3d D = Eigen::Matrix3d::Zero();
  const std::span<const int> nodes = table.nodes_of(element);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    D += table.stress_free.col(nodes[a]) * slope.col(static_cast<Eigen::Index>(a)).transpose();
  }
  return D;
}

bool are_indices(const std::vector<int>& list, std::int64_t end) {
  return std::all_of(list.begin(), list.end(), [&](int i) { return i >= 0 && i < end; });
}

// Finite and of a body's size.
bool are_places(const Eigen::Matrix3Xd& places) {
  return (places.array().abs() < kFarthest).all();  // false for NaN, too
}

bool are_laws(const std::vector<Material>& materials) {
  try {
    for (const Material& material : materials) check_material(material);
    return true;
  } catch (const Error&) { return false; }
}

bool has_bad_weights(const ShellTable& t, std::int64_t vertices) {
  if (std::ssize(t.first) != vertices + 1 || t.first.front() != 0 ||
      t.first.back() != std::ssize(t.points) || t.points.size() != t.weights.size() ||
      !std::is_sorted(t.first.begin(), t.first.end())) {
    return true;
  }
  return !are_indices(t.points, std::int64_t{t.points_of_element()} * t.element_count()) ||
         !std::all_of(t.weights.begin(), t.weights.end(),
                      [](float w) { return std::abs(w) < kHeaviest; });
}

bool has_bad_shapes(const ShellTable& t) {
  for (int q = 0; q < t.points_of_element(); ++q) {
    const Eigen::Matrix3Xd slope = slopes(t.element_nodes, q);
    for (int e = 0; e < t.element_count(); ++e) {
      const Eigen::Matrix3d D = stretch(t, e, slope);
      if (!(D.determinant() > 0) || !D.inverse().allFinite()) return true;
    }
  }
  return false;
}

}  // namespace

Eigen::Matrix3Xd gradients_at(const ShellTable& table, int element, int q) {
  const Eigen::Matrix3Xd slope = slopes(table.element_nodes, q);
  return stretch(table, element, slope).inverse().transpose() * slope;
}

std::string_view trouble_of(const ShellTable& t, int vertices) {
  const std::int64_t W = t.nodes(), E = t.element_count(), A = t.element_nodes;
  if (W < vertices || t.preload.cols() != W || (A != 4 && A != 10)) return "its size";
  if (!are_places(t.stress_free) || !are_places(t.preload)) return "its places";
  if (std::ssize(t.elements) != A * E || !are_indices(t.elements, W)) return "its elements";
  if (std::ssize(t.materials) > kMostMaterials || !are_laws(t.materials) ||
      !are_indices(t.material_of, std::ssize(t.materials))) {
    return "its materials";
  }
  if (has_bad_weights(t, vertices)) return "the weights of its recovery";
  return has_bad_shapes(t) ? std::string_view("the shape of an element") : std::string_view();
}

}  // namespace palpable
