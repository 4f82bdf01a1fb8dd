/// @file
/// How well the depth images along a path agree with one another, which shows whether the poses are
/// accurate enough for a map.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <span>

namespace palpable {

/// Median difference, m, between the depth of image i transformed into image j by their poses and
/// the depth measured there. The image pairs are 5, 15 and 40 images apart and begin with every
/// sixth image; every eighth pixel in x and y is used. Differences of 0.1 m and more belong to
/// other surfaces and are left out. Nothing when no difference remains.
/// @param depths            (N) images of the camera's size, m
/// @param world_from_depth  (N) poses of the depth camera
/// @throws ContractViolation when the numbers or sizes differ
[[nodiscard]] std::optional<double> warped_disagreement(std::span<const DepthImage> depths,
                                                        std::span<const Rigid3> world_from_depth,
                                                        const PinholeCamera& camera);

}  // namespace palpable
