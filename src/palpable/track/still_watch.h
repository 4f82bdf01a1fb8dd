/// @file
/// Does the camera stand still? A few patches of one image, looked at in the next ones: costs next
/// to nothing, and needs neither depth nor a map.
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/track/patch.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

enum class Stillness {
  kStill,   ///< most patches that can be compared are where they were
  kMoved,   ///< most are somewhere else
  kUnclear  ///< too few can be compared: hidden, dark, or far away
};

class StillWatch {
 public:
  /// What is seen now is where the camera stands.
  void begin(const GrayImage& image);
  [[nodiscard]] bool begun() const { return !patches_.empty(); }

  /// Takes no memory.
  /// @param moving  255 where something moves, or null; of any size that divides the image's
  [[nodiscard]] Stillness look(const GrayImage& image, const MaskImage* moving) const;

 private:
  struct Patch {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    PatchTemplate look;
    double least_likeness = 1;
    float follows = 0;  // how well it can be followed: grey levels a px, in its worse direction
  };
  [[nodiscard]] static std::optional<Patch> patch_at(const Pyramid& pyramid,
                                                     const Eigen::Vector2d& at);
  void fill_up(const Pyramid& pyramid, const GrayImage& image);

  std::vector<Patch> patches_;
};

}  // namespace palpable
