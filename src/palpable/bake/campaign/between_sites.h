/// @file
/// What a touch between sites costs. A site is a choice: a touch anywhere else gets the field of
/// the nearest one. How wrong that is, is seen from linear responses: it hardly depends on how deep
/// the touch is, but on where it is.
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
  int touches = 0;
  double median = 0, nine_tenths = 0, worst = 0;  ///< of them
};

/// For each touch |u - u_s| / |u|: u its own linear response and u_s that of the nearest site, each
/// divided by how far its own vertex goes: touches of equal depth. |.|^2 an integral over the skin.
/// @param site_responses   (3V x sites) displacement per load
/// @param touch_responses  (3V x touches) likewise; at least one
[[nodiscard]] BetweenSites between_sites(const SurfaceMesh& skin, const std::vector<int>& sites,
                                         const Eigen::MatrixXf& site_responses,
                                         const std::vector<int>& touches,
                                         const Eigen::MatrixXf& touch_responses);

/// The same from what a store holds of linear responses; none where those of its sites or of
/// touches between them are not there.
[[nodiscard]] std::optional<BetweenSites> between_sites(const SnapshotStore& store);

}  // namespace palpable
