#include "palpable/live/track/still_watch.h"

#include "palpable/common/base/order_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace palpable {
namespace {

constexpr int kAcross = 8;
constexpr int kDown = 6;
constexpr std::size_t kPatches = kAcross * kDown;
constexpr int kTries = 4;                  // positions tried per cell, across and down
constexpr std::size_t kLeastPatches = 10;  // fewest patches from which a result is derived
// px from which a patch has moved. Noise of 0.65 grey levels displaces a patch by 0.05 px; in the
// dark the displacement is larger, but its median over all patches stays below the limit.
constexpr double kMoved = 0.3;
// Noise with standard deviation n lowers the correlation of a patch of contrast s with itself to
// 1 / (1 + n^2 / s^2). A patch whose correlation is less than kLikenessShare of that value, with n
// for a dark picture, shows something else.
constexpr double kLikenessShare = 0.75;
constexpr double kNoise = 2;  // n, grey levels
// A patch that is not found counts as hidden if the picture there has less than kFadedShare of the
// patch's contrast (darkness), or a depth below kNearerShare of the patch's (a hand).
constexpr float kFadedShare = 0.4F;
constexpr float kNearerShare = 0.7F;

float depth_of_pixel(const DepthImage& depth, const GrayImage& image, const Eigen::Vector2d& at) {
  return depth(static_cast<int>(at.x()) * depth.width() / image.width(),
               static_cast<int>(at.y()) * depth.height() / image.height());
}

// Standard deviation of the grey levels at a patch's old position.
float contrast_at(const GrayImage& image, const Eigen::Vector2d& at) {
  float sum = 0, squares = 0;
  for (int dy = -PatchTemplate::kReach; dy < PatchTemplate::kReach; ++dy) {
    const std::uint8_t* row =
        image.row(static_cast<int>(at.y()) + dy) + static_cast<int>(at.x()) - PatchTemplate::kReach;
    for (int x = 0; x < PatchTemplate::kSide; ++x) {
      const auto value = static_cast<float>(row[x]);
      sum += value;
      squares += value * value;
    }
  }
  const float mean = sum / PatchTemplate::kPixels;
  return std::sqrt(std::max(squares / PatchTemplate::kPixels - mean * mean, 0.0F));
}

bool is_moving(const MaskImage* mask, const GrayImage& image, const Eigen::Vector2d& at) {
  if (mask == nullptr || mask->empty()) return false;
  const int x = static_cast<int>(at.x()) * mask->width() / image.width();
  const int y = static_cast<int>(at.y()) * mask->height() / image.height();
  return (*mask)(x, y) != 0;
}

}  // namespace

std::optional<StillWatch::Patch> StillWatch::patch_at(const Pyramid& pyramid,
                                                      const Eigen::Vector2d& at) {
  Patch patch;
  patch.at = at.array().floor();
  if (!patch.look.warp(PatchSource::cut(pyramid, patch.at), 0, Eigen::Matrix2d::Identity(),
                       Eigen::Vector2d::Zero())) {
    return std::nullopt;
  }
  patch.follows = patch.look.contrast / std::sqrt(std::max(patch.look.h_xx, patch.look.h_yy));
  const double noise = kNoise / static_cast<double>(patch.look.contrast);
  patch.least_likeness = kLikenessShare / (1 + noise * noise);
  return patch;
}

// Whether a patch that was not found is hidden by something or in the dark. An unknown depth counts
// as hidden, because a sensor measures no depth of things that are too close.
bool StillWatch::is_hidden(const Patch& patch, const GrayImage& image, const DepthImage& depth) {
  if (contrast_at(image, patch.at) < kFadedShare * patch.look.contrast) return true;
  const float now = depth_of_pixel(depth, image, patch.at);
  return !std::isnan(patch.depth) && !(now >= kNearerShare * patch.depth);
}

void StillWatch::begin(const GrayImage& image, const DepthImage& depth) {
  patches_.clear();
  const int cell_x = image.width() / kAcross;
  const int cell_y = image.height() / kDown;
  Pyramid pyramid;
  pyramid.build(image);
  for (int cy = 0; cy < kDown; ++cy) {
    for (int cx = 0; cx < kAcross; ++cx) {
      // The position in the cell with the strongest texture.
      std::optional<Patch> best;
      for (int k = 0; k < kTries * kTries; ++k) {
        const std::optional<Patch> patch =
            patch_at(pyramid, {cx * cell_x + (k % kTries + 0.5) * cell_x / kTries,
                               cy * cell_y + (k / kTries + 0.5) * cell_y / kTries});
        if (patch && (!best || patch->follows > best->follows)) best = patch;
      }
      if (best) patches_.push_back(*best);
    }
  }
  if (patches_.size() < kPatches) fill_up(pyramid, image);
  for (Patch& patch : patches_) patch.depth = depth_of_pixel(depth, image, patch.at);
}

// A bare room has texture in few cells, and perhaps not at the positions tried. This adds the
// patches of the whole picture with the strongest texture that do not overlap.
void StillWatch::fill_up(const Pyramid& pyramid, const GrayImage& image) {
  std::vector<Patch> others;
  constexpr int kPatchSide = PatchTemplate::kSide;
  for (int y = kPatchSide; y < image.height() - kPatchSide; y += kPatchSide) {
    for (int x = kPatchSide; x < image.width() - kPatchSide; x += kPatchSide) {
      const std::optional<Patch> patch = patch_at(pyramid, {x, y});
      if (patch && static_cast<double>(patch->look.contrast) > kNoise) others.push_back(*patch);
    }
  }
  std::stable_sort(others.begin(), others.end(),
                   [](const Patch& a, const Patch& b) { return a.follows > b.follows; });
  for (const Patch& other : others) {
    if (patches_.size() == kPatches) return;
    const bool apart = std::none_of(patches_.begin(), patches_.end(), [&](const Patch& patch) {
      return (patch.at - other.at).cwiseAbs().maxCoeff() < kPatchSide;
    });
    if (apart) patches_.push_back(other);
  }
}

Stillness StillWatch::look(const GrayImage& image, const DepthImage& depth,
                           const MaskImage* moving) const {
  const Eigen::Vector2d middle(0.5 * (image.width() - 1), 0.5 * (image.height() - 1));
  std::array<double, kPatches> dx{}, dy{}, outwards{}, around{};
  std::size_t compared = 0, resting = 0, others = 0;
  for (const Patch& patch : patches_) {
    if (is_moving(moving, image, patch.at)) continue;
    const PatchMatch match = follow(image, patch.look, patch.at, {.steps = 6, .farthest = 4});
    if (!match.found || match.likeness < patch.least_likeness) {
      others += is_hidden(patch, image, depth) ? 0 : 1;
      continue;
    }
    const Eigen::Vector2d moved = match.at - patch.at;
    const Eigen::Vector2d out = (patch.at - middle).normalized();
    dx[compared] = moved.x();
    dy[compared] = moved.y();
    outwards[compared] = out.dot(moved);
    around[compared] = out.x() * moved.y() - out.y() * moved.x();
    ++compared;
    resting += moved.cwiseAbs().maxCoeff() < kMoved ? 1 : 0;
  }
  const Stillness unclear = others >= kLeastPatches ? Stillness::kOtherView : Stillness::kUnclear;
  if (compared < kLeastPatches) return unclear;
  const double share = static_cast<double>(resting) / static_cast<double>(compared);
  const auto middle_of = [&](std::array<double, kPatches>& values) {
    return std::abs(upper_median(std::span(values).first(compared)));
  };
  // If the camera moves straight ahead or rolls, its patches move in all directions. The median of
  // dx and of dy is then near 0, but that of the radial or the tangential component is not.
  const double shift =
      std::max({middle_of(dx), middle_of(dy), middle_of(outwards), middle_of(around)});
  if (shift < kMoved && share > 0.5) return Stillness::kStill;
  if (compared < patches_.size() / 4) return unclear;
  return shift >= kMoved ? Stillness::kMoved : Stillness::kStill;
}

}  // namespace palpable
