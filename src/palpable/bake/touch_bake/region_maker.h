/// @file
/// Computes a region: the modes for the response of a body to large loads near one position of its
/// skin, and the stored energy in these modes (response/region.h).
#pragma once

#include "palpable/bake/solid/modal_forms.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/region.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

struct RegionSettings {
  double spacing = 0.014;  ///< m: largest distance of a vertex from the nearest region's middle
  int most = 200;          ///< regions; on a skin that would need more they lie farther apart
  double reach = 0.018;    ///< m: loads within this distance of its middle belong to a region
  int modes = 80;          ///< r, a multiple of 16
  int leading = 24;        ///< s, modes with the third order
  int loads = 150;         ///< number of random loads that the modes are made from
  double least_load = 0.0015, largest_load = 0.008;  ///< m, radii of those loads
  /// m: a region's own clusters, where its modes are stored, are those whose centroids are within
  /// this distance of its middle, and all clusters near those. Elsewhere only far shapes are
  /// stored.
  double core = 0.014;
  int far_shapes = 16;  ///< f, a multiple of 16
};

/// The modes come from random loads that resemble those of obstacles: pressure on discs of the
/// radii above, distributed like that under a ball, (1 - r^2 / R^2)^(1/2), at random positions
/// within the reach. Their directions are tilted from the skin's normal by a tangential part of up
/// to a half, since frictionless contact presses along the obstacle's normal and not the skin's.
/// The displacements of first and second order under these loads, each scaled to energy 1, form a
/// set whose leading directions in the stiffness' norm are the modes. The far shapes are the
/// leading directions of the second orders in the clusters that are not the region's own.
///
/// @param vertex      the region's middle
/// @param forms       of the same body and state
/// @param compliance  gives the clusters and the bases of their targets
[[nodiscard]] RegionTable make_region(const SkinResponse& skin, const ModalFormMaker& forms,
                                      const Compliance& compliance, int vertex,
                                      const RegionSettings& settings);

/// The nodes at which a region stores its modes in full: RegionTable::vertices. Needs no numbers of
/// the compliance, only its clusters.
[[nodiscard]] std::vector<int> region_nodes(const SkinResponse& skin, const Compliance& compliance,
                                            int vertex, const RegionSettings& settings);

}  // namespace palpable
