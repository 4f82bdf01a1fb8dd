/// @file
/// How every vertex of a body's skin gives way to a small force on any other: Green's function G of
/// the linear body, m/N. The skin is divided into clusters of vertices. Between vertices of
/// clusters that lie near each other G is kept as it is: under a fingertip the field is far too
/// sharp for anything less. Between clusters c, d that lie far from each other it is smooth, and
///
///     G(d, c)  =  P_d  S_dc  P_c^T,      S_dc = S_cd^T
///
/// (an H^2 matrix of one level: Hackbusch, Hierarchical Matrices, 2015, ch. 8). P_c has some dozens
/// of columns, so that a force acts through a few numbers of its cluster, its *source*, and what
/// arrives at a cluster is a few numbers, too, its *target*.
///
/// The stress on the skin hangs on nodes that lie inside, too, those of the shell (shell_table.h).
/// No force acts on them, but they are moved: each belongs to the cluster of a vertex near it. Near
/// by they are neighbours as vertices are; from afar
///
///     u_inner(d)  =  R_d P_d^T u_skin(d)
///
/// with R_d the least squares of what loads far away do at d's inner nodes against what they do at
/// its vertices: rows of a basis of their own, behind those of the skin.
///
/// What is of higher order in the loads (region.h) arrives at clusters as targets, too, but in a
/// basis of its own: where a part turns by a small angle, the square of the angle is a strain of
/// its displacement that no load far away brings about in the first order.
///
///   V  vertices of the skin     W  nodes: the vertices, then the inner ones
///   C  clusters                 k  columns of P, a multiple of 16
///   n_v  neighbours of vertex v: all nodes of clusters near its own, padded to 16
///
/// All numbers are in 16 bits with a factor for each row, or each vertex: off by 2e-5 of the row's
/// largest.
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

/// What a body file keeps of it.
struct ComplianceTable {
  int vertices = 0;             ///< V
  int clusters = 0;             ///< C
  std::vector<int> cluster_of;  ///< (W)
  RoundedRows basis;            ///< (3W x k) P, orthonormal columns in each cluster; then R
  RoundedRows beyond;           ///< (3W x k) the same for what is of higher order
  /// Pairs (c, d), c < d, of clusters that are far from each other, rising.
  std::vector<int> far_first, far_second;
  /// k rows for each of these pairs: row i is S_cd(i, .), m/N.
  RoundedRows couplings;
  /// (V + 1) neighbours of v, itself among them: neighbours[first[v]] .. [first[v + 1] - 1],
  /// rising.
  std::vector<int> first;
  std::vector<int> neighbours;
  /// For vertex v nine rows of n_v numbers: row 3 d + c is G between force component d at v and
  /// displacement component c of its neighbours.
  std::vector<std::int16_t> near;
  std::vector<float> near_scale;  ///< (V) m/N per unit of `near`

  [[nodiscard]] int nodes() const { return static_cast<int>(cluster_of.size()); }  ///< W
};

/// The table, ready to be asked. Nothing here allocates but the constructor.
class Compliance {
 public:
  /// @param table  outlives this
  /// @pre the table is consistent, as trouble_of() says
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

  /// source += P^T force of the vertex's cluster. @param source  (k)
  void add_source(int vertex, const Eigen::Vector3f& force, std::span<float> source) const;
  /// target += S_dc source. @pre the clusters are far from each other. @param target  (k)
  void add_target(int from, std::span<const float> source, int to, std::span<float> target) const;
  /// P target at a node, m. @param target  (k) of its cluster
  [[nodiscard]] Eigen::Vector3f at(int node, std::span<const float> target) const;
  /// The same at the first n nodes. @param targets  (C x k)  @param u  (3 x n) overwritten, n <= W
  void everywhere(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const;

  /// The same for targets of higher order, and u += it at the first n nodes.
  [[nodiscard]] Eigen::Vector3f beyond_at(int node, std::span<const float> target) const;
  void add_beyond(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const;

  /// u(neighbours) += G force of all loads, of those among the first n nodes. Faster where loads of
  /// one cluster, which have the same neighbours, follow each other. @param u  (3 x n) m
  void add_near(std::span<const VertexForce> loads, Eigen::Ref<Eigen::Matrix3Xf> u) const;
  void add_near(int vertex, const Eigen::Vector3f& force,
                const Eigen::Ref<Eigen::Matrix3Xf>& u) const {
    const VertexForce load{vertex, force};
    add_near({&load, 1}, u);
  }
  /// G between force at `vertex` and displacement of its neighbour number `k`, m/N: column d
  /// belongs to the force's component d.
  [[nodiscard]] Eigen::Matrix3f near_block(int vertex, std::size_t k) const;

 private:
  [[nodiscard]] int pair(int c, int d) const {
    return pair_of_[static_cast<std::size_t>(c) * static_cast<std::size_t>(table_.clusters) +
                    static_cast<std::size_t>(d)];
  }

  const ComplianceTable& table_;
  std::vector<std::size_t> near_first_;  // (V) where the nine rows of a vertex begin
  std::vector<int> pair_of_;             // (C x C) index of the far pair; -1: near
};

/// Why a table is not consistent; empty if it is.
[[nodiscard]] std::string_view trouble_of(const ComplianceTable& table);

}  // namespace palpable
