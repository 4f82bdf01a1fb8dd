/// @file
/// Does the camera stand still? Up to 48 patches of the picture in which it came to rest are looked
/// for where they were: costs next to nothing, and needs neither depth nor a map.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/track/patch.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

enum class Stillness {
  kStill,  ///< most patches that can be compared are where they were
  kMoved,  ///< most of them are somewhere else
  /// Too few can be compared, and enough others show something else about as far away as what was
  /// there, or farther: the camera has moved by more than patches are followed.
  kOtherView,
  kUnclear  ///< too few can be compared: it is dark, or something nearer hides them
};

class StillWatch {
 public:
  /// The camera stands, and this is what it sees: takes the patches.
  /// @param depth  m, NaN unknown; of the same view, of any size
  void begin(const GrayImage& image, const DepthImage& depth);
  [[nodiscard]] bool begun() const { return !patches_.empty(); }

  /// Looks for the patches. Takes no memory.
  /// @param depth   of the size that begin() got
  /// @param moving  255 where something moves, or null; the image's size is a multiple of its size
  [[nodiscard]] Stillness look(const GrayImage& image, const DepthImage& depth,
                               const MaskImage* moving) const;

 private:
  struct Patch {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    PatchTemplate look;
    double least_likeness = 1;
    float follows = 0;  // how well it can be followed: grey levels per px in its worse direction
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
