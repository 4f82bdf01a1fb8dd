/// @file
/// The compliance of a body's skin: the displacement of every node under a small force at any
/// vertex of the skin. It is Green's function G of the linear body, m/N. The skin is divided into
/// clusters of vertices. Between near clusters G is stored in full, because the field under a
/// fingertip is too sharp for modes. Between clusters c and d that are far from each other G is
/// smooth and is stored as
///
///     G(d, c)  =  P_d  S_dc  P_c^T,      S_dc = S_cd^T
///
/// (an H^2 matrix of one level: Hackbusch, Hierarchical Matrices, 2015, ch. 8). P_c has some dozens
/// of columns: the forces on a cluster act through k numbers, the cluster's *source*, and the
/// displacement that arrives at a cluster is described by k numbers, its *target*.
///
/// The stress on the skin also depends on the inner nodes of the shell (shell_table.h). No force
/// acts on them, but they are displaced. Each belongs to the cluster of a vertex near it. Under
/// loads in near clusters they are neighbours like the vertices; under loads far away
///
///     u_inner(d)  =  R_d P_d^T u_skin(d)
///
/// with R_d the least-squares fit, over far loads, of the displacements of d's inner nodes to those
/// of its vertices. R is stored as rows of the basis behind those of the skin.
///
/// Displacements of higher order in the loads (region.h) also arrive at clusters as targets, but in
/// a second basis, `beyond`: where a part of the body turns by a small angle, the square of that
/// angle is a strain of its displacement, which no far load causes in the first order.
///
///   V  vertices of the skin     W  nodes: the vertices, then the inner ones
///   C  clusters                 k  columns of P, a multiple of 16
///   n_v  neighbours of vertex v: all nodes of clusters near its own, padded to 16
///
/// All numbers have 16 bits, with one factor per row or per vertex: the rounding error is 2e-5 of
/// the largest number in the row.
#pragma once

#include "palpable/common/response/rounded_rows.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace palpable {

/// A force at a vertex of the skin.
struct VertexForce {
  int vertex = 0;
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N
};

/// The compliance as a body file stores it.
struct ComplianceTable {
  int vertices = 0;             ///< V
  int clusters = 0;             ///< C
  std::vector<int> cluster_of;  ///< (W)
  RoundedRows basis;            ///< (3W x k) P, orthonormal columns in each cluster, then R
  RoundedRows beyond;           ///< (3W x k) the same for displacements of higher order
  /// Pairs (c, d), c < d, of clusters that are far from each other, in rising order.
  std::vector<int> far_first, far_second;
  /// k rows for each of these pairs: row i is S_cd(i, .), m/N.
  RoundedRows couplings;
  /// (V + 1) The neighbours of v, including v, are neighbours[first[v]] .. [first[v + 1] - 1], in
  /// rising order.
  std::vector<int> first;
  std::vector<int> neighbours;
  /// Nine rows of n_v numbers for each vertex v: row 3 d + c is G between force component d at v
  /// and displacement component c of its neighbours.
  std::vector<std::int16_t> near;
  std::vector<float> near_scale;  ///< (V) m/N per unit of `near`

  [[nodiscard]] int nodes() const { return static_cast<int>(cluster_of.size()); }  ///< W
};

/// Evaluates a table. Only the constructor allocates.
class Compliance {
 public:
  /// @param table  outlives this
  /// @pre trouble_of(table) is empty
  explicit Compliance(const ComplianceTable& table);

  [[nodiscard]] int vertices() const { return table_.vertices; }
  [[nodiscard]] int nodes() const { return table_.nodes(); }  ///< W
  [[nodiscard]] int clusters() const { return table_.clusters; }
  [[nodiscard]] std::size_t rank() const { return table_.basis.width; }  ///< k
  [[nodiscard]] int cluster_of(int node) const { return table_.cluster_of[node]; }
  [[nodiscard]] const ComplianceTable& table() const { return table_; }
  [[nodiscard]] std::span<const int> neighbours(int vertex) const {
    return {table_.neighbours.data() + table_.first[vertex],
            static_cast<std::size_t>(table_.first[vertex + 1] - table_.first[vertex])};
  }
  [[nodiscard]] bool are_far(int c, int d) const { return pair(c, d) >= 0; }

  /// source += P^T force, for the cluster of the vertex. @param source  (k)
  void add_source(int vertex, const Eigen::Vector3f& force, std::span<float> source) const;
  /// target += S_dc source. @pre the clusters are far from each other. @param target  (k)
  void add_target(int from, std::span<const float> source, int to, std::span<float> target) const;
  /// The displacement P target at a node, m. @param target  (k) of the node's cluster
  [[nodiscard]] Eigen::Vector3f at(int node, std::span<const float> target) const;
  /// u = P target at the first n nodes. @param targets  (C x k)  @param u  (3 x n) m, overwritten,
  /// n <= W
  void everywhere(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const;

  /// The displacement by targets of higher order, from the basis `beyond`: at one node, and added
  /// to u at the first n nodes. Shapes as of at() and everywhere().
  [[nodiscard]] Eigen::Vector3f beyond_at(int node, std::span<const float> target) const;
  void add_beyond(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const;

  /// u(neighbours) += G force, for all loads and those neighbours that are among the first n nodes.
  /// Faster where loads of one cluster, which have the same neighbours, stand next to each other.
  /// @param u  (3 x n) m
  void add_near(std::span<const VertexForce> loads, Eigen::Ref<Eigen::Matrix3Xf> u) const;
  void add_near(int vertex, const Eigen::Vector3f& force,
                const Eigen::Ref<Eigen::Matrix3Xf>& u) const {
    const VertexForce load{vertex, force};
    add_near({&load, 1}, u);
  }
  /// G between the force at `vertex` and the displacement of its k-th neighbour, m/N: column d
  /// belongs to component d of the force.
  [[nodiscard]] Eigen::Matrix3f near_block(int vertex, std::size_t k) const;

 private:
  [[nodiscard]] int pair(int c, int d) const {
    return pair_of_[static_cast<std::size_t>(c) * static_cast<std::size_t>(table_.clusters) +
                    static_cast<std::size_t>(d)];
  }

  const ComplianceTable& table_;
  std::vector<std::size_t> near_first_;  // (V) first of a vertex's nine rows in `near`
  std::vector<int> pair_of_;             // (C x C) index of the far pair; -1: near clusters
};

/// The part of a table that is inconsistent, such as "its size"; empty if the table is consistent.
[[nodiscard]] std::string_view trouble_of(const ComplianceTable& table);

/// The linear displacement G f under loads at any vertices: by sources and targets between far
/// clusters, by the rows of the loaded vertices in near ones. Keeps the memory of its evaluations.
/// Allocates in its constructor.
class LinearField {
 public:
  /// @param compliance  outlives this
  explicit LinearField(const Compliance& compliance);

  /// u = G f at the first n nodes. The result does not depend on the order of the loads. @param u
  /// (3 x n) m
  void fill(std::span<const VertexForce> loads, const Eigen::Ref<Eigen::Matrix3Xf>& u);

 private:
  const Compliance& compliance_;
  std::vector<float> sources_, targets_;  // (C x k)
  std::vector<char> is_source_;           // (C)
  std::vector<VertexForce> by_cluster_;   // loads that are not 0, ordered by their clusters
};

/// The compliance among the few vertices that take part in contact, as one matrix. A finger that
/// slides brings a few new vertices in each frame: only their blocks are computed. The values do
/// not depend on earlier calls, only the time of a call does. Allocates in its constructor.
class ComplianceCache {
 public:
  /// @param compliance  outlives this
  /// @param most        vertices at a time
  ComplianceCache(const Compliance& compliance, int most);

  /// Computes the blocks among these vertices that are missing.
  /// @pre no vertex twice, and at most as many as the constructor was given
  void bring(std::span<const int> vertices);

  /// The slot that holds the rows of a vertex of the last bring().
  [[nodiscard]] int slot_of(int vertex) const { return slot_of_vertex_[vertex]; }
  /// Displacement of the vertex in slot i per force at the vertex in slot j, m/N.
  [[nodiscard]] Eigen::Matrix3f block(int i, int j) const {
    return blocks_.block<3, 3>(3 * i, 3 * j);
  }
  /// All blocks: row and column 3 i + d belong to component d at slot i. Slots without a vertex of
  /// the last bring() hold arbitrary numbers.
  [[nodiscard]] const Eigen::MatrixXf& blocks() const { return blocks_; }

 private:
  void compute(int slot);
  [[nodiscard]] Eigen::Matrix3f block_of(int vertex, int other);
  [[nodiscard]] std::span<const float> targets_at(int slot, int from, int to);

  const Compliance& compliance_;
  int most_;
  std::vector<int> slot_of_vertex_;  // (V) -1: in no slot
  std::vector<int> vertex_of_slot_;  // (most) -1: free
  std::vector<char> wanted_;         // (most) 1: holds a vertex of this bring()
  std::vector<float> basis_;         // (3 most x k) rows of P
  Eigen::MatrixXf blocks_;           // (3 most x 3 most)
  std::vector<char> has_target_;     // (most x C) 1: targets_ is computed
  std::vector<float> targets_;       // (most x C x 3 x k) of unit forces in x, y, z
};

}  // namespace palpable
