/// @file
/// The response of a body to a large load near one position of its skin, beyond the linear
/// response: the second and third order of the displacement, in some dozens of modes.
///
///   r  modes of the region, a multiple of 16     s  leading modes, s <= r
///   f  far shapes of the modes, a multiple of 16
///
/// The modes U are orthonormal in the body's stiffness, U^T K U = 1. A load f near the region's
/// middle has the coordinates a = U^T f. The linear response K^-1 f is not taken from the modes but
/// from the compliance (compliance.h). With the third and fourth derivatives A and B of the stored
/// energy in the modes,
///
///     q_2 = - 1/2 A(a, a)                               r modes
///     q_3 = - A(a, q_2) - 1/6 B(a, a, a) = - 1/6 E(a, a, a),   E = B - 3 sym(A A)    s modes
///     u   = K^-1 f + U (q_2 + q_3)
///
/// (load_response.h computes the same on the full mesh.) The third order is the small difference of
/// two large terms, those of a rotation, which must be cut off at the same mode. Therefore E is
/// stored as one form, of the leading modes alone. q is the gradient of a polynomial in a, so its
/// derivative is symmetric:
///
///     dq/da = H = - A(a, .) - 1/2 E(a, a, ., .)
///
/// The series converges for small loads only. Where |q_3| exceeds kSeriesEnd times |a| + |q_2|, q
/// is extended linearly along the ray of a: q(a) = q(s a) / s, with s a at that limit.
#pragma once

#include "palpable/common/response/rounded_rows.h"
#include "palpable/common/response/symmetric_form.h"

#include <span>
#include <vector>

namespace palpable {

/// A region as a body file stores it.
struct RegionTable {
  int vertex = 0;  ///< of the skin: the region's middle
  /// (n) the nodes around the middle, vertices and inner ones, in rising order: all nodes of some
  /// clusters (compliance.h).
  std::vector<int> vertices;
  RoundedRows modes;  ///< (3n x r) at these nodes, sqrt(m/N)
  /// The modes in all other clusters are sums of f *far shapes*, stored as targets (compliance.h):
  /// k rows of f numbers for each of those clusters, in rising order.
  RoundedRows far_shapes;
  RoundedRows far_shares;  ///< (f x r) factor of each far shape in each mode
  SymmetricForm cubic;     ///< A, of r variables
  SymmetricForm quartic;   ///< E, of s variables

  [[nodiscard]] int mode_count() const { return cubic.variables; }
  [[nodiscard]] int leading() const { return quartic.variables; }
  [[nodiscard]] std::size_t far_count() const { return far_shares.count(); }  ///< f
};

class FormRows;

/// A region's energy, laid out for evaluation (FormRows).
struct RegionForms {
  const FormRows& cubic;
  const FormRows& quartic;
};

/// The largest RegionResponse::last_share() up to which the series is used. A fingertip 10 mm deep
/// in a bunny of 150 mm has 0.03, a hard squeeze of it 0.15. Larger: the third order is trusted
/// where it is no longer small.
inline constexpr float kSeriesEnd = 0.25f;

/// The response of one region; its memory is used again.
class RegionResponse {
 public:
  /// @param most_modes    r of the largest region
  /// @param most_leading  s of the largest
  RegionResponse(int most_modes, int most_leading);

  /// q = q_2 + q_3 and H at modal coordinates a. @param a  (r)
  void evaluate(const RegionForms& region, std::span<const float> a);

  [[nodiscard]] std::span<const float> q() const { return {q_.data(), size_}; }  ///< (r)
  /// |q_3| / (|a| + |q_2|) at these coordinates, in the norm of the stiffness. Above kSeriesEnd the
  /// series was extended along the ray.
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
