/// @file
/// Modes in which a body answers large loads near one place of its skin, and its energy in them
/// (response/region.h).
#pragma once

#include "palpable/bake/solid/modal_forms.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/region.h"

#include <Eigen/Core>

namespace palpable {

struct RegionSettings {
  double spacing = 0.014;  ///< m: no vertex is farther from the nearest region's middle
  int most = 200;          ///< regions; on a larger skin they lie farther apart
  double reach = 0.018;    ///< m: loads so near a region's middle are answered by it
  int modes = 80;          ///< r, a multiple of 16
  int leading = 24;        ///< s
  int loads = 150;         ///< that the modes are made from
  double least_load = 0.0015, largest_load = 0.008;  ///< m, radii of those loads
  double core = 0.014;  ///< m: its own clusters are those so near its middle and all near those
  int far_shapes = 16;  ///< f, a multiple of 16
};

/// The modes come from loads as things make them: pressure on discs of the sizes above, like that
/// of a ball (1 - r^2 / R^2)^(1/2), at random places within the reach, tilted by up to half of the
/// normal (frictionless contact presses along the object's normal, not the skin's), and from the
/// second order of the answers to them. All count alike in the stiffness' norm; the leading ones of
/// that set are the modes. The far shapes are the leading directions of what the second orders do
/// in the clusters that are not the region's own.
///
/// @param vertex    the region's middle
/// @param forms     of the same body and state
/// @param compliance  its clusters, and their targets
[[nodiscard]] RegionTable make_region(const SkinResponse& skin, const ModalFormMaker& forms,
                                      const Compliance& compliance, int vertex,
                                      const RegionSettings& settings);

}  // namespace palpable
