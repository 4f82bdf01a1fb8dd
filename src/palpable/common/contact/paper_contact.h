/// @file
/// Algorithm 1 of the paper, literally: a counter that goes up and down by one per frame.
///
///     cloud = decimate(depth, N_step)
///     (d_min, node) = least distance between the body's contact nodes and the cloud
///     if  d_min < delta_Incr  and  t < t_max:                     t++, update(node, t)
///     else if  delta_Incr < d_min < delta_Decr  and  t > t_min:   t--, update(node, t)
///
/// Kept for comparison (`--contact paper`). Its defects, each with a test:
/// - beyond delta_Decr, or with nothing seen, nothing happens: a hand that leaves between two
///   frames leaves the body pressed for ever;
/// - the nearest node is taken anew in every frame: when it changes while pressed, the whole press
///   jumps from one site to another;
/// - a full press needs as many frames as there are levels, however fast the hand is;
/// - the distance has no sign: a hand deep inside is as far away as one outside.
///
/// The paper does not say which nodes it queries nor in which shape. Ours are in the deformed
/// shape: the middles of the sites ("the most salient features", Sec. 3.4) or all nodes of the skin
/// ("finite element nodes on the boundary, a subset of them", Sec. 2.4). With all nodes the site
/// nearest to the node at rest is pressed, since only sites have been solved.
#pragma once

#include "palpable/common/contact/cloud_distance.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Which nodes of the body Algorithm 1 queries.
enum class QueriedNodes {
  kSites,  ///< the middles of the sites
  kAll     ///< all of the skin that no support holds
};

/// N_step is ObjectSurfaceSettings::step.
struct PaperSettings {
  /// m, delta_Incr. The paper gives no number. A node inside a finger is up to half the finger's
  /// thickness from the skin that the camera sees, and the cloud's points are 3 mm apart.
  double press_distance = 0.012;
  double release_distance = 0.025;  ///< m, delta_Decr > delta_Incr
  QueriedNodes nodes = QueriedNodes::kSites;
  DistanceQuery distance = DistanceQuery::kGrid;
  double voxel = 0.004;  ///< m, side of the Voxmap's voxels: about the spacing of the cloud
};

/// deformationPseudoTime and nodeVirtualObject. The default is at rest.
struct PaperState {
  int site = 0;
  int step = 0;  ///< row of the body's level axis: 0 (t_min, at rest) .. L - 1 (t_max)
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();  ///< m, the seen point nearest to it

  friend bool operator==(const PaperState&, const PaperState&) = default;
};

/// The nodes that are queried, in the shape that a state gives the body.
///   N  nodes
class PaperNodes {
 public:
  PaperNodes(const ReducedBody& body, QueriedNodes which);

  /// Moves the nodes to the shape of a state. Allocates nothing.
  /// @param body  as in the constructor
  void deform(const PaperState& state, const ReducedBody& body);

  /// (3 x N) m, body frame
  [[nodiscard]] const Eigen::Matrix3Xf& positions() const { return positions_; }
  /// The site whose middle is nearest to the node at rest.
  [[nodiscard]] int site_of(Eigen::Index node) const { return sites_[node]; }

 private:
  QueriedNodes which_;
  std::vector<int> vertices_, sites_;  // (N)
  Eigen::Matrix3Xf rest_, positions_;  // (3 x N) m
  Eigen::Matrix3Xf displacement_;      // (3 x V) m, of QueriedNodes::kAll
};

/// The queried node to which a seen point is nearest.
struct NearestNode {
  int site = 0;                                     ///< PaperNodes::site_of() the node
  double distance = 0;                              ///< m, from point to point
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< m, the seen one
};

/// parallelizedDistance, up to cloud.reach(); nothing if all nodes are farther. The first of
/// equally near nodes.
[[nodiscard]] std::optional<NearestNode> nearest_node(const PaperNodes& nodes,
                                                      const CloudDistance& cloud);

/// The same for any distance, as printed: all pairs, O(N n).
/// @param cloud  m, body frame
[[nodiscard]] std::optional<NearestNode> nearest_by_all_pairs(
    const PaperNodes& nodes, std::span<const Eigen::Vector3f> cloud);

/// Advances the state by one frame. Pure. A distance of exactly delta_Incr or delta_Decr changes
/// nothing, as printed.
/// @throws ContractViolation unless 0 < press_distance < release_distance and last_step >= 1
[[nodiscard]] PaperState advance_as_printed(const PaperState& previous,
                                            const std::optional<NearestNode>& nearest,
                                            int last_step, const PaperSettings& settings);

/// The state as a touch, as other laws return it; nothing at rest.
[[nodiscard]] std::optional<Touch> touch_of(const PaperState& state, const ReducedBody& body);

}  // namespace palpable
