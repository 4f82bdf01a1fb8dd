/// @file
/// How every vertex of a body's skin gives way to a small force on any other: Green's function of
/// the linear body, kept as
///
///     G  =  sum over modes  phi_k phi_k^T   +   N          m/N
///
/// a few hundred modes for what is smooth, and what they leave, N, exactly between vertices that
/// lie near each other: under a fingertip the field is far too sharp for modes.
///
///   V  vertices of the skin     R  modes, a multiple of 16     n_v  neighbours of vertex v, padded
///
/// All numbers are in 16 bits with a factor for each row, or each vertex: off by 2e-5 of the row's
/// largest.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace palpable {

/// What a body file keeps of it.
struct ComplianceTable {
  int vertices = 0;                 ///< V
  int rank = 0;                     ///< R
  std::vector<std::int16_t> modes;  ///< (3V x R) Phi, row by row; row 3 v + c is x, y or z of v
  std::vector<float> mode_scale;    ///< (3V) per unit of `modes`, by row
  std::vector<std::int16_t> codes;  ///< (3V x R) C, likewise
  std::vector<float> code_scale;    ///< (3V) m/N per unit of `codes`
  /// (V + 1) neighbours of v, itself among them: neighbours[first[v]] .. [first[v + 1] - 1],
  /// rising.
  std::vector<int> first;
  std::vector<int> neighbours;
  /// For vertex v nine rows of n_v numbers: row 3 d + c is N between force component d at v and
  /// displacement component c of its neighbours. n_v is their count, rounded up to 16.
  std::vector<std::int16_t> near;
  std::vector<float> near_scale;  ///< (V) m/N per unit of `near`
};

/// The table, ready to be asked. Nothing here allocates but the constructor.
class Compliance {
 public:
  /// @pre the table is consistent, as check() says
  explicit Compliance(ComplianceTable table);

  [[nodiscard]] int vertices() const { return table_.vertices; }
  [[nodiscard]] int rank() const { return table_.rank; }
  [[nodiscard]] const ComplianceTable& table() const { return table_; }
  [[nodiscard]] std::span<const int> neighbours(int vertex) const {
    return {table_.neighbours.data() + table_.first[vertex],
            static_cast<std::size_t>(table_.first[vertex + 1] - table_.first[vertex])};
  }

  /// code += C^T force: how much of each mode a force at a vertex brings.
  /// @param code  (R)
  void add_code(int vertex, const Eigen::Vector3f& force, std::span<float> code) const;
  /// shape += Phi^T force: the work of a force along each mode. @param shape  (R)
  void add_shape(int vertex, const Eigen::Vector3f& force, std::span<float> shape) const;
  /// Phi code at a vertex, m.
  [[nodiscard]] Eigen::Vector3f modes_at(int vertex, std::span<const float> code) const;
  /// The same at all vertices. @param u  (3 x V) overwritten
  void modes_everywhere(std::span<const float> code, Eigen::Matrix3Xf& u) const;

  /// u(neighbours) += N force. @param u  (3 x V) m
  void add_near(int vertex, const Eigen::Vector3f& force, Eigen::Matrix3Xf& u) const;
  /// N between force at `vertex` and displacement of its neighbour number `k`, m/N: column d
  /// belongs to the force's component d.
  [[nodiscard]] Eigen::Matrix3f near_block(int vertex, std::size_t k) const;

 private:
  ComplianceTable table_;
  std::vector<std::size_t> near_first_;  // (V) where the nine rows of a vertex begin
};

/// Why a table is not consistent; empty if it is.
[[nodiscard]] std::string_view trouble_of(const ComplianceTable& table);

/// n rounded up to a whole number of rows' steps.
[[nodiscard]] std::size_t padded(std::size_t n);

}  // namespace palpable
