/// @file
/// How well depth images agree with one another along a path: what poses are worth for a map.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <span>

namespace palpable {

/// Median of |Z of image i, brought into image j by their poses, less the Z measured there|, m,
/// over pairs that are 5, 15 and 40 images apart, from every sixth image and every eighth pixel
/// across and down. Differences beyond 0.1 m are other surfaces and left out. Nothing without any
/// pair.
/// @param depths            (N) all of the camera's size
/// @param world_from_depth  (N) poses of the depth camera
/// @throws ContractViolation when the numbers or sizes differ
[[nodiscard]] std::optional<double> warped_disagreement(std::span<const DepthImage> depths,
                                                        std::span<const Rigid3> world_from_depth,
                                                        const PinholeCamera& camera);

}  // namespace palpable
