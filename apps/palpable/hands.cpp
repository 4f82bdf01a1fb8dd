// palpable hands: a hands file from a table of joints or from a synthetic film.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/live/play/hands_conversion.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
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

std::vector<ThingsLine> lines_of(const HandsOptions& options) {
  if (std::filesystem::is_directory(options.input)) {
    return read_clip_things(options.input, options.body);
  }
  JointsTable table;
  if (!options.joints.empty()) table.layout = hand_layout_named(options.joints);
  table.side = hand_side_named(options.side).value_or(HandSide::kRight);
  table.metres = length_unit(options.unit).value_or(1);
  table.seconds = kTimeUnits.at(options.time_unit);
  table.has_y_up = options.up == "y";
  return read_joints_table(options.input, table);
}

void convert(const HandsOptions& options) {
  const HandsText made = hands_text(lines_of(options));
  write_whole_file(options.out, made.text);
  if (options.json) {
    print_json({{"out", options.out.string()},
                {"lines", made.lines},
                {"lines_with_things", made.pressing},
                {"seconds", made.seconds}});
    return;
  }
  print_text("{}: {} lines over {:.3g} s, {} of them with things that may press\n",
             options.out.string(), made.lines, made.seconds, made.pressing);
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
  command.add_option("-o,--out", options->out, "Hands file to write, a .jsonl").required();
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
