/// @file
/// What exact answers to single loads add to the tables' answer. Who solves a body in full takes
/// longer than a frame, so an answer belongs to a load of some frames ago; it is used for loads
/// that are like that one.
///
///   V, W  vertices of the skin, and nodes: those and inner ones
///   f_0   the load that was asked for      G  the linear answer (compliance.h)
///
///     u(f) = u_tables(f) + w(f) c,    c = u_exact(f_0) - u_tables(f_0)
///
///     w = s^2 k^4     s = f . G f_0 / f_0 . G f_0                     how much of f_0 is in f
///                     k = (f . G f_0)^2 / (f . G f  f_0 . G f_0)      how alike they are
///
/// Forces are compared by the work that they do on each other's displacements: one that moves on to
/// the next contact point is nearly the same. w(f_0) = 1, and w = 0 at rest; docs/touch.md has the
/// figures behind both exponents.
#pragma once

#include "palpable/common/response/compliance.h"
#include "palpable/common/response/linear_field.h"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace palpable {

/// A load whose exact answer is wanted, and what is known of it.
struct RequestedLoad {
  std::vector<VertexForce> forces;  ///< each vertex once, rising
  Eigen::Matrix3Xf tables;          ///< (3 x W) m, the tables' answer
  Eigen::Matrix3Xf linear;          ///< (3 x V) m, G f_0
};

/// c of one load. The default is none.
struct ExactCorrection {
  Eigen::Matrix3Xf field;   ///< (3 x W) m
  Eigen::Matrix3Xf linear;  ///< (3 x V) m, G f_0
  float work = 0;           ///< f_0 . G f_0, N m; 0: no load was answered
};

/// The correction that goes and the one that comes, part of a TouchState.
struct Refinement {
  std::array<ExactCorrection, 2> corrections;
  /// Of each in the state's displacement, how far it is blended in included.
  std::array<float, 2> weights{};
  float blended = 1;  ///< 0 .. 1: how far the second is in and the first is out

  /// Whether any correction may act.
  [[nodiscard]] bool acts() const { return corrections[0].work > 0 || corrections[1].work > 0; }

  /// How much of each correction acts under loads.
  /// @param at_loads  (3 x loads) m, G f at their vertices
  [[nodiscard]] std::array<float, 2> weights_under(
      std::span<const VertexForce> loads, const Eigen::Ref<const Eigen::Matrix3Xf>& at_loads) const;

  /// The exact answer to a load becomes the correction that comes. False: it is so far from the
  /// tables' that the load was more than the body bears; nothing is changed.
  /// @param exact  (3 x W) m
  [[nodiscard]] bool take_up(const RequestedLoad& asked, const Eigen::Matrix3Xf& exact);
};

/// Each vertex once, rising, with the sum of its forces. @pre forces is not empty
void add_up_by_vertex(std::vector<VertexForce>& forces);

/// A load all over the skin, so small that its answer is the linear one; what the exact answer is
/// to agree with, if it is this body's.
void make_probe(LinearField& field, int vertices, int nodes, RequestedLoad& probe);
[[nodiscard]] bool is_of_probed_body(const RequestedLoad& probe, const Eigen::Matrix3Xf& exact);

/// w of a load f.
/// @param work    f . G f, N m
/// @param shared  f . G f_0
/// @param asked   f_0 . G f_0
[[nodiscard]] float correction_weight(float work, float shared, float asked);

}  // namespace palpable
