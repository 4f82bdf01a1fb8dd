/// @file
/// Whether a rig that goes out of alignment is noticed and put right.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// Truth of one frame: by how many rows (full-size px) the right image lies below what the
/// calibration says.
struct TrueRowOffset {
  int frame = 0;
  double offset_px = 0;
  bool step = false;  ///< it jumped in this frame
};

/// From this frame on the right image was moved up by so many rows (full-size px) beyond what the
/// calibration says.
struct RowCorrection {
  int frame = 0;
  double correction_px = 0;
};

/// The largest |offset - correction| over the frames that are more than `settle` frames after the
/// last step before them, px; frames before the first step count. The offset is the same for all
/// pixels of a frame, so it is that frame's median row error too. Before the first correction it is
/// 0, afterwards it holds until the next. Nothing when no frame is left.
/// @param truth, corrections  frames strictly increasing
/// @param settle              frames, >= 0: those of one second
/// @param looked_at           (frames of `truth`) 0: the frame's error does not count, though a
///                            step in it does. Empty: all count
/// @throws ContractViolation for a negative `settle` or another length of `looked_at`
[[nodiscard]] std::optional<double> largest_row_error(std::span<const TrueRowOffset> truth,
                                                      std::span<const RowCorrection> corrections,
                                                      int settle,
                                                      std::span<const std::uint8_t> looked_at = {});

}  // namespace palpable
