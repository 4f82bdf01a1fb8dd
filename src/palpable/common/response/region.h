/// @file
/// What a large load does beyond the small one's answer, near one place of the skin: the second and
/// third order of the displacement in some dozens of modes.
///
///   r  modes of the region, a multiple of 16     s  the leading ones, s <= r
///   f  shapes of what they do far away, a multiple of 16
///
/// The modes U are orthonormal in the body's stiffness, U^T K U = 1. A load f near the region's
/// middle has the coordinates a = U^T f; K^-1 f itself is not taken from the modes (compliance.h
/// has it exactly). With the third and fourth derivatives A and B of the stored energy in the
/// modes,
///
///     q_2 = - 1/2 A(a, a)                               r modes
///     q_3 = - A(a, q_2) - 1/6 B(a, a, a) = - 1/6 E(a, a, a),   E = B - 3 sym(A A)    s modes
///     u   = K^-1 f + U (q_2 + q_3)
///
/// (load_response.h has the same on the full mesh.) The third order is the small difference of two
/// large terms, those of a rotation, and both have to be cut off at the same mode: so E is one
/// form, of the leading modes alone. q is the gradient of a polynomial, and its derivative
/// symmetric:
///
///     dq/da = H = - A(a, .) - 1/2 E(a, a, ., .)
///
/// A series holds for loads up to some size. Where |q_3| is more than kSeriesEnd of what comes
/// before it, the answer goes on along its ray: q(a) = q(s a) / s with s a at that end.
#pragma once

#include "palpable/common/response/rounded_rows.h"
#include "palpable/common/response/symmetric_form.h"

#include <span>
#include <vector>

namespace palpable {

/// What a body file keeps of one region.
struct RegionTable {
  int vertex = 0;  ///< of the skin, its middle
  /// (n) nodes around it, vertices and inner ones, rising: all of some clusters (compliance.h). The
  /// modes there: three rows of r numbers for each, sqrt(m/N).
  std::vector<int> vertices;
  RoundedRows modes;
  /// What the modes do in all other clusters is a sum of f *far shapes*, as targets (compliance.h):
  /// k rows of f numbers for each of those clusters, rising.
  RoundedRows far_shapes;
  RoundedRows far_shares;  ///< (f x r) how much of each shape is in each mode
  SymmetricForm cubic;     ///< A, of r
  SymmetricForm quartic;   ///< E, of s

  [[nodiscard]] int mode_count() const { return cubic.variables; }
  [[nodiscard]] int leading() const { return quartic.variables; }
  [[nodiscard]] std::size_t far_count() const { return far_shares.count(); }  ///< f
};

class FormRows;

/// A region's energy, ready to be multiplied with (form_rows.h).
struct RegionForms {
  const FormRows& cubic;
  const FormRows& quartic;
};

/// Share of the last order in the displacement's norm at which a series is at its end. A fingertip
/// 10 mm deep in a bunny of 150 mm has 0.03, a hard squeeze of it 0.15.
inline constexpr float kSeriesEnd = 0.25f;

/// Room for one region's answer; its memory is used again.
class RegionResponse {
 public:
  /// @param most_modes    r of the largest region
  /// @param most_leading  s of the largest
  RegionResponse(int most_modes, int most_leading);

  /// q = q_2 + q_3 and H at modal coordinates a. @param a  (r)
  void evaluate(const RegionForms& region, std::span<const float> a);

  [[nodiscard]] std::span<const float> q() const { return {q_.data(), size_}; }  ///< (r)
  /// |q_3| / (|a| + |q_2|) at these coordinates, in the stiffness' norm: how near the series is to
  /// its end, or how far beyond it.
  [[nodiscard]] float last_share() const { return last_share_; }
  /// result = H x, both (r).
  void times(std::span<const float> x, std::span<float> result) const;

 private:
  // The norms of the series' orders.
  struct Orders {
    float first = 0, second = 0, third = 0;
    [[nodiscard]] float last_share() const;
    [[nodiscard]] float shortened_to(float share) const;
  };
  Orders evaluate_series(const RegionForms& region, std::span<const float> a);

  std::size_t size_ = 0;
  float last_share_ = 0;
  std::vector<float> shortened_;  // s a
  std::vector<float> q_, matrix_, pairs_, products_, third_, third_matrix_;
};

}  // namespace palpable
