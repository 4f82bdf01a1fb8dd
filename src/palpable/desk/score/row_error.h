/// @file
/// Whether the loss of a rig's alignment is detected and corrected.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// Truth of one frame: how much lower the right image lies than the calibration says, in rows of
/// the full-size picture.
struct TrueRowOffset {
  int frame = 0;
  double offset_px = 0;
  bool step = false;  ///< the offset jumped in this frame
};

/// From this frame on the right image was moved up by this number of rows of the full-size picture,
/// in addition to the rectification by the calibration.
struct RowCorrection {
  int frame = 0;
  double correction_px = 0;
};

/// The largest |offset - correction|, px, over all frames except a step's own and the `settle`
/// frames after it. All pixels of a frame have the same offset, so this is also the largest median
/// row error of a frame. The correction is 0 before the first one; each holds until the next.
/// Nothing when no frame is left.
/// @param truth, corrections  frames strictly increasing
/// @param settle              >= 0, frames: the frame rate, for one second
/// @param processed           one entry per frame of `truth`; 0: the error of this frame does not
///                            count, but a step in it does. Empty: all frames count
/// @throws ContractViolation for a negative `settle` or another length of `processed`
[[nodiscard]] std::optional<double> largest_row_error(std::span<const TrueRowOffset> truth,
                                                      std::span<const RowCorrection> corrections,
                                                      int settle,
                                                      std::span<const std::uint8_t> processed = {});

}  // namespace palpable
