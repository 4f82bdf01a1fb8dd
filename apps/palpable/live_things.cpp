#include "apps/palpable/live_things.h"

#include "apps/palpable/live_settings.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/play/live_set_up.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthestBody = 100;  // m

constexpr std::array<std::string_view, 22> kThingsOptions{
    "source",   "place",     "scale",        "set",           "contact", "friction",
    "dynamics", "frames",    "paced",        "threads",       "out",     "overwrite",
    "events",   "serve",     "write",        "stats",         "window",  "colors",
    "opaque",   "no-window", "print-config", "frame-pictures"};
constexpr std::array<std::string_view, 4> kCameraFiles{"depth", "masks", "stills", "film"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The words of --write: what needs a camera cannot be asked for, but may be left out. Lines that
// programs send have no film, which would slow them.
void refuse_camera_files(const std::vector<std::string>& words, const std::string& source) {
  const bool has_film = source != kSocketSource;
  for (const std::string& list : words) {
    std::string_view rest = list;
    while (!rest.empty()) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      std::string_view word = rest.substr(0, comma);
      rest.remove_prefix(std::min(comma + 1, rest.size()));
      if (word.starts_with('+')) word.remove_prefix(1);
      if (!is_among(kCameraFiles, word) || (has_film && word == "film")) continue;
      throw Error(fmt::format("--write {}: is not there with --source {}; write {}", word, source,
                              has_film ? "film, data or meshes" : "data or meshes"));
    }
  }
}

// x y z (m) and roll, pitch, yaw (degrees, about the world's X, then Y, then Z), or 16 numbers.
Rigid3 world_from_body_of(const std::vector<std::string>& words) {
  const auto numbers = to_numbers(fmt::format("{}", fmt::join(words, " ")));
  if (!numbers || (numbers->size() != 6 && numbers->size() != 16)) {
    throw Error(fmt::format(
        "--place {}: write six numbers, \"x y z roll pitch yaw\" (m; degrees about X, Y, Z), in "
        "the "
        "coordinates of the lines, or the 16 of a 4 x 4 matrix, world_from_body row by row",
        fmt::join(words, " ")));
  }
  const std::vector<double>& n = *numbers;
  Rigid3 pose = Rigid3::Identity();
  if (n.size() == 6) {
    constexpr double kDegree = std::numbers::pi / 180;
    pose.linear() = (Eigen::AngleAxisd(n[5] * kDegree, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(n[4] * kDegree, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(n[3] * kDegree, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  } else {
    const RigidRows rows = rigid_of_rows(n);
    if (!rows.is_rigid) {
      throw Error("--place: the 16 numbers are no rigid motion, world_from_body row by row (m)");
    }
    pose = rows.pose;
  }
  if (!(pose.translation().norm() <= kFarthestBody)) {
    throw Error(fmt::format("--place: the body would stand {:.3g} m away; places are in metres",
                            pose.translation().norm()));
  }
  return pose;
}

}  // namespace

bool is_things_source(const std::string& source) {
  return source == kSocketSource || fs::path(source).extension() == ".jsonl";
}

void refuse_table_source(const std::string& source) {
  fs::path file = source;
  if (file.extension() != ".csv" && file.extension() != ".tsv") return;
  file.replace_extension(".jsonl");
  throw Error(
      fmt::format("--source {0}: is a table, which is not played; of the joints of hands `palpable "
                  "hands {0} -o {1}` makes a hands file, and --source {1} plays it (docs/hands.md)",
                  source, file.string()));
}

void refuse_camera_options(const LiveOptions& options, const PlayOptions& play,
                           const std::vector<Command::GivenOption>& given) {
  const std::string& source = options.input.source;
  for (const Command::GivenOption& option : given) {
    if (option.name == "json" || is_among(kThingsOptions, option.name)) {
      if (option.name == "write") refuse_camera_files(option.words, source);
      continue;
    }
    if (option.name == "record") {
      throw Error(
          fmt::format("--record: {}", source == kSocketSource
                                          ? "keep the lines that you send in a hands file, which "
                                            "--source plays again; leave --record out"
                                          : source + " is the recording already: --source plays "
                                                     "it again; leave --record out"));
    }
    throw Error(fmt::format("--{0}: there is no camera with --source {1}; leave --{0} out",
                            option.name, source));
  }
  if (source == kSocketSource) {
    if (play.events == kNoEvents) {
      throw Error(
          "--source socket: name the address to which programs connect, such as --events "
          "unix:touch.sock");
    }
    if (options.paced)
      throw Error(
          "--paced: has no effect on a socket, whose lines are played as they arrive; leave it "
          "out");
  }
  if (!options.run.contact.empty() && options.run.contact != "anywhere") {
    throw Error(
        fmt::format("--contact {}: needs a camera; leave it out, then bodies are pressed anywhere",
                    options.run.contact));
  }
}

ThingsSetUp set_up_things(const LiveOptions& options) {
  ThingsSetUp setup;
  setup.bodies = wanted_bodies(options);
  setup.source = options.input.source;
  setup.scene = options.scene;
  setup.paced = options.paced;
  setup.dynamics = options.run.dynamics.value_or(true);
  const Rigid3 world_from_scene =
      options.place.empty() ? Rigid3::Identity() : world_from_body_of(options.place);
  const std::vector<Rigid3> scene_from_body = scene_from_bodies(setup.bodies);
  for (std::size_t k = 0; k < setup.bodies.size(); ++k) {
    const DescribedBody& body = setup.bodies[k];
    if (!options.scene.empty()) expect_baked(body, options.scene);
    setup.standing.push_back({read_live_body(body, options.run.contact, options.run.friction),
                              world_from_scene * scene_from_body[k],
                              options.scene.empty() ? "" : body.name, body.color});
  }
  return setup;
}

}  // namespace palpable::app
