/// @file
/// The stereo matcher's loops as compute shaders, for machines with a GPU: the same winners as
/// stereo_kernels.h, to the bit, and so the same disparities.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/image.h"
#include "palpable/stereo/stereo_kernels.h"

#include <memory>

namespace palpable {

/// Needs OpenGL 4.5: make and use it with a context that is current on this thread. On Mesa's
/// software renderer it is right, and slow.
class GlStereo {
 public:
  /// A problem when a shader cannot be compiled, in the driver's words.
  [[nodiscard]] static Result<GlStereo> make();
  GlStereo(GlStereo&&) noexcept;
  GlStereo& operator=(GlStereo&&) noexcept;
  ~GlStereo();

  /// Winners of a pair: codes, costs, three paths, all on the GPU. It takes 4 W H D bytes of its
  /// memory.
  /// @param disparities  1 to kMostDisparities
  /// @throws ContractViolation when the images differ in size or a number is out of range
  void find_winners(const GrayImage& left, const GrayImage& right, int first, int disparities,
                    const PathPenalties& penalties, Winners& winners);

 private:
  struct Parts;
  explicit GlStereo(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
