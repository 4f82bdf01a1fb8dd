/// @file
/// How far a measured depth image is from the true one, and the true outlines of things to a
/// fraction of a pixel: what the error budget of a seen surface replaces by the truth.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/image.h"
#include "palpable/desk/clip_files/image_files.h"

#include <limits>
#include <span>

namespace palpable::app {

/// A pixel without an error: not of a thing, or measured on another one.
inline constexpr float kNoError = std::numeric_limits<float>::quiet_NaN();

/// m: a measured depth that is farther off is of another thing.
inline constexpr float kSameThing = 0.008f;

/// px to each side, over which averaged() takes means.
inline constexpr int kAverage = 7;

/// The measured depth minus the true one, m, at each pixel that shows a thing in both images and
/// whose difference is below kSameThing; kNoError elsewhere. All images have the same size.
[[nodiscard]] DepthImage errors_of(const DepthImage& measured, const MaskImage& shows,
                                   const TrueView& truth);

/// At each pixel with an error the mean over those of the 15 x 15 pixels around it that have one.
[[nodiscard]] DepthImage averaged(const DepthImage& errors);

/// The median of the errors of all pixels that have one, m; 0 if none has.
[[nodiscard]] float median_error(const DepthImage& errors);

/// The share of each pixel that things cover: at their outlines by 4 x 4 rays, elsewhere 1 and 0 as
/// the mask has it. Without things the mask's own.
/// @param things  camera frame, m
[[nodiscard]] Image<float> covered(const MaskImage& shows, std::span<const Capsule> things,
                                   const PinholeCamera& camera);

}  // namespace palpable::app
