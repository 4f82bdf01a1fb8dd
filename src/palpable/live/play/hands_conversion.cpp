#include "palpable/live/play/hands_conversion.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/clip_hands.h"
#include "palpable/desk/clip_files/text_file.h"

#include <Eigen/Core>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace palpable {

namespace fs = std::filesystem;

namespace {

constexpr std::array kLayouts{HandLayout::kOpenXr, HandLayout::kWebXr, HandLayout::kMediaPipe};

// The cells of a row, without the spaces around them. Commas, semicolons and tabs may leave a cell
// empty between them; spaces may not.
std::vector<std::string_view> cells_of(std::string_view row) {
  constexpr std::string_view kBlank = " \r";
  const auto trimmed = [&](std::string_view cell) {
    const std::size_t first = cell.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return std::string_view{};
    return cell.substr(first, cell.find_last_not_of(kBlank) - first + 1);
  };
  row = trimmed(row);
  const std::size_t found = row.find_first_of(",;\t");
  const char separator = found == std::string_view::npos ? ' ' : row[found];
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= row.size();) {
    const std::size_t end = std::min(row.find(separator, begin), row.size());
    const std::string_view cell = trimmed(row.substr(begin, end - begin));
    if (separator != ' ' || !cell.empty()) cells.push_back(cell);
    begin = end + 1;
  }
  return cells;
}

struct Row {
  double time = 0;               // in the table's unit
  std::optional<HandSide> side;  // nothing: the table has no such column
  std::vector<double> numbers;   // empty: the hand was not tracked
};

std::string in_small_letters(std::string_view text) {
  std::string word(text);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

Row row_of(const std::vector<std::string_view>& cells) {
  Row row;
  const auto time = to_number(cells[0]);
  if (!time) throw Error(fmt::format("'{}' is no time", cells[0]));
  row.time = *time;
  std::size_t first = 1;
  if (cells.size() > 1 && !cells[1].empty() && !to_any_number(cells[1])) {
    row.side = hand_side_named(in_small_letters(cells[1]));
    if (!row.side) {
      throw Error(fmt::format(
          "'{}' is neither a number nor left or right; a row is time, side, coordinates",
          cells[1]));
    }
    first = 2;
  }
  bool is_tracked = cells.size() > first;
  for (std::size_t k = first; k < cells.size(); ++k) {
    const auto number = cells[k].empty() ? std::nan("") : to_any_number(cells[k]);
    if (!number) throw Error(fmt::format("column {}: '{}' is no number", k + 1, cells[k]));
    is_tracked = is_tracked && std::isfinite(*number);
    row.numbers.push_back(*number);
  }
  if (!is_tracked) row.numbers.clear();
  return row;
}

struct Shape {
  HandLayout layout;
  std::size_t a_joint;  // numbers of a joint: 3, or 4 with its radius
};

std::string expected_numbers(HandLayout layout) {
  const int count = joint_count(layout);
  return fmt::format("{} or {} ({}, without or with radii)", 3 * count, 4 * count, name_of(layout));
}

Shape shape_of(std::size_t numbers, const std::optional<HandLayout>& layout) {
  for (const HandLayout one : kLayouts) {
    if (layout && *layout != one) continue;
    const auto count = static_cast<std::size_t>(joint_count(one));
    for (const std::size_t a_joint : {std::size_t{3}, std::size_t{4}}) {
      if (numbers == a_joint * count) return {one, a_joint};
    }
  }
  if (layout) {
    throw Error(
        fmt::format("has {} numbers of joints instead of {}", numbers, expected_numbers(*layout)));
  }
  throw Error(fmt::format("has {} numbers of joints instead of {}, {} or {}", numbers,
                          expected_numbers(kLayouts[0]), expected_numbers(kLayouts[1]),
                          expected_numbers(kLayouts[2])));
}

TrackedHand hand_of(const Row& row, const Shape& shape, const JointsTable& table) {
  const auto& [layout, a_joint] = shape;
  std::vector<Eigen::Vector3d> joints;
  std::vector<double> radii;
  for (std::size_t k = 0; k < row.numbers.size(); k += a_joint) {
    const Eigen::Vector3d given = table.metres * Eigen::Vector3d::Map(&row.numbers[k]);
    joints.push_back(table.has_y_up ? Eigen::Vector3d(given.x(), -given.z(), given.y()) : given);
    if (a_joint == 4) radii.push_back(table.metres * row.numbers[k + 3]);
  }
  const auto hand = tracked_hand(layout, row.side.value_or(table.side), joints, radii);
  if (!hand.ok()) throw Error(hand.problem().message + " (--unit says in what they are)");
  return hand.value();
}

// Notes what the first hand's row says of the table.
void note_first_hand(const Row& row, const Shape& shape, const std::vector<std::string>& names,
                     const JointsTable& table, JointsFound& found) {
  found.layout = shape.layout;
  found.is_counted = !table.layout;
  found.has_radii = shape.a_joint == 4;
  const std::size_t column = row.side ? 2 : 1;
  if (names.size() > column) found.first_name = names[column];
}

// Adds a hand to the things of a line.
void add_hand(const TrackedHand& hand, HandSide side, ThingsLine& line) {
  const std::int64_t id = side == HandSide::kRight ? 1 : 2;
  const auto has_id = [&](const ThingsLine::Thing& thing) { return thing.id == id; };
  if (std::any_of(line.things.begin(), line.things.end(), has_id)) {
    throw Error(
        fmt::format("is a second {} hand at the same time; write left or right after the "
                    "time, and one row for each hand",
                    id == 1 ? "right" : "left"));
  }
  line.things.push_back({id, line.capsules.size(), hand.size()});
  line.capsules.insert(line.capsules.end(), hand.begin(), hand.end());
}

}  // namespace

JointsRead read_joints_table(const fs::path& path, const JointsTable& table) {
  JointsRead read;
  std::vector<ThingsLine>& lines = read.lines;
  std::vector<std::string> names;
  std::optional<double> first_time, time_before;  // in the table's unit
  bool may_be_names = true;
  for_each_line(path, [&](const std::string& text) {
    if (text.starts_with('#')) return;
    const std::vector<std::string_view> cells = cells_of(text);
    const bool may_skip = std::exchange(may_be_names, false);
    if (cells.empty()) return;
    if (may_skip && !to_number(cells[0])) {
      names.assign(cells.begin(), cells.end());
      return;
    }
    if (has_decimal_commas(text)) throw Error(std::string(kDecimalCommas));
    const Row row = row_of(cells);
    if (!first_time) first_time = row.time;
    if (!time_before || row.time > *time_before) {
      lines.push_back({.time = (row.time - *first_time) * table.seconds});
    } else if (row.time < *time_before) {
      throw Error(
          fmt::format("the time {} follows {}; times must not go back", row.time, *time_before));
    }
    time_before = row.time;
    if (row.numbers.empty()) return;
    const Shape shape = shape_of(row.numbers.size(), table.layout);
    const HandSide side = row.side.value_or(table.side);
    JointsFound& found = read.found;
    if (!found.has_left && !found.has_right) note_first_hand(row, shape, names, table, found);
    (side == HandSide::kLeft ? found.has_left : found.has_right) = true;
    add_hand(hand_of(row, shape, table), side, lines.back());
  });
  if (lines.empty()) throw Error(fmt::format("{}: has no row of joints", path.string()));
  return read;
}

std::vector<ThingsLine> read_clip_things(const fs::path& clip, const std::string& body) {
  const ClipHands hands = read_clip_hands(clip, body);
  std::vector<ThingsLine> lines;
  for (std::size_t n = 0; n < hands.capsules.size(); ++n) {
    ThingsLine line{.time = hands.times[n]};
    if (!hands.capsules[n].empty()) line.things.push_back({1, 0, hands.capsules[n].size()});
    line.capsules = hands.capsules[n];
    lines.push_back(std::move(line));
  }
  return lines;
}

HandsText hands_text(const std::vector<ThingsLine>& lines) {
  HandsText all{.lines = lines.size()};
  std::vector<double> steps;
  std::optional<double> before;
  for (const ThingsLine& line : lines) {
    if (before) steps.push_back(line.time - *before);
    before = line.time;
    all.text += things_line(line);
    if (!line.things.empty()) ++all.pressing;
    for (const Capsule& capsule : line.capsules) all.box.extend(capsule.a).extend(capsule.b);
  }
  if (!lines.empty()) all.seconds = lines.back().time - lines.front().time;
  if (!steps.empty()) all.step = percentile(std::move(steps), 0.5);
  return all;
}

std::vector<std::string> joints_warnings(const HandsText& made, const JointsTable& table,
                                         const JointsFound& found) {
  constexpr double kLongestStep = 1, kShortestStep = 1e-3;  // s, of any tracker
  std::vector<std::string> warnings;
  if (found.is_counted && found.layout == HandLayout::kWebXr && !found.first_name.empty() &&
      in_small_letters(found.first_name).find("wrist") == std::string::npos) {
    warnings.push_back(fmt::format(
        "25 joints were taken for WebXR's, the first one for the wrist; the table names "
        "it {}, and names are not read: --joints webxr says that they are WebXR's; a "
        "tracker with other joints has to be brought into one of the orders of "
        "docs/hands.md",
        found.first_name));
  }
  if (made.step > kLongestStep || (made.step > 0 && made.step < kShortestStep)) {
    warnings.push_back(fmt::format(
        "there are {:.3g} s from line to line, a tracker has 8 to 40 ms: is the time in "
        "another unit? --time-unit says in which",
        made.step));
  }
  if (made.box.isEmpty()) return warnings;
  // Bodies stand on Z = 0, and so do the floors of most trackers.
  const Eigen::Vector3d &low = made.box.min(), &high = made.box.max();
  if (!table.has_y_up && high.z() < 0 && low.y() > 0) {
    warnings.push_back(
        fmt::format("all joints are below the floor: Z ends at {:.2f} m, while Y begins at {:.2f} "
                    "m; does Y point up in the table? --up y says so",
                    high.z(), low.y()));
  }
  if (table.has_y_up && high.z() < 0 && high.y() < 0) {
    warnings.push_back(
        fmt::format("all joints are below the floor: the table's Y ends at {:.2f} m, while its Z "
                    "begins at {:.2f} m; does Z point up in the table? Then leave out --up y",
                    high.z(), -high.y()));
  }
  return warnings;
}

}  // namespace palpable
