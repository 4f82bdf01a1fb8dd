/// @file
/// The appearance of desk and room in a sequence. film/desk_scene.h builds them.
#pragma once

#include <cstdint>

namespace palpable {

struct DeskLook {
  std::uint64_t seed = 1;  ///< of textures and of the exact positions of things
  /// true: a room of 9 x 11 m with a corridor, so that surfaces are up to 15.5 m away; false: a
  /// wall directly behind the desk.
  bool room = true;
  bool left_free = false;     ///< no books and mug at the left, for a left hand
  bool bare = false;          ///< nothing on desk and walls, and no textures
  double skin_texture = 1.0;  ///< contrast of the skin, ratio to that of a real hand
  double skin_gloss = 0.20;   ///< strength of the highlight on skin
};

}  // namespace palpable
