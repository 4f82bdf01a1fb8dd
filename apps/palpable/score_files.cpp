#include "apps/palpable/score_files.h"

#include "palpable/base/error.h"
#include "palpable/sources/image_file.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kMostFrames = 10'000'000;  // beyond it a number is a slip
constexpr double kSkew = 1e-3;           // of a rotation's columns, as written with few digits

// What is wrong with a line, without file and number: for_each_line adds them.
[[noreturn]] void refuse(const std::string& what) { throw Error(what); }

// nlohmann's texts begin with a name in brackets that is for programmers.
std::string without_brackets(std::string_view text) {
  const auto end = text.find("] ");
  return std::string(end == std::string_view::npos ? text : text.substr(end + 2));
}

template <class Take>
void for_each_line(const fs::path& path, Take take) {
  std::ifstream in(path);
  if (!in) throw Error(fmt::format("{}: cannot be read", path.string()));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    try {
      take(line);
    } catch (const json::parse_error& error) {
      throw Error(
          fmt::format("{}: line {}: no JSON at character {}", path.string(), number, error.byte));
    } catch (const json::exception& error) {
      throw Error(
          fmt::format("{}: line {}: {}", path.string(), number, without_brackets(error.what())));
    } catch (const Error& error) {
      throw Error(fmt::format("{}: line {}: {}", path.string(), number, error.what()));
    }
  }
}

template <class Take>
void for_each_object(const fs::path& path, Take take) {
  for_each_line(path, [&](const std::string& line) { take(json::parse(line)); });
}

// A frame's number: a whole one, for get<int>() would cut off what is not.
int frame_number(const json& value) {
  if (!value.is_integer()) refuse(fmt::format("{} is no frame's number", value.dump()));
  const auto frame = value.get<std::int64_t>();
  if (frame < 0 || frame >= kMostFrames) refuse(fmt::format("frame {} is no frame", frame));
  return static_cast<int>(frame);
}

int frame_of(const json& line) { return frame_number(line.at("frame")); }

// As frame_of, for files whose frames must come in order.
int next_frame_of(const json& line, int last) {
  const int frame = frame_of(line);
  if (frame <= last) refuse(fmt::format("frame {} comes after frame {}", frame, last));
  return frame;
}

Rigid3 rigid_of(const json& numbers) {
  const auto n = numbers.get<std::array<double, 16>>();
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(n.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double skew = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool last_row = matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
  if (!(skew <= kSkew) || R.determinant() < 0 || !last_row || !matrix.allFinite())
    refuse("the 16 numbers of camera_from_body are no rigid motion, row by row");
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

StampedPose pose_of(const std::string& line) {
  std::array<double, 8> n{};
  std::istringstream words(line);
  for (double& value : n) words >> value;
  std::string more;
  if (!words || words >> more ||
      !std::all_of(n.begin(), n.end(), [](double v) { return std::isfinite(v); })) {
    refuse("8 numbers are wanted: time tx ty tz qx qy qz qw");
  }
  const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
  if (!(std::abs(q.norm() - 1) < 0.01))
    refuse(fmt::format("the quaternion has length {:.4g}, not 1", q.norm()));
  StampedPose pose;
  pose.time = n[0];
  pose.world_from_camera =
      Eigen::Translation3d(n[1], n[2], n[3]) * Eigen::Quaterniond(q.normalized());
  return pose;
}

// The largest number of FOLDER/%06d.png, plus one; 0 without the folder.
int frames_in(const fs::path& folder) {
  int frames = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().stem().string();
    int number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size() && number < kMostFrames)
      frames = std::max(frames, number + 1);
  }
  return frames;
}

void read_camera(TruthFolder& truth) {
  const std::string path = (truth.folder / "camera.toml").string();
  try {
    const toml::table camera = toml::parse_file(path);
    const auto positive = [&](const char* key) {
      const toml::node* node = camera.get(key);
      const std::optional<double> value = node ? node->value<double>() : std::nullopt;
      if (!value || !std::isfinite(*value) || *value <= 0) {
        throw Error(node ? fmt::format("{}: line {}: {} must be a number above 0", path,
                                       node->source().begin.line, key)
                         : fmt::format("{}: has no {}", path, key));
      }
      return *value;
    };
    truth.depth_unit = positive("depth_unit_m");
    truth.frames_per_second = positive("fps");
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}: line {}: {}", path, error.source().begin.line,
                            std::string(error.description())));
  }
}

void read_contacts(const fs::path& path, TruthFolder& truth) {
  for_each_object(path, [&](const json& line) {
    const auto frame =
        static_cast<std::size_t>(next_frame_of(line, static_cast<int>(truth.contacts.size()) - 1));
    truth.contacts.resize(frame + 1);
    truth.contacts[frame] = {line.at("touching").get<bool>(), line.value("site", -1)};
  });
}

void read_hands(const fs::path& path, TruthFolder& truth) {
  int last = -1;
  for_each_object(path, [&](const json& line) {
    last = next_frame_of(line, last);
    std::vector<TrueCapsule> hand;
    for (const json& capsule : line.at("capsules")) {
      const auto v = capsule.get<std::array<double, 8>>();
      if (v[6] < 0 || v[7] < 0) refuse("a capsule's radius is negative");
      hand.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
    }
    if (!hand.empty()) truth.hands.emplace(last, std::move(hand));
  });
}

void read_rows(const fs::path& path, TruthFolder& truth) {
  for_each_object(path, [&](const json& line) {
    const int last = truth.rows.empty() ? -1 : truth.rows.back().frame;
    truth.rows.push_back({next_frame_of(line, last), line.at("row_offset_px").get<double>(),
                          line.value("step", false)});
  });
}

void read_live(const fs::path& path, ResultFolder& result) {
  std::ifstream in(path);
  try {
    const json live = json::parse(in);
    if (!live.is_object()) refuse("is no JSON object");
    if (live.contains("camera_from_body"))
      result.camera_from_body = rigid_of(live.at("camera_from_body"));
    if (!live.contains("processed")) return;
    std::vector<std::uint8_t> processed(result.processed.size(), 0);
    if (!live.at("processed").is_array()) refuse("processed is no list of frames");
    for (const json& value : live.at("processed")) {
      const auto frame = static_cast<std::size_t>(frame_number(value));
      if (frame < processed.size()) processed[frame] = 1;
    }
    if (std::count(processed.begin(), processed.end(), 1) == 0) {
      refuse("processed names no frame of the truth");
    }
    result.processed = std::move(processed);
  } catch (const json::parse_error& error) {
    throw Error(fmt::format("{}: no JSON at character {}", path.string(), error.byte));
  } catch (const json::exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), without_brackets(error.what())));
  } catch (const Error& error) { throw Error(fmt::format("{}: {}", path.string(), error.what())); }
}

std::map<int, FoundTouch> read_touches(const fs::path& path) {
  std::map<int, FoundTouch> touches;
  for_each_object(path, [&](const json& line) {
    FoundTouch touch;
    if (line.contains("site")) {
      if (!line.at("site").is_integer()) refuse("site is no whole number");
      touch.site = line.at("site").get<int>();
    }
    if (touch.site < -1) refuse(fmt::format("site {} is no site", touch.site));
    if (line.contains("level")) {
      if (!line.at("level").is_number()) refuse("level is no number");
      touch.level = line.at("level").get<double>();
      if (*touch.level < 0) refuse("level is negative: it is a share of the site's full load");
    }
    touches.emplace(frame_of(line), touch);  // of several the first
  });
  return touches;
}

std::map<int, Rigid3> read_poses(const fs::path& path) {
  std::map<int, Rigid3> poses;
  int last = -1;
  for_each_object(path, [&](const json& line) {
    last = next_frame_of(line, last);
    poses.emplace(last, rigid_of(line.at("camera_from_body")));
  });
  return poses;
}

std::vector<RowCorrection> read_corrections(const fs::path& path) {
  std::vector<RowCorrection> corrections;
  for_each_object(path, [&](const json& line) {
    const int last = corrections.empty() ? -1 : corrections.back().frame;
    corrections.push_back({next_frame_of(line, last), line.at("row_correction_px").get<double>()});
  });
  return corrections;
}

// Files of other names would silently count as missing. An empty folder is one of a run that found
// nothing. @throws Error
void expect_frames_in(const fs::path& folder, const char* ending) {
  if (!fs::is_directory(folder)) throw Error(fmt::format("{}: is no folder", folder.string()));
  std::string other;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const std::string stem = name.stem().string();
    if (name.extension() == ending && stem.size() == 6 &&
        stem.find_first_not_of("0123456789") == std::string::npos) {
      return;
    }
    if (stem.front() != '.' && (other.empty() || name.string() < other)) other = name.string();
  }
  if (!other.empty()) {
    throw Error(fmt::format("{}: {} is no frame's name: they are 000000{}, 000001{} and so on",
                            folder.string(), other, ending, ending));
  }
}

fs::path image_name(const fs::path& folder, const char* kind, int frame) {
  return folder / kind / fmt::format("{:06d}.png", frame);
}

}  // namespace

std::vector<StampedPose> read_trajectory(const fs::path& path) {
  std::vector<StampedPose> poses;
  for_each_line(path, [&](const std::string& line) {
    if (line.front() == '#') return;
    const StampedPose pose = pose_of(line);
    if (!poses.empty() && !(pose.time > poses.back().time))
      refuse(fmt::format("times must rise: {} s comes after {} s", pose.time, poses.back().time));
    poses.push_back(pose);
  });
  return poses;
}

std::optional<Rigid3> ResultFolder::pose_at(int frame) const {
  if (!poses) return camera_from_body;
  const auto at = poses->find(frame);
  if (at == poses->end()) return std::nullopt;
  return at->second;
}

bool ResultFolder::every_frame_has_a_pose() const {
  for (std::size_t f = 0; f < processed.size(); ++f) {
    if (processed[f] != 0 && !pose_at(static_cast<int>(f))) return false;
  }
  return true;
}

TruthFolder read_truth_folder(const fs::path& folder) {
  TruthFolder truth;
  truth.folder = fs::exists(folder / "truth" / "camera.toml") ? folder / "truth" : folder;
  if (!fs::is_directory(truth.folder))
    throw Error(fmt::format("{}: no such folder", truth.folder.string()));
  if (!fs::exists(truth.folder / "camera.toml")) {
    throw Error(fmt::format("{}: is no truth: camera.toml is missing (docs/benchmark.md)",
                            truth.folder.string()));
  }
  read_camera(truth);
  const auto read = [&](const char* name, auto reader) {
    if (fs::exists(truth.folder / name)) reader(truth.folder / name, truth);
  };
  read("contact.jsonl", read_contacts);
  read("hand.jsonl", read_hands);
  read("rig.jsonl", read_rows);
  if (const fs::path path = truth.folder / "trajectory.txt"; fs::exists(path))
    truth.trajectory = read_trajectory(path);
  truth.frames = std::max(
      {static_cast<int>(truth.contacts.size()), static_cast<int>(truth.trajectory.size()),
       frames_in(truth.folder / "depth"), truth.rows.empty() ? 0 : truth.rows.back().frame + 1});
  if (truth.frames == 0) {
    throw Error(fmt::format(
        "{}: holds no frame: contact.jsonl, trajectory.txt, rig.jsonl and depth/ are empty or "
        "missing",
        truth.folder.string()));
  }
  const auto complete = [&](const char* name, std::size_t lines) {
    if (lines == 0 || lines == static_cast<std::size_t>(truth.frames)) return;
    throw Error(fmt::format("{}: {} frames, but the truth has {}", (truth.folder / name).string(),
                            lines, truth.frames));
  };
  complete("contact.jsonl", truth.contacts.size());
  complete("trajectory.txt", truth.trajectory.size());
  return truth;
}

ResultFolder read_result_folder(const fs::path& folder, int frames) {
  if (!fs::is_directory(folder)) throw Error(fmt::format("{}: no such folder", folder.string()));
  ResultFolder result;
  result.folder = folder;
  result.processed.assign(static_cast<std::size_t>(frames), 1);
  const auto there = [&](const char* name) { return fs::exists(folder / name); };
  if (there("live.json")) read_live(folder / "live.json", result);
  if (there("touches.jsonl")) result.touches = read_touches(folder / "touches.jsonl");
  if (there("pose.jsonl")) result.poses = read_poses(folder / "pose.jsonl");
  if (there("trajectory.txt")) result.trajectory = read_trajectory(folder / "trajectory.txt");
  if (there("rectification.jsonl"))
    result.corrections = read_corrections(folder / "rectification.jsonl");
  bool any = result.touches || result.poses || result.trajectory || result.corrections ||
             result.camera_from_body;
  for (const char* kind : {"depth", "moving", "visible", "body_depth", "meshes"}) {
    if (!there(kind)) continue;
    expect_frames_in(folder / kind, std::string_view(kind) == "meshes" ? ".ply" : ".png");
    any = true;
  }
  if (!any) {
    throw Error(fmt::format("{}: holds none of the files of a result (docs/benchmark.md)",
                            folder.string()));
  }
  return result;
}

std::optional<DepthCounts> read_counts(const fs::path& folder, const char* kind, int frame) {
  const fs::path path = image_name(folder, kind, frame);
  if (!fs::exists(path)) return std::nullopt;
  ImageFileReader reader;
  DepthCounts counts;
  (void)value_or_throw(reader.read_16bit(path, counts));
  return counts;
}

std::optional<GrayImage> read_gray(const fs::path& folder, const char* kind, int frame) {
  const fs::path path = image_name(folder, kind, frame);
  if (!fs::exists(path)) return std::nullopt;
  ImageFileReader reader;
  ColorImage colors;
  (void)value_or_throw(reader.read_color(path, colors));
  GrayImage gray(colors.width(), colors.height());
  std::transform(colors.begin(), colors.end(), gray.begin(), [](Rgb c) { return c.r; });
  return gray;
}

}  // namespace palpable::app
