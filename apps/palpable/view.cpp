// palpable view: shows a body in a window, where the mouse turns and presses it, or writes pictures
// of it to a folder.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "apps/palpable/shared_options.h"
#include "apps/palpable/terminal.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/picture_file.h"
#include "palpable/live/render/window.h"
#include "palpable/live/view/body_pictures.h"
#include "palpable/live/view/body_window.h"
#include "palpable/live/view/mode_shapes.h"
#include "palpable/live/view/painted_stress.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  fs::path body;
  fs::path out;
  int site = -1;  // -1: not given
  double level = 1.0;
  std::string load;  // X,Y,Z=F, in place of site and level
  int modes = 0;     // > 0: number of modes to draw in place of presses
  std::string modes_of = "displacement";
  std::string paint = "stress";
  std::string colors = kColorScaleNames[0];
  std::vector<std::string> set;  // NAME=VALUE
  std::string size = "1280x720";
  double close_after = 0;  // s; 0: the user closes the window
};

PictureSize read_size(const std::string& text) {
  const auto sides = parse_extent(text).value_or(std::array{0, 0});
  if (*std::min_element(sides.begin(), sides.end()) < 64 ||
      *std::max_element(sides.begin(), sides.end()) > 8192) {
    throw Error(
        fmt::format("--size {}: wants WIDTHxHEIGHT from 64 to 8192, for example 1280x720", text));
  }
  PictureSize size;
  size.width = sides[0];
  size.height = sides[1];
  return size;
}

void write_picture(const fs::path& body, const fs::path& folder, const std::string& name,
                   const ColorImage& picture) {
  const fs::path file = folder / (name + ".png");
  guard_output_file(file, {body});
  write_png(file, picture);
  print_text("{}\n", file.string());
  std::fflush(stdout);  // at once also for a pipe: the window may stay open for long
}

void write_pictures(const ReducedBody& body, const ViewOptions& options, PictureSize size,
                    const fs::path& folder) {
  make_folder(folder);
  const GlContext context = value_or_throw(GlContext::offscreen());
  draw_presses(body, options.site, options.level, paint_named(options.paint),
               value_named<ColorScale>(options.colors, kColorScaleNames), size,
               [&](const std::string& name, const ColorImage& picture) {
                 write_picture(options.body, folder, name, picture);
               });
  context.errors().throw_if_any();
}

void write_modes(const ReducedBody& body, const ViewOptions& options, PictureSize size,
                 const fs::path& folder) {
  const std::vector<ModeShape> shapes = value_or_throw(
      first_modes(body, options.modes,
                  options.modes_of == "stress" ? ModeField::kStress : ModeField::kDisplacement));
  make_folder(folder);
  const GlContext context = value_or_throw(GlContext::offscreen());
  write_picture(options.body, folder, "modes", draw_modes(body, shapes, size));
  context.errors().throw_if_any();
}

void show_window(Window& window, const std::shared_ptr<const TouchableBody>& body,
                 const ViewOptions& options, PictureSize size) {
  show_body(window, body,
            {.size = size,
             .site = options.site,
             .level = options.level,
             .paint = paint_named(options.paint),
             .colors = value_named<ColorScale>(options.colors, kColorScaleNames),
             .close_after = options.close_after},
            [&](const ColorImage& picture) { return keep_picture(options.body, "view", picture); });
}

// Converts --load to --site and --level.
void settle_load(const ReducedBody& body, ViewOptions& options) {
  const PlacedLoad load = parse_loads(body, {options.load})[0];
  if (load.place >= static_cast<int>(body.sites.size())) {
    throw Error(fmt::format(
        "--load {}: there the body may only be pushed back, beside a press; pictures show one "
        "press (numbers of both: palpable press)",
        options.load));
  }
  options.site = load.place;
  options.level = load.level;
}

void run_view(ViewOptions options) {
  const PictureSize size = read_size(options.size);
  require_folder_name(options.out);
  const auto touchable = std::make_shared<const TouchableBody>(
      value_or_throw(read_pressable_touchable_body(options.body, parse_settings(options.set))));
  const ReducedBody& body = touchable->body;
  if (!options.load.empty()) settle_load(body, options);
  const int site_count = static_cast<int>(body.sites.size());
  if (options.site >= site_count) {
    throw Error(fmt::format("--site {}: {} has the sites 0 to {}", options.site,
                            options.body.string(), site_count - 1));
  }
  // In pictures the body is pressed at its sites, which has no contact pressure.
  const bool anywhere = touchable->touch.has_value();
  expect_paintable(options.paint, knows_stress(body) || anywhere, anywhere && options.out.empty(),
                   options.body);
  if (options.modes > 0) {
    write_modes(
        body, options, size,
        options.out.empty() ? fs::path(options.body.stem().string() + "_view") : options.out);
    return;
  }
  if (!options.out.empty()) {
    write_pictures(body, options, size, options.out);
    return;
  }
  Result<Window> window =
      Window::open(fmt::format("{} - Palpable", body.name), size.width, size.height);
  if (window.ok()) {
    show_window(window.value(), touchable, options, size);
    return;
  }
  const fs::path folder = options.body.stem().string() + "_view";
  print_note("{}; pictures go to {} instead", window.problem().message, folder.string());
  write_pictures(body, options, size, folder);
}

void add_press_options(Command command, ViewOptions& options) {
  command.begin_group("Press");
  command.add_option("--site", options.site, "Press this site, from 0")
      .not_negative()
      .default_is("none; pictures show several");
  command.add_option("--level", options.level, "How hard, as a share of the site's full load")
      .in_range(0.0, 1.0)
      .show_default();
  command
      .add_option("--load", options.load,
                  "Press the site at this point of the skin (m, body frame, at rest) with this "
                  "force (N)")
      .type_name("X,Y,Z=F")
      .excludes("--site")
      .excludes("--level");
  add_set_option(command, options.set);
  command.begin_group("Modes");
  command
      .add_option("--modes", options.modes,
                  "Instead of presses: draw the first modes, this many, and their functions of "
                  "where the load is, as modes.png in the folder of --out")
      .in_range(1, 16)
      .excludes("--site")
      .excludes("--level")
      .excludes("--load");
  command.add_option("--modes-of", options.modes_of, "Whose modes --modes draws")
      .one_of({"displacement", "stress"})
      .show_default();
}

void add_picture_options(Command command, ViewOptions& options) {
  command.begin_group("Display");
  add_paint_options(command, options.paint, options.colors);
  command.add_option("--size", options.size, "Pixels of window and pictures")
      .type_name("WIDTHxHEIGHT")
      .show_default();
  command
      .add_option("-o,--out", options.out,
                  "Write pictures into this folder instead of opening a window")
      .type_name("DIR")
      .default_is("none: a window; NAME_view for --modes and without a display");
  command
      .add_option("--close-after", options.close_after, "Close the window after this many seconds")
      .type_name("SECONDS")
      .positive()
      .default_is("never");
}

}  // namespace

void add_view(Command app) {
  auto options = std::make_shared<ViewOptions>();
  Command view = app.add_subcommand("view", "Turn a body and press it with the mouse");
  view.add_option("body", options->body,
                  "Body file (.palpable), or the name of an installed one (post)")
      .required();
  add_press_options(view, *options);
  add_picture_options(view, *options);
  view.footer(
      "In the window: hold or drag the left button on the body to press it, anywhere, as a finger "
      "of 8 mm radius would (a body without tables of touch: at the nearest site); drag beside it "
      "to "
      "turn it, zoom with the wheel. The panel and the keys switch: F what is painted, T the "
      "panel, S shows the sites, L the legend, H the help; R goes back to "
      "the start, P writes the picture to NAME_view_1.png (2, 3, ...) in this folder, Escape or Q "
      "ends.\n"
      "Without a display, pictures are written into the folder NAME_view.\n"
      "Example: palpable view bunny.palpable\n"
      "Example: palpable view bunny.palpable --out pictures --site 4 --level 0.8\n"
      "Example: palpable view beam.palpable --out pictures --modes 4");
  view.callback([options] {
    options->body = find_body(options->body);
    run_view(*options);
  });
}

}  // namespace palpable::app
