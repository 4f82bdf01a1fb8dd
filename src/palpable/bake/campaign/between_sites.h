/// @file
/// The error of a touch between sites. A body without tables has fields at its sites only; a touch
/// anywhere else is shown with the field of the nearest site. Its error is estimated from linear
/// responses, because it depends on the position of the touch and hardly on its depth.
///
///   V  vertices of the skin
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/describe/touches_between.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

/// Relative L2 errors over the skin.
struct BetweenSites {
  int touches = 0;                                ///< number of touches
  double median = 0, nine_tenths = 0, worst = 0;  ///< quantiles of their errors
};

/// Errors |u - u_s| / |u| of the touches: u is the linear response of a touch and u_s that of the
/// nearest site, each divided by the displacement of its own vertex, so that touches of equal depth
/// are compared. |.|^2 is an integral over the skin.
/// @param site_responses   (3V x sites) displacement per load
/// @param touch_responses  (3V x touches) likewise; at least one
[[nodiscard]] BetweenSites between_sites(const SurfaceMesh& skin, const std::vector<int>& sites,
                                         const Eigen::MatrixXf& site_responses,
                                         const std::vector<int>& touches,
                                         const Eigen::MatrixXf& touch_responses);

/// The same from the linear responses in a store; nothing where the store lacks those of its sites
/// or of touches between them.
[[nodiscard]] std::optional<BetweenSites> between_sites(const SnapshotStore& store);

}  // namespace palpable
