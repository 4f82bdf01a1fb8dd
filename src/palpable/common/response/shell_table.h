/// @file
/// The part of a body from which the stress on its skin is computed: the *shell*, the elements
/// whose stress the recovery at the skin's vertices reads (solid/stress_recovery.h). Of 4-node
/// elements these are the elements around the nearest inner nodes, some two layers; of 10-node
/// elements those that touch the skin.
///
///   V  vertices of the skin     W  nodes of the shell: the V vertices, then the *inner nodes*
///   E  elements                 A  nodes of each, 4 or 10     Q  points of each, 1 or 4
#pragma once

#include "palpable/common/material/material.h"

#include <Eigen/Core>

#include <span>
#include <string_view>
#include <vector>

namespace palpable {

/// Largest number of materials in a shell.
inline constexpr int kMostMaterials = 1000;

/// The shell as a body file stores it.
struct ShellTable {
  /// (3 x W) m: the positions without stress, and the displacement from there to the state without
  /// contact, by weight and the like; 0 without any.
  Eigen::Matrix3Xd stress_free, preload;
  int element_nodes = 4;      ///< A
  std::vector<int> elements;  ///< (E A) element by element; corners, then edges as in kTetEdges
  std::vector<Material> materials;
  std::vector<int> material_of;  ///< (E)
  /// (V + 1) The stress at vertex v is the sum of weights[k] times the stress at point points[k], k
  /// from first[v] to first[v + 1] - 1. Point q of element e has the number Q e + q; the points of
  /// a 10-node element are those of four_point_rule().
  std::vector<int> first;
  std::vector<int> points;
  std::vector<float> weights;

  [[nodiscard]] int nodes() const { return static_cast<int>(stress_free.cols()); }  ///< W
  [[nodiscard]] int element_count() const { return static_cast<int>(material_of.size()); }
  [[nodiscard]] int points_of_element() const { return element_nodes == 4 ? 1 : 4; }  ///< Q
  [[nodiscard]] std::span<const int> nodes_of(int element) const {
    const auto A = static_cast<std::size_t>(element_nodes);
    return {elements.data() + A * static_cast<std::size_t>(element), A};
  }
};

/// (3 x A) dN_a/dX at point q of an element, 1/m. @pre the table's indices are in range
[[nodiscard]] Eigen::Matrix3Xd gradients_at(const ShellTable& table, int element, int q);

/// The part of a table that is invalid for a skin with this number of vertices; empty if none is.
[[nodiscard]] std::string_view trouble_of(const ShellTable& table, int vertices);

}  // namespace palpable
