/// @file
/// Corrections of the tables' displacement by full-order solutions of single loads. A full-order
/// solution takes longer than a frame, so it belongs to the load of an earlier frame; it corrects
/// the loads that are similar to that one.
///
///   V, W  vertices of the skin, and nodes: those and inner ones
///   f_0   the load that was solved in full      G  the linear compliance (compliance.h)
///
///     u(f) = u_tables(f) + w(f) c,    c = u_exact(f_0) - u_tables(f_0)
///
///     w = s^2 k^4     s = f . G f_0 / f_0 . G f_0                     how much of f_0 is in f
///                     k = (f . G f_0)^2 / (f . G f  f_0 . G f_0)      how alike they are
///
/// Forces are compared by the work that they do on each other's displacements, so that a force that
/// moves on to the next contact point is nearly the same load. w(f_0) = 1, and w = 0 at rest;
/// docs/lab/touch.md has the figures behind both exponents.
#pragma once

#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace palpable {

/// A load f_0 whose full-order solution is requested, with the displacement under it by the tables
/// of touch (touch_tables.h) and by their linear part alone.
struct RequestedLoad {
  std::vector<VertexForce> forces;  ///< each vertex once, rising
  Eigen::Matrix3Xf tables;          ///< (3 x W) m, u_tables(f_0)
  Eigen::Matrix3Xf linear;          ///< (3 x V) m, G f_0
};

/// The correction c of one load. By default there is none.
struct ExactCorrection {
  Eigen::Matrix3Xf field;   ///< (3 x W) m
  Eigen::Matrix3Xf linear;  ///< (3 x V) m, G f_0
  float work = 0;           ///< f_0 . G f_0, N m; 0: there is no correction
};

/// The correction that is blended out and the one that is blended in; part of a TouchState.
struct Refinement {
  std::array<ExactCorrection, 2> corrections;
  /// The weight of each correction in the state's displacement, blending included.
  std::array<float, 2> weights{};
  float blended = 1;  ///< 0 .. 1: share of the second correction; the first has the rest

  /// Whether there is a correction.
  [[nodiscard]] bool acts() const { return corrections[0].work > 0 || corrections[1].work > 0; }

  /// The weight of each correction under loads, w times its share of the blending.
  /// @param at_loads  (3 x loads) m, G f at their vertices
  [[nodiscard]] std::array<float, 2> weights_under(
      std::span<const VertexForce> loads, const Eigen::Ref<const Eigen::Matrix3Xf>& at_loads) const;

  /// The full-order solution of a load becomes the correction that is blended in. False: it differs
  /// from the tables' by more than 30 %, which happens where the body does not bear the load
  /// without the obstacle; nothing is changed.
  /// @param exact  (3 x W) m
  [[nodiscard]] bool take_up(const RequestedLoad& load, const Eigen::Matrix3Xf& exact);
};

/// Sorts the forces by vertex and adds up those at the same one. @pre forces is not empty
void add_up_by_vertex(std::vector<VertexForce>& forces);

/// make_probe() makes a test load: small forces all over the skin, whose response is linear. Its
/// full-order solution is known from the body's tables; is_of_probed_body() compares it with the
/// one that another process computed, so that corrections of a different body are refused.
void make_probe(LinearField& field, int vertices, int nodes, RequestedLoad& probe);
[[nodiscard]] bool is_of_probed_body(const RequestedLoad& probe, const Eigen::Matrix3Xf& exact);

/// The weight w of a load f.
/// @param work    f . G f, N m
/// @param shared  f . G f_0, N m
/// @param solved  f_0 . G f_0, N m
[[nodiscard]] float correction_weight(float work, float shared, float solved);

}  // namespace palpable
