#include "palpable/desk/film/desk_programs.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

std::span<const ShaderFile> film_shader_files();

namespace {

// What desk.vert and desk.frag are compiled with for one kind of surface. `detail`: nails and
// creases of a hand.
struct Surface {
  bool top = false, far = false, moves = false, detail = false, dark = false;
  bool still_shadows = false, moving_shadows = false;
};

// In the order of the members of PaintPrograms.
constexpr std::array<Surface, 10> kSurfaces{{
    {.far = true},
    {.still_shadows = true},
    {.still_shadows = true, .moving_shadows = true},
    {.top = true, .still_shadows = true},
    {.top = true, .still_shadows = true, .moving_shadows = true},
    {.moves = true, .moving_shadows = true},
    {.moves = true, .detail = true, .moving_shadows = true},
    {.moves = true, .still_shadows = true, .moving_shadows = true},
    {.moves = true, .detail = true, .still_shadows = true, .moving_shadows = true},
    {.moves = true, .dark = true},
}};

std::string defines_of(const Surface& s) {
  std::string text;
  const std::array<std::pair<bool, const char*>, 7> features{
      {{s.top, "DESK_TOP"},
       {s.far, "FAR"},
       {s.moves, "MOVES"},
       {s.detail, "DETAIL"},
       {s.dark, "DARK"},
       {s.still_shadows, "STILL_SHADOWS"},
       {s.moving_shadows, "MOVING_SHADOWS"}}};
  for (const auto& [on, name] : features) {
    if (on) text += std::string("#define ") + name + "\n";
  }
  return text;
}

}  // namespace

Result<DeskPrograms> DeskPrograms::make() {
  std::array<std::string, kSurfaces.size()> defines;
  std::transform(kSurfaces.begin(), kSurfaces.end(), defines.begin(), defines_of);
  std::vector<ProgramSource> sources{{"shadow.vert", "shadow.frag"},
                                     {"depth.vert", "depth.frag"},
                                     {"sensor.vert", "desk_top.frag"}};
  for (const std::string& of : defines) sources.push_back({"desk.vert", "desk.frag", of});
  for (const char* of :
       {"", "#define ROWS\n", "#define EXPOSED\n", "#define EXPOSED\n#define TURNS\n",
        "#define EXPOSED\n#define LAYERS\n", "#define EXPOSED\n#define LAYERS\n#define TURNS\n"}) {
    sources.push_back({"sensor.vert", "sensor.frag", of});
  }
  Result<std::vector<GlProgram>> made = make_programs(film_shader_files(), sources);
  if (!made.ok()) return made.problem();
  std::vector<GlProgram> programs = std::move(made).value();
  // The members of a braced list are initialised in order, which is the order of `sources`.
  std::size_t used = 0, painted = 0;
  const auto next = [&]() -> GlProgram { return std::move(programs[used++]); };
  const auto paint = [&]() -> Paint {
    const Surface& s = kSurfaces[painted++];
    return {next(), s.far, s.moves, !s.dark, s.still_shadows, s.moving_shadows};
  };
  return DeskPrograms{
      .paint = {.shade = next(),
                .measure = next(),
                .light_top = next(),
                .far = paint(),
                .still = paint(),
                .all = paint(),
                .still_top = paint(),
                .all_top = paint(),
                .mover = {{paint(), paint()}},
                .mover_in_shade = {{paint(), paint()}},
                .mover_dark = paint()},
      .sensor = {
          .sharp = next(), .rows = next(), .exposed = {{{next(), next()}, {next(), next()}}}}};
}

}  // namespace palpable
