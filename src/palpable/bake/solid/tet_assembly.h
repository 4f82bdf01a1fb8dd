/// @file
/// Energy, forces and tangent of a body of 4-node (one point) or 10-node (four points) tetrahedra.
/// Each is one pass over the elements and allocates nothing.
///
///   N  nodes      E  tetrahedra
///   M  nodes that are free in some direction, in the order of their index
///
/// A node that is held in one or two directions keeps its block row. There the tangent's rows and
/// columns of the held directions are zero but for the diagonal, and gather() writes zeros.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/element_kernels.h"
#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <variant>
#include <vector>

namespace palpable {

/// Sums and extremes of one evaluation of the forces.
struct BodyState {
  double energy = 0;  ///< J; infinite if an element is inverted; the forces are then not computed
  double smallest_volume_ratio = 1;  ///< min J over the integration points
  int most_compressed = -1;          ///< the element it belongs to
};

/// A state of the body in the layout of the passes (NodeRow), and room for their results. Each
/// thread needs its own; its memory is used again.
struct PassFields {
  /// (N) in the order of the assembly, not of the mesh; du is 0 between passes where held.
  std::vector<NodeRow> rows;
  std::vector<NodeSum> sums;  ///< (N) result of the last pass, in the same order
};

/// The fields of a power series in the layout of the passes, and room for their results.
struct SeriesFields {
  std::vector<SeriesRow> rows;  ///< (N) in the order of the assembly
  std::vector<NodeSum> sums;    ///< (N)
};

/// Gradients, volumes and the numbers of the blocks, computed once. Const members change nothing in
/// the object, so that several threads may call them, each with its own PassFields.
class TetAssembly {
 public:
  /// @param model  has passed check_model(); it need not outlive this object
  explicit TetAssembly(const SolidModel& model, SimdLevel simd = best_simd_level());

  [[nodiscard]] int node_count() const { return static_cast<int>(free_of_node_.size()); }
  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }
  /// (M) nodes that are free in some direction, increasing.
  [[nodiscard]] const std::vector<int>& free_nodes() const { return free_nodes_; }
  /// How large the rounding error of the energy may be, J. An element's energy is a difference of
  /// numbers of the size of its stiffness, however little it is strained.
  [[nodiscard]] double energy_noise() const { return energy_noise_; }
  /// The same for the norm of all nodal forces, N: stiffness times the area of an element's faces.
  [[nodiscard]] double force_noise() const { return force_noise_; }
  /// Bytes that one pass over the elements reads, without the fields.
  [[nodiscard]] std::size_t bytes() const;

  /// Writes the state that the passes below use into `fields`. @param u  (3 x N) m
  void set_state(const Eigen::Matrix3Xd& u, PassFields& fields) const;

  /// d/du of the stored energy, (3 x N) N, at all nodes; `force` has its size already.
  BodyState force(PassFields& fields, Eigen::Matrix3Xd& force) const;

  /// d force / du in the free directions, N/m. @pre no element is inverted
  void tangent(const PassFields& fields, BlockMatrix& K) const;

  /// y = tangent x in the free directions, by one pass over the elements and without assembling the
  /// tangent.
  /// @param x  (3M), 0 in held directions, as y
  /// @pre no element is inverted
  void tangent_product(PassFields& fields, const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// change = d force / du along du, (3 x N), all nodes. @pre no element is inverted
  void force_change(PassFields& fields, const Eigen::Matrix3Xd& du, Eigen::Matrix3Xd& change) const;

  /// The coefficient of a^order of the internal forces along u_0 + a u_1 + a^2 u_2, (3 x N) N, all
  /// nodes; order 2 or 3, u_2 counts in order 3 only (series_kernels.h).
  /// @param scratch  overwritten; its memory is used again
  /// @pre no element is inverted under u_0
  void force_term(int order, const Eigen::Matrix3Xd& u_0, const Eigen::Matrix3Xd& u_1,
                  const Eigen::Matrix3Xd& u_2, SeriesFields& scratch, Eigen::Matrix3Xd& term) const;

  /// (3M) the free nodes' columns, one after the other; 0 in held directions.
  void gather(const Eigen::Matrix3Xd& field, Eigen::VectorXd& free) const;
  /// Adds scale * free to the free nodes' columns. `free` must be 0 in held directions; a solution
  /// of the tangent is, if its right-hand side is.
  void add_scattered(const Eigen::VectorXd& free, double scale, Eigen::Matrix3Xd& field) const;

 private:
  // Elements of one kind and one material, so that both are looked up once for all of them.
  template <int A, int Q>
  struct Group {
    Material material;
    std::vector<ElementBlock<A, Q>> blocks;
    std::vector<int> numbers;                    // of the elements, in the mesh
    std::vector<std::array<int, A * A>> places;  // per element: number of block (a, b) in the
                                                 // pattern at [A a + b]; -1 if a node is held
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
  void copy_sums(const std::vector<NodeSum>& sums, Eigen::Matrix3Xd& field) const;

  // A held direction `axis` of the free node `row`, and the numbers of all blocks in its column.
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
  std::vector<int> row_of_node_;  // node -> its row in PassFields, by the order of the elements
  std::vector<int> row_of_free_;  // the same for the free nodes
  std::vector<HeldAxis> held_axes_;
  BlockPattern pattern_;
};

}  // namespace palpable
