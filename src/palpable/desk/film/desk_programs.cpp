#include "palpable/desk/film/desk_programs.h"

#include <span>
#include <utility>
#include <vector>

namespace palpable {

std::span<const ShaderFile> film_shader_files();

Result<DeskPrograms> DeskPrograms::make() {
  constexpr const char* kFar = "#define FAR\n";
  constexpr const char* kStill = "#define STILL_SHADOWS\n";
  constexpr const char* kAll = "#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kStillTop = "#define DESK_TOP\n#define STILL_SHADOWS\n";
  constexpr const char* kAllTop =
      "#define DESK_TOP\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kMover = "#define MOVES\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverDetail = "#define MOVES\n#define DETAIL\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverInShade =
      "#define MOVES\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr const char* kMoverDetailInShade =
      "#define MOVES\n#define DETAIL\n#define STILL_SHADOWS\n#define MOVING_SHADOWS\n";
  constexpr std::array<ProgramSource, 19> kSources = {
      {{"shadow.vert", "shadow.frag"},
       {"depth.vert", "depth.frag"},
       {"sensor.vert", "desk_top.frag"},
       {"desk.vert", "desk.frag", kFar},
       {"desk.vert", "desk.frag", kStill},
       {"desk.vert", "desk.frag", kAll},
       {"desk.vert", "desk.frag", kStillTop},
       {"desk.vert", "desk.frag", kAllTop},
       {"desk.vert", "desk.frag", kMover},
       {"desk.vert", "desk.frag", kMoverDetail},
       {"desk.vert", "desk.frag", kMoverInShade},
       {"desk.vert", "desk.frag", kMoverDetailInShade},
       {"desk.vert", "desk.frag", "#define MOVES\n#define DARK\n"},
       {"sensor.vert", "sensor.frag"},
       {"sensor.vert", "sensor.frag", "#define ROWS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define TURNS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define LAYERS\n"},
       {"sensor.vert", "sensor.frag", "#define EXPOSED\n#define LAYERS\n#define TURNS\n"}}};
  Result<std::vector<GlProgram>> made = make_programs(film_shader_files(), kSources);
  if (!made.ok()) return made.problem();
  std::vector<GlProgram> programs = std::move(made).value();
  // The members of a braced list are initialised in order, which is the order of kSources.
  std::size_t used = 0;
  const auto next = [&]() -> GlProgram { return std::move(programs[used++]); };
  return DeskPrograms{
      .paint = {.shade = next(),
                .measure = next(),
                .light_top = next(),
                .far = {.program = next(), .far = true},
                .still = {.program = next(), .still_shadows = true},
                .all = {.program = next(), .still_shadows = true, .moving_shadows = true},
                .still_top = {.program = next(), .still_shadows = true},
                .all_top = {.program = next(), .still_shadows = true, .moving_shadows = true},
                .mover = {{{.program = next(), .moves = true, .moving_shadows = true},
                           {.program = next(), .moves = true, .moving_shadows = true}}},
                .mover_in_shade = {{{.program = next(),
                                     .moves = true,
                                     .still_shadows = true,
                                     .moving_shadows = true},
                                    {.program = next(),
                                     .moves = true,
                                     .still_shadows = true,
                                     .moving_shadows = true}}},
                .mover_dark = {.program = next(), .moves = true, .sun = false}},
      .sensor = {
          .sharp = next(), .rows = next(), .exposed = {{{next(), next()}, {next(), next()}}}}};
}

}  // namespace palpable
