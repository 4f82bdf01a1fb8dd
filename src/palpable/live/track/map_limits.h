/// @file
/// How much a tracker remembers.
#pragma once

namespace palpable {

/// Some 60 MB with the values given here.
struct MapLimits {
  int keyframes = 600;     ///< 20 kB each, and 56 bytes per landmark seen in it
  int landmarks = 12'000;  ///< 3.4 kB each
};

}  // namespace palpable
