/// @file
/// What presses in one frame, as a line of JSON: capsules, or the joints of hands. A hands file has
/// such lines, and programs send them to a run (docs/hands.md):
///
///     {"time":0.033,"things":[{"id":1,"capsules":[[ax,ay,az,bx,by,bz,ra,rb],...]},
///      {"id":2,"friction":0.3,"hand":"openxr","side":"left","joints":[[x,y,z],...],"radii":[...]}]}
///      (one line)
///
/// "friction" is Coulomb's coefficient between the thing and the skins; without it that of each
/// body counts. s and m, in the frame in which the bodies are placed (world). Keys that are not
/// known are ignored.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/live/things/pressed_bodies.h"
#include "palpable/live/things/thing_limits.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Of one line, in bytes; what is in it has the limits of things/thing_limits.h.
inline constexpr std::size_t kLongestThingsLine = std::size_t{1} << 20;

struct ThingsLine {
  struct Thing {
    std::int64_t id = 0;
    std::size_t first = 0, count = 0;  ///< of `capsules`
    float friction = kFrictionOfBody;  ///< CapsuleThing::friction
  };
  double time = 0;                ///< s
  std::vector<Thing> things;      ///< whose ids differ
  std::vector<Capsule> capsules;  ///< m, world frame; those of the first thing first
  bool wants_vertices = false;    ///< "want":["vertices"]: whoever sent it asks for them
};

/// Reads one line, without its line end. Throws nothing. The problem names neither file nor line:
/// it says which thing and which of its capsules or joints is wrong, the limit, and what to do.
/// @param after  s, the time of the line before, which this one's must exceed; nothing: the first
[[nodiscard]] Result<ThingsLine> read_things_line(std::string_view text,
                                                  std::optional<double> after = {});

/// One line with its line end, which read_things_line() reads. Numbers have 6 digits after the
/// point (micrometres, microseconds).
[[nodiscard]] std::string things_line(const ThingsLine& line);

/// The things of a line for PressedBodies::advance(). They point into `line`.
/// @param things  overwritten
void things_in(const ThingsLine& line, std::vector<CapsuleThing>& things);

}  // namespace palpable
