/// @file
/// Detects whether the camera stands still. Up to 48 patches of the picture in which it came to
/// rest are searched at their old positions. This costs next to nothing and needs no map.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/track/patch.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

enum class Stillness {
  kStill,  ///< most patches that can be compared are at their old positions
  kMoved,  ///< the patches that can be compared have moved
  /// Too few patches can be compared, and at 10 or more others the picture shows something
  /// different at a similar depth or farther: the camera has moved farther than patches are
  /// followed.
  kOtherView,
  kUnclear  ///< too few can be compared: it is dark, or something nearer hides them
};

class StillWatch {
 public:
  /// Cuts the patches from the view of a camera that stands still.
  /// @param depth  m, NaN unknown; of the same view, of any size
  void begin(const GrayImage& image, const DepthImage& depth);
  [[nodiscard]] bool begun() const { return !patches_.empty(); }

  /// Searches the patches. Does not allocate.
  /// @param depth   of the same size as in begin()
  /// @param moving  255 where something moves, or null; the image's size is a multiple of its size
  [[nodiscard]] Stillness look(const GrayImage& image, const DepthImage& depth,
                               const MaskImage* moving) const;

 private:
  struct Patch {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    PatchTemplate look;
    double least_likeness = 1;
    float follows = 0;  // strength of its texture: grey levels per px in the weaker direction
    float depth = 0;    // Z, m; NaN: unknown
  };
  [[nodiscard]] static bool is_hidden(const Patch& patch, const GrayImage& image,
                                      const DepthImage& depth);
  [[nodiscard]] static std::optional<Patch> patch_at(const Pyramid& pyramid,
                                                     const Eigen::Vector2d& at);
  void fill_up(const Pyramid& pyramid, const GrayImage& image);

  std::vector<Patch> patches_;
};

}  // namespace palpable
