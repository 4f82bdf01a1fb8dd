#include "palpable/calibrate/factory_calibration.h"

#include "palpable/base/text_numbers.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

struct Section {
  std::string_view name;
  int width;   // px
  int height;  // px
};

// In the order of preference when the size is not given.
constexpr std::array kSections{Section{"HD", 1280, 720}, Section{"FHD", 1920, 1080},
                               Section{"2K", 2208, 1242}, Section{"VGA", 672, 376}};

std::string trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t");
  if (from == std::string_view::npos) return {};
  return std::string(text.substr(from, text.find_last_not_of(" \t") - from + 1));
}

// "SECTION.key" -> text. Later entries win, as in the vendor's own reader.
std::map<std::string, std::string> entries_of(const std::vector<std::string>& lines) {
  std::map<std::string, std::string> entries;
  std::string section;
  for (const std::string& line : lines) {
    if (line.front() == '[') section = line.substr(1, line.find(']') - 1);
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    entries[section + "." + trimmed(std::string_view(line).substr(0, equals))] =
        trimmed(std::string_view(line).substr(equals + 1));
  }
  return entries;
}

struct Missing {
  std::string key;
};

}  // namespace

Result<StereoCalibration> read_factory_calibration(const std::filesystem::path& path, int width,
                                                   int height) {
  const auto lines = read_lines(path);
  if (!lines) return Problem{fmt::format("calibration {} cannot be read", path.string())};
  const auto entries = entries_of(*lines);

  const Section* section = nullptr;
  std::string sizes;
  for (const Section& s : kSections) {
    if (!entries.contains(fmt::format("LEFT_CAM_{}.fx", s.name))) continue;
    sizes += fmt::format("{}{} x {}", sizes.empty() ? "" : ", ", s.width, s.height);
    const bool wanted = width == 0 || (s.width == width && s.height == height);
    if (wanted && section == nullptr) section = &s;
  }
  if (sizes.empty()) {
    return Problem{fmt::format(
        "calibration {} is no factory calibration: it has no section LEFT_CAM_HD, LEFT_CAM_FHD, "
        "LEFT_CAM_2K or LEFT_CAM_VGA",
        path.string())};
  }
  if (section == nullptr) {
    return Problem{fmt::format("calibration {} is for eyes of {} px, not for {} x {}",
                               path.string(), sizes, width, height)};
  }

  const auto number = [&](const std::string& key, bool needed = true) {
    const auto entry = entries.find(key);
    if (entry == entries.end() && !needed) return 0.0;
    const auto value = entry == entries.end() ? std::nullopt : to_number(entry->second);
    if (!value) throw Missing{key};
    return *value;
  };
  const auto lens = [&](std::string_view eye) {
    const std::string s = fmt::format("{}_CAM_{}.", eye, section->name);
    return DistortedCamera{{section->width, section->height, number(s + "fx"), number(s + "fy"),
                            number(s + "cx"), number(s + "cy")},
                           {number(s + "k1"), number(s + "k2"), number(s + "p1", false),
                            number(s + "p2", false), number(s + "k3", false)}};
  };
  StereoCalibration calibration;
  try {
    calibration.rig.left = lens("LEFT");
    calibration.rig.right = lens("RIGHT");
    const auto turn_of = [&](const char* name) {
      return number(fmt::format("STEREO.{}_{}", name, section->name));
    };
    const Eigen::Vector3d turn(turn_of("RX"), turn_of("CV"), turn_of("RZ"));
    const double angle = turn.norm();
    if (angle > 0) {
      calibration.rig.right_from_left.linear() =
          Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    }
    constexpr double kMillimetre = 1e-3;
    calibration.rig.right_from_left.translation() =
        kMillimetre * Eigen::Vector3d(-std::abs(number("STEREO.Baseline")),
                                      number("STEREO.TY", false), number("STEREO.TZ", false));
  } catch (const Missing& missing) {
    return Problem{fmt::format("calibration {} has no number {}", path.string(), missing.key)};
  }
  const std::string wrong = what_is_wrong_with(calibration.rig);
  if (!wrong.empty()) {
    return Problem{fmt::format("calibration {} cannot be used: {}", path.string(), wrong)};
  }
  return calibration;
}

}  // namespace palpable
