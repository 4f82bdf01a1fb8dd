/// @file
/// Limits of the size of a tracker's map.
#pragma once

namespace palpable {

/// The default values need about 60 MB.
struct MapLimits {
  int keyframes = 600;     ///< 20 kB each, and 56 bytes per landmark seen in it
  int landmarks = 12'000;  ///< 3.4 kB each
};

}  // namespace palpable
