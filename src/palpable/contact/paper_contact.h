/// @file
/// Algorithm 1 of the paper, literally: a counter that goes up and down by one per frame.
///
///     cloud = decimate(depth, N_step)
///     (d_min, node) = least distance between the body's contact nodes and the cloud
///     if  d_min < delta_Incr  and  t < t_max:                     t++, update(node, t)
///     else if  delta_Incr < d_min < delta_Decr  and  t > t_min:   t--, update(node, t)
///
/// Kept for comparison (`--contact paper`). What is wrong with it, each with a test:
/// - beyond delta_Decr, or with nothing seen, nothing happens: a hand that leaves between two
///   frames leaves the body pressed for ever;
/// - the nearest node is taken anew in every frame: when it changes while pressed, the whole press
///   jumps from one site to another;
/// - a full press needs as many frames as there are levels, however fast the hand is;
/// - the distance has no sign: a hand deep inside is as far away as one outside.
///
/// The paper does not say which nodes it queries nor in which shape; ours are the middles of the
/// sites ("the most salient features", Sec. 3.4) of the deformed body.
#pragma once

#include "palpable/contact/touch.h"
#include "palpable/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace palpable {

struct PaperSettings {
  /// m, delta_Incr. The paper gives no number. A node inside a finger is up to half the finger's
  /// thickness from the skin that the camera sees, and the cloud's points are 3 mm apart.
  double press_distance = 0.012;
  double release_distance = 0.025;  ///< m, delta_Decr > delta_Incr
};

/// deformationPseudoTime and nodeVirtualObject. The default is at rest.
struct PaperState {
  int site = 0;
  int step = 0;  ///< row of the body's level axis: 0 (t_min, at rest) .. L - 1 (t_max)
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();  ///< m, the seen point nearest to it

  friend bool operator==(const PaperState&, const PaperState&) = default;
};

/// A contact node and the seen point that is nearest to it.
struct NearestNode {
  int site = 0;
  double distance = 0;  ///< m, from point to point
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
};

/// parallelizedDistance: all pairs, O(S n). Nothing when nothing is seen.
/// @param nodes  (3 x S) m, body frame, deformed
/// @param cloud  m, body frame: ObjectSurface::cloud()
[[nodiscard]] std::optional<NearestNode> nearest_node(const Eigen::Matrix3Xf& nodes,
                                                      std::span<const Eigen::Vector3f> cloud);

/// One frame. Pure. A distance of exactly delta_Incr or delta_Decr does nothing, as printed.
/// @throws ContractViolation unless 0 < press_distance < release_distance and last_step >= 1
[[nodiscard]] PaperState advance_as_printed(const PaperState& previous,
                                            const std::optional<NearestNode>& nearest,
                                            int last_step, const PaperSettings& settings);

/// The state in the terms of the default law; nothing at rest.
[[nodiscard]] std::optional<Touch> touch_of(const PaperState& state, const ReducedBody& body);

/// (3 x S) the middles of the sites in the shape that `state` gives the body.
/// @param nodes  overwritten; allocates nothing when it has S columns already
void deformed_nodes(const PaperState& state, const ReducedBody& body, Eigen::Matrix3Xf& nodes);

}  // namespace palpable
