/// @file
/// Does the camera stand still? Up to 48 patches of the picture in which it came to rest are looked
/// for where they were: costs next to nothing, and needs neither depth nor a map.
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/track/patch.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

enum class Stillness {
  kStill,   ///< most patches that can be compared are where they were
  kMoved,   ///< most of them are somewhere else
  kUnclear  ///< too few can be compared: they are hidden, it is dark, or the camera is far away
};

class StillWatch {
 public:
  /// The camera stands, and this is what it sees: takes the patches.
  void begin(const GrayImage& image);
  [[nodiscard]] bool begun() const { return !patches_.empty(); }

  /// Looks for the patches. Takes no memory.
  /// @param moving  255 where something moves, or null; the image's size is a multiple of its size
  [[nodiscard]] Stillness look(const GrayImage& image, const MaskImage* moving) const;

 private:
  struct Patch {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    PatchTemplate look;
    double least_likeness = 1;
    float follows = 0;  // how well it can be followed: grey levels per px in its worse direction
  };
  [[nodiscard]] static std::optional<Patch> patch_at(const Pyramid& pyramid,
                                                     const Eigen::Vector2d& at);
  void fill_up(const Pyramid& pyramid, const GrayImage& image);

  std::vector<Patch> patches_;
};

}  // namespace palpable
