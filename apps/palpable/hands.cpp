// palpable hands: a hands file from a table of joints or from a synthetic film.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/live/play/hands_conversion.h"

#include <Eigen/Core>
#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct HandsOptions {
  std::filesystem::path input, out;
  std::string body;
  std::string joints;
  std::string side = "right";
  std::string unit = "m";
  std::string time_unit = "s";
  std::string up = "z";
  bool json = false;
};

const std::map<std::string, double> kTimeUnits{{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};

std::vector<std::string> time_unit_names() { return {"s", "ms", "us", "ns"}; }

JointsTable table_of(const HandsOptions& options) {
  JointsTable table;
  if (!options.joints.empty()) table.layout = hand_layout_named(options.joints);
  table.side = hand_side_named(options.side).value_or(HandSide::kRight);
  table.metres = length_unit(options.unit).value_or(1);
  table.seconds = kTimeUnits.at(options.time_unit);
  table.has_y_up = options.up == "y";
  return table;
}

const char* sides_of(const JointsFound& found) {
  if (found.has_left && found.has_right) return "left and right hand";
  return found.has_left ? "left hand" : "right hand";
}

// "openxr (26 joints with radii, as the columns say), right hand; coordinates in mm, times in ms,
// Y up".
std::string text_of_found(const JointsFound& found, const HandsOptions& options) {
  if (!found.has_left && !found.has_right) return "no hand in any row";
  return fmt::format("{} ({} joints {} radii{}), {}; coordinates in {}, times in {}, {} up",
                     name_of(found.layout), joint_count(found.layout),
                     found.has_radii ? "with" : "without",
                     found.is_counted ? ", by the number of columns" : "", sides_of(found),
                     options.unit, options.time_unit, options.up == "y" ? "Y" : "Z");
}

Json json_of_point(const Eigen::Vector3d& x) { return Json{x.x(), x.y(), x.z()}; }

void convert(const HandsOptions& options) {
  guard_output_file(options.out, {options.input});
  require_ending(options.out, {".jsonl"}, "a hands file");
  guard_format(options.out, FileFormat::kHands);
  std::optional<JointsFound> found;
  std::vector<ThingsLine> lines;
  const JointsTable table = table_of(options);
  if (std::filesystem::is_directory(options.input)) {
    lines = read_clip_things(options.input, options.body);
  } else {
    JointsRead read = read_joints_table(options.input, table);
    lines = std::move(read.lines);
    found = std::move(read.found);
  }
  const HandsText made = hands_text(lines);
  std::vector<std::string> warnings;
  if (found) warnings = joints_warnings(made, table, *found);
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
  write_whole_file(options.out, made.text);
  if (options.json) {
    Json told{{"out", options.out.string()},
              {"lines", made.lines},
              {"lines_with_things", made.pressing},
              {"seconds", made.seconds},
              {"step_s", made.step}};
    if (found && (found->has_left || found->has_right)) {
      told["joints"] = std::string(name_of(found->layout));
      told["radii"] = found->has_radii;
      told["left"] = found->has_left;
      told["right"] = found->has_right;
    }
    if (!made.box.isEmpty()) {
      told["low_m"] = json_of_point(made.box.min());
      told["high_m"] = json_of_point(made.box.max());
    }
    print_json(told);
    return;
  }
  print_text("{}: {} lines over {:.3g} s, {} of them with things that may press\n",
             options.out.string(), made.lines, made.seconds, made.pressing);
  if (found) print_text("joints: {}\n", text_of_found(*found, options));
  if (made.box.isEmpty()) return;
  const Eigen::Vector3d &low = made.box.min(), &high = made.box.max();
  print_text("they are within X {:.2f} to {:.2f}, Y {:.2f} to {:.2f}, Z {:.2f} to {:.2f} m, Z up\n",
             low.x(), high.x(), low.y(), high.y(), low.z(), high.z());
}

}  // namespace

void add_hands(Command app) {
  auto options = std::make_shared<HandsOptions>();
  Command command =
      app.add_subcommand("hands", "Make a hands file from a table of joints or a synthetic film");
  command
      .add_option(
          "input", options->input,
          "A table of a hand tracker's joints (.csv), or a folder that palpable synth wrote")
      .required()
      .existing_path();
  command.add_option("-o,--out", options->out, "Hands file to write")
      .type_name("FILE.jsonl")
      .required();
  command.add_json(options->json);
  command.begin_group("Of a table of joints");
  command
      .add_option("--joints", options->joints,
                  "Whose joints these are, in which order (docs/hands.md)")
      .one_of({"openxr", "webxr", "mediapipe"})
      .default_is("as many columns as there are say it");
  command.add_option("--side", options->side, "Which hand it is, in rows that do not say it")
      .one_of({"left", "right"})
      .show_default();
  command.add_option("--unit", options->unit, "Unit of the coordinates")
      .one_of(length_unit_names())
      .show_default();
  command.add_option("--time-unit", options->time_unit, "Unit of the times")
      .one_of(time_unit_names())
      .show_default();
  command
      .add_option("--up", options->up,
                  "The axis that points up in the table. Hands files have Z up, OpenXR and WebXR Y")
      .one_of({"z", "y"})
      .show_default();
  command.begin_group("Of a film");
  command
      .add_option("--body-name", options->body,
                  "In whose coordinates, by its name, if the film has several bodies")
      .type_name("NAME")
      .default_is("the only one");
  command.footer(
      "A row of a table is one hand at one time: the time, left or right if you have it, and x y z "
      "of each joint, or x y z and radius. Rows of one time are one line of the hands file. A hand "
      "that is lost has empty cells, nan, or no row.\n"
      "The hand of a film stands in the coordinates of the body, so that palpable live needs no "
      "--place.\n"
      "Example: palpable hands joints.csv --up y -o hands.jsonl\n"
      "Example: palpable live post --source hands.jsonl --out out");
  command.callback([options] { convert(*options); });
}

}  // namespace palpable::app
