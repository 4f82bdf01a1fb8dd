#include "palpable/live/calibrate/factory_calibration.h"

#include "palpable/common/base/text_numbers.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// "SECTION.key" -> text.
using Entries = std::map<std::string, std::string>;

// If a key occurs twice the later entry is used, as in the vendor's own reader.
Entries entries_of(const std::vector<std::string>& lines) {
  Entries entries;
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

// Thrown and caught in this file only.
struct Missing {
  std::string key;
};

double number_at(const Entries& entries, const std::string& key) {
  const auto entry = entries.find(key);
  const auto value = entry == entries.end() ? std::nullopt : to_number(entry->second);
  if (!value) throw Missing{key};
  return *value;
}

// The same for an entry that may be absent.
double number_or_0(const Entries& entries, const std::string& key) {
  return entries.contains(key) ? number_at(entries, key) : 0.0;
}

// The section for eyes of this size.
Result<Section> section_for(const Entries& entries, const std::filesystem::path& path, int width,
                            int height) {
  std::optional<Section> section;
  std::string sizes;
  for (const Section& s : kSections) {
    if (!entries.contains(fmt::format("LEFT_CAM_{}.fx", s.name))) continue;
    sizes += fmt::format("{}{} x {}", sizes.empty() ? "" : ", ", s.width, s.height);
    const bool wanted = width == 0 || (s.width == width && s.height == height);
    if (wanted && !section) section = s;
  }
  if (sizes.empty()) {
    return Problem{fmt::format(
        "calibration {} is no factory calibration: it has no section LEFT_CAM_HD, LEFT_CAM_FHD, "
        "LEFT_CAM_2K or LEFT_CAM_VGA",
        path.string())};
  }
  if (section) return *section;
  return Problem{fmt::format("calibration {} is for eyes of {} px, not for {} x {}", path.string(),
                             sizes, width, height)};
}

DistortedCamera factory_lens(const Entries& entries, std::string_view eye, const Section& section) {
  const std::string s = fmt::format("{}_CAM_{}.", eye, section.name);
  return {
      {section.width, section.height, number_at(entries, s + "fx"), number_at(entries, s + "fy"),
       number_at(entries, s + "cx"), number_at(entries, s + "cy")},
      {number_at(entries, s + "k1"), number_at(entries, s + "k2"), number_or_0(entries, s + "p1"),
       number_or_0(entries, s + "p2"), number_or_0(entries, s + "k3")}};
}

StereoRig rig_of(const Entries& entries, const Section& section) {
  StereoRig rig;
  rig.left = factory_lens(entries, "LEFT", section);
  rig.right = factory_lens(entries, "RIGHT", section);
  const auto turn_of = [&](const char* name) {
    return number_at(entries, fmt::format("STEREO.{}_{}", name, section.name));
  };
  const Eigen::Vector3d turn(turn_of("RX"), turn_of("CV"), turn_of("RZ"));
  const double angle = turn.norm();
  if (angle > 0) {
    rig.right_from_left.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  constexpr double kMillimetre = 1e-3;
  rig.right_from_left.translation() =
      kMillimetre * Eigen::Vector3d(-std::abs(number_at(entries, "STEREO.Baseline")),
                                    number_or_0(entries, "STEREO.TY"),
                                    number_or_0(entries, "STEREO.TZ"));
  return rig;
}

}  // namespace

Result<StereoCalibration> read_factory_calibration(const std::filesystem::path& path, int width,
                                                   int height) {
  const auto lines = read_lines(path);
  if (!lines) return Problem{fmt::format("calibration {} cannot be read", path.string())};
  const Entries entries = entries_of(*lines);
  const Result<Section> section = section_for(entries, path, width, height);
  if (!section.ok()) return section.problem();
  StereoCalibration calibration;
  try {
    calibration.rig = rig_of(entries, section.value());
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
