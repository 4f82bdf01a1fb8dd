#include "palpable/live/calibrate/factory_calibration.h"

#include "palpable/common/base/text_numbers.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <array>
#include <cctype>
#include <cmath>
#include <functional>
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
constexpr std::array kSections{Section{"HD", 1280, 720},       Section{"FHD", 1920, 1080},
                               Section{"2K", 2208, 1242},      Section{"VGA", 672, 376},
                               Section{"FHD1200", 1920, 1200}, Section{"SVGA", 960, 600}};

std::string trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t");
  if (from == std::string_view::npos) return {};
  return std::string(text.substr(from, text.find_last_not_of(" \t") - from + 1));
}

// "SECTION.key" -> text, in the letters of the present files.
using Entries = std::map<std::string, std::string, std::less<>>;

// Files differ in letters (BaseLine), and those of before 2018 have LEFT_CAM_RESOLUTION_HD and
// RX_RESOLUTION_HD where the present ones have LEFT_CAM_HD and RX_HD.
std::string usual_name(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  constexpr std::string_view kOld = "RESOLUTION_";
  if (const auto at = name.find(kOld); at != std::string::npos) name.erase(at, kOld.size());
  return name;
}

// If a key occurs twice the later entry is used, as in the vendor's own reader.
Entries entries_of(const std::vector<std::string>& lines) {
  Entries entries;
  std::string section;
  for (const std::string& line : lines) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string::npos && line[first] == '[') {
      section = trimmed(std::string_view(line).substr(first + 1, line.find(']') - first - 1));
    }
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    entries[usual_name(section + "." + trimmed(std::string_view(line).substr(0, equals)))] =
        trimmed(std::string_view(line).substr(equals + 1));
  }
  return entries;
}

// Thrown and caught in this file only.
struct Missing {
  std::string key;
};

double number_at(const Entries& entries, const std::string& key) {
  const auto entry = entries.find(usual_name(key));
  if (entry == entries.end()) throw Missing{key};
  std::string text = entry->second;
  // Of a program under a locale with decimal commas.
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos && text.find_first_of(".,", comma + 1) == std::string::npos &&
      text.find('.') == std::string::npos) {
    text[comma] = '.';
  }
  const auto value = to_number(text);
  if (!value) throw Missing{key};
  return *value;
}

// The same for an entry that may be absent.
double number_or_0(const Entries& entries, const std::string& key) {
  return entries.contains(usual_name(key)) ? number_at(entries, key) : 0.0;
}

// The section for eyes of this size.
Result<Section> section_for(const Entries& entries, const std::filesystem::path& path, int width,
                            int height) {
  std::optional<Section> section;
  std::string sizes;
  for (const Section& s : kSections) {
    if (!entries.contains(fmt::format("LEFT_CAM_{}.FX", s.name))) continue;
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

// right_from_left, m. The right eye stands at +X, so T's first number is negative. Most files have
// it positive: the whole vector is then turned, as other readers of these files do, which rectify
// along the line of (Baseline, TY, TZ). If only the first number were turned, that line would be
// tilted by 2 TY / Baseline, and the rows would differ by this share of the disparity: by 5 px at a
// disparity of 80 px where TY is 2 mm.
Eigen::Vector3d translation_of(const Entries& entries, const Section& section) {
  const auto of_size = [&](const char* name) {
    const std::string own = fmt::format("STEREO.{}_{}", name, section.name);
    return number_or_0(entries,
                       entries.contains(usual_name(own)) ? own : fmt::format("STEREO.{}", name));
  };
  const std::string own = fmt::format("STEREO.Baseline_{}", section.name);
  const double baseline =
      number_at(entries, entries.contains(usual_name(own)) ? own : "STEREO.Baseline");
  const Eigen::Vector3d T(baseline, of_size("TY"), of_size("TZ"));
  constexpr double kMillimetre = 1e-3;
  return (T.x() > 0 ? -kMillimetre : kMillimetre) * T;
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
  rig.right_from_left.translation() = translation_of(entries, section);
  return rig;
}

}  // namespace

Result<StereoCalibration> read_factory_calibration(const std::filesystem::path& path, int width,
                                                   int height) {
  const auto lines = read_lines(path);
  if (!lines) {
    return Problem{fmt::format("calibration {}: {}", path.string(), lines.problem().message)};
  }
  const Entries entries = entries_of(lines.value());
  const Result<Section> section = section_for(entries, path, width, height);
  if (!section.ok()) return section.problem();
  StereoCalibration calibration;
  calibration.rate_is_stated = false;
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
