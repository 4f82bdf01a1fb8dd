/// @file
/// Energy, forces and tangent of a whole body of 4-node (one point) or 10-node (four points)
/// tetrahedra: one pass over the elements each, nothing allocated.
///
///   N  nodes      E  tetrahedra
///   M  nodes that are free in some direction, in the order of their index
///
/// A node that is held in one or two directions keeps its block row: the tangent's rows and columns
/// of the held directions are zero but for the diagonal, and gather() puts zeros there.
#pragma once

#include "palpable/solid/block_matrix.h"
#include "palpable/solid/element_kernels.h"
#include "palpable/solid/solid_model.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <variant>
#include <vector>

namespace palpable {

/// What an evaluation of the forces says about the whole body.
struct BodyState {
  double energy = 0;  ///< J; infinite when an element is inverted, and the forces are then not made
  double smallest_volume_ratio = 1;  ///< min J over the elements looked at
  int most_compressed = -1;          ///< the element it belongs to
};

/// A state of the body as the passes over its elements want it, and room for what they find. One
/// for each thread that works; its memory is used again.
struct PassFields {
  std::vector<NodeRow>
      rows;  ///< (N) in the assembly's own order; du is 0 between passes where held
  std::vector<NodeSum> sums;  ///< (N) of the last pass
};

/// Gradients, volumes and the places of the blocks, computed once. Const use is free of state.
class TetAssembly {
 public:
  /// @param model  checked (check_model); copied from, not referred to
  explicit TetAssembly(const SolidModel& model, SimdLevel simd = best_simd_level());

  [[nodiscard]] int node_count() const { return static_cast<int>(free_of_node_.size()); }
  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }
  /// (M) nodes that are free in some direction, increasing.
  [[nodiscard]] const std::vector<int>& free_nodes() const { return free_nodes_; }
  /// How far rounding may put the energy off, J: each element's is a difference of numbers of the
  /// size of its stiffness, however little it is strained.
  [[nodiscard]] double energy_noise() const { return energy_noise_; }
  /// The same for the norm of all nodal forces, N: stiffness times the area of an element's faces.
  [[nodiscard]] double force_noise() const { return force_noise_; }
  /// What one pass over the elements reads, fields not counted.
  [[nodiscard]] std::size_t bytes() const;

  /// What the passes below are about. @param u  (3 x N) m
  void set_state(const Eigen::Matrix3Xd& u, PassFields& fields) const;

  /// d/du of the stored energy, (3 x N), all nodes; `force` has its size already.
  BodyState force(PassFields& fields, Eigen::Matrix3Xd& force) const;

  /// d force / du at what is free. @pre no element is inverted
  void tangent(const PassFields& fields, BlockMatrix& K) const;

  /// y = tangent x, at what is free, without the tangent: at the cost of a pass over the elements.
  /// @param x  (3M), 0 in held directions, as y
  /// @pre no element is inverted
  void tangent_product(PassFields& fields, const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// change = d force / du along du, (3 x N), all nodes. @pre no element is inverted
  void force_change(PassFields& fields, const Eigen::Matrix3Xd& du, Eigen::Matrix3Xd& change) const;

  /// (3M) the free nodes' columns, one after the other; 0 in held directions.
  void gather(const Eigen::Matrix3Xd& field, Eigen::VectorXd& free) const;
  /// Adds scale * free to the free nodes' columns; `free` is 0 in held directions, which a solution
  /// of the tangent with such a right-hand side is.
  void add_scattered(const Eigen::VectorXd& free, double scale, Eigen::Matrix3Xd& field) const;

 private:
  // Elements of one kind and one material: what is chosen at run time is chosen once a group.
  template <int A, int Q>
  struct Group {
    Material material;
    std::vector<ElementBlock<A, Q>> blocks;
    std::vector<int> numbers;                    // of the elements, in the mesh
    std::vector<std::array<int, A * A>> places;  // per element: block (a, b) of the pattern at
                                                 // [A a + b]; -1 where a node is held
  };
  template <int A, int Q>
  using Groups = std::vector<Group<A, Q>>;

  template <int A, int Q>
  void build(const SolidModel& model, Groups<A, Q>& groups);
  template <int A, int Q>
  void estimate_noise(const TetMesh& mesh, const Groups<A, Q>& groups);
  template <int A>
  void build_pattern(const TetMesh& mesh);
  void add_changes(PassFields& fields) const;
  void take_sums(const PassFields& fields, Eigen::Matrix3Xd& field) const;

  // Direction `axis` of free node `row`, held, and the places of all blocks in that column.
  struct HeldAxis {
    int row, axis;
    std::vector<int> column_places;
  };

  void hold(BlockMatrix& K) const;

  SimdLevel simd_;
  double energy_noise_ = 0, force_noise_ = 0;
  std::variant<Groups<4, 1>, Groups<10, 4>> groups_;
  std::vector<int> free_of_node_;  // node -> free node, -1 if held
  std::vector<int> free_nodes_;
  std::vector<int> row_of_node_;  // node -> its place in PassFields: in the order of the elements
  std::vector<int> row_of_free_;  // the same for the free nodes
  std::vector<HeldAxis> held_axes_;
  BlockPattern pattern_;
};

}  // namespace palpable
