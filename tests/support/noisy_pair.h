/// @file
/// A pair of images for tests that compare two stereo matchers bit by bit.
#pragma once

#include "palpable/common/geometry/image.h"
#include "tests/support/test.h"

#include <cstdint>

namespace palpable::test {

struct NoisyPair {
  GrayImage left;
  GrayImage right;
};

/// Random brightness, shifted by a disparity that grows along x, with noise, so that all paths of a
/// matcher have steps, jumps and ties.
inline NoisyPair noisy_pair(int width, int height, unsigned seed) {
  auto random = random_case(seed);
  NoisyPair pair{GrayImage(width, height), GrayImage(width, height)};
  for (std::uint8_t& p : pair.left) p = static_cast<std::uint8_t>(random() % 24 + 100);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      pair.right(x, y) =
          static_cast<std::uint8_t>(pair.left((x + 5 + x / 9) % width, y) + random() % 3);
    }
  }
  return pair;
}

}  // namespace palpable::test
