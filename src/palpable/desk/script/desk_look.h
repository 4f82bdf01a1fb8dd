/// @file
/// Which desk in which room a sequence is filmed at. film/desk_scene.h builds it.
#pragma once

#include <cstdint>

namespace palpable {

struct DeskLook {
  std::uint64_t seed = 1;  ///< of textures, and of where exactly things stand
  /// true: a room of 9 x 11 m with a corridor behind it, so that surfaces lie up to 15.5 m away;
  /// false: a wall right behind the desk.
  bool room = true;
  bool left_free = false;     ///< no books and mug left of the body: a left hand comes from there
  bool bare = false;          ///< nothing on the desk or the walls, no texture anywhere
  double skin_texture = 1.0;  ///< contrast of the skin's blotches and lines; 1 is a real hand's
  double skin_gloss = 0.20;   ///< strength of the highlight on skin
};

}  // namespace palpable
