#include "palpable/desk/clip_files/frame_records.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/format.h>

#include <map>
#include <sstream>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

constexpr double kLargestContactDistance = 1e3;  // m; a larger value is a mistake in the file

// The fields of each record but "frame" (json_lines.h).

using Invalid = JsonFields::Invalid;

void fields(JsonFields& line, HandLine& hand) {
  std::vector<std::vector<double>> rows;
  for (const auto& [a, b, ra, rb] : hand.capsules) {
    rows.push_back({a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), ra, rb});
  }
  line.rows_of_eight("capsules", rows, 6);
  if (!line.reads()) return;
  for (const std::vector<double>& v : rows) {
    if (v[6] < 0 || v[7] < 0) throw Error("a capsule's radius is negative");
    hand.capsules.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
  }
}

void fields(JsonFields& line, ContactLine& contact) {
  std::optional<double> depth = contact.depth;
  line.flag("touching", contact.touching);
  line.number_up_to(kLargestContactDistance, "depth_m", depth, contact.touching ? 6 : 0);
  line.whole("site", contact.site);
  line.number_up_to(kLargestContactDistance, "gap_m", contact.gap, 6);
  line.vector("point", contact.point, 6, Invalid::kIgnored);
  line.number_up_to(1, "seen_share", contact.seen_share, 3);
  contact.depth = *depth;
}

// Micrometres (6 digits) and nanonewtons (9) are finer than the accuracy of any solution.
void fields(JsonFields& line, DeformedLine& deformed) {
  line.whole("body", deformed.body);
  line.number("depth_m", deformed.depth, 6);
  line.vector("force", deformed.force, 9);
  line.vector("point", deformed.point, 6);
  line.flag("scored", deformed.scored);
  line.text("why", deformed.why);
}

void fields(JsonFields& line, RigLine& rig) {
  line.number("row_offset_px", rig.row_offset_px, 4);
  line.flag_if_set("step", rig.step);
}

// @param listed  an entry of a list; false: an old line with one touch, whose force has no
//                direction
void touch_fields(JsonFields& object, FeltTouch& touch, bool listed) {
  object.index("site", touch.site);
  if (object.reads() && touch.site < -1) throw Error(fmt::format("site {} is no site", touch.site));
  object.number("level", touch.level, 6);
  if (object.reads() && touch.level && *touch.level < 0) {
    throw Error("level is negative: it is a share of the site's full load");
  }
  object.number("press_depth", touch.press_depth, 7, Invalid::kIgnored);
  if (listed) object.vector("force", touch.force, 6);
  object.vector("friction", touch.friction, 6, Invalid::kIgnored);
  object.number("friction_coefficient", touch.friction_coefficient, 6, Invalid::kIgnored);
  object.flag_if_set("mean_motion", touch.mean_motion);
  object.vector("point", touch.point, 6, Invalid::kIgnored);
  object.number("time", touch.time, 6, Invalid::kIgnored);
  object.number("area", touch.area, 9, Invalid::kIgnored);
  object.number("assumed", touch.assumed, 4, Invalid::kIgnored);
  object.text("by", touch.by);
  object.id("thing", touch.thing);
  object.number("left_out", touch.left_out, 0, Invalid::kIgnored);
}

void fields(JsonFields& line, TouchesLine& felt) {
  line.text("body", felt.body);
  line.text("answer", felt.answer);
  if (line.reads() && !line.has("touches")) {
    touch_fields(line, felt.touches.emplace_back(), false);
  } else {
    line.list<FeltTouch>("touches", felt.touches, [](JsonFields& entry, FeltTouch& touch) {
      touch_fields(entry, touch, true);
    });
  }
  line.number("displacement_error", felt.displacement_error, 5, Invalid::kIgnored);
  line.number("stress_error", felt.stress_error, 5, Invalid::kIgnored);
}

void fields(JsonFields& line, PoseLine& pose) {
  line.text("body", pose.body);
  line.rigid("camera_from_body", pose.camera_from_body);
}

void fields(JsonFields& line, CorrectionLine& correction) {
  line.number("row_correction_px", correction.row_correction_px, 4);
  line.number_or_null("row_error_px", correction.row_error_px, 4);
}

template <class Line>
std::string line_of(Line line) {
  JsonFields text;
  text.frame(line.frame);
  fields(text, line);
  return text.object() + "\n";
}

// Whether a line belongs to another body: whether its key "body" names one other than `body`. A
// line without the key belongs to every body.
bool is_of_another(JsonFields& line, const std::string& body) {
  std::string named = body;
  line.text("body", named);
  return named != body;
}

// The lines of a file whose frame numbers must increase.
// @param body  nothing: the lines have no key "body"; else those of other bodies are skipped
template <class Line>
std::vector<Line> read_increasing(const std::filesystem::path& path,
                                  const std::optional<std::string>& body = {}) {
  std::vector<Line> lines;
  for_each_object(path, [&](JsonFields& object) {
    if (body && is_of_another(object, *body)) return;
    const int last = lines.empty() ? -1 : lines.back().frame;
    Line line;
    object.frame(line.frame);
    if (line.frame <= last) {
      throw Error(fmt::format("frame {} comes after frame {}", line.frame, last));
    }
    fields(object, line);
    lines.push_back(std::move(line));
  });
  return lines;
}

template <class Line>
std::vector<Line> in_order(std::map<int, Line> by_frame) {
  std::vector<Line> lines;
  for (auto& [frame, line] : by_frame) lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> stages_of(const std::string& header) {
  std::vector<std::string> stages;
  std::istringstream words(header);
  std::string word;
  if (!std::getline(words, word, ',') || word != "frame") {
    throw Error("the first column is to be called frame");
  }
  while (std::getline(words, word, ',')) {
    if (!word.ends_with("_ms")) throw Error(fmt::format("column '{}' does not end in _ms", word));
    stages.push_back(word.substr(0, word.size() - 3));
  }
  return stages;
}

}  // namespace

std::string hand_line(const HandLine& hand) { return line_of(hand); }

std::vector<HandLine> read_hands(const std::filesystem::path& path) {
  return read_increasing<HandLine>(path);
}

std::string contact_line(const ContactLine& contact) {
  if (!contact.touching) return line_of(ContactLine{.frame = contact.frame, .gap = contact.gap});
  PALPABLE_EXPECT(contact.point.has_value(), "a touch is somewhere");
  ContactLine touch = contact;
  touch.gap.reset();
  return line_of(touch);
}

std::vector<ContactLine> read_contacts(const std::filesystem::path& path) {
  return read_increasing<ContactLine>(path);
}

std::string deformed_line(const DeformedLine& line) { return line_of(line); }

std::vector<DeformedLine> read_deformed_lines(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "deformed.jsonl";
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {};
  std::map<int, DeformedLine> by_frame;
  for_each_object(path, [&](JsonFields& object) {
    DeformedLine line;
    object.frame(line.frame);
    fields(object, line);
    by_frame[line.frame] = line;
  });
  return in_order(std::move(by_frame));
}

std::filesystem::path deformed_skin_file(const std::filesystem::path& folder, int frame) {
  return folder / frame_name(frame, ".ply");
}

std::string rig_line(const RigLine& rig) { return line_of(rig); }

std::vector<RigLine> read_rig(const std::filesystem::path& path) {
  return read_increasing<RigLine>(path);
}

std::string touches_line(const TouchesLine& line) { return line_of(line); }

std::vector<TouchesLine> read_touches(const std::filesystem::path& path, const std::string& body) {
  std::map<int, TouchesLine> by_frame;
  for_each_object(path, [&](JsonFields& line) {
    if (is_of_another(line, body)) return;
    int frame = 0;
    line.frame(frame);
    TouchesLine& felt = by_frame[frame];
    felt.frame = frame;
    felt.body = body;
    fields(line, felt);
  });
  return in_order(std::move(by_frame));
}

std::string pose_line(const PoseLine& pose) { return line_of(pose); }

std::vector<PoseLine> read_poses(const std::filesystem::path& path, const std::string& body) {
  std::vector<PoseLine> poses = read_increasing<PoseLine>(path, body);
  for (PoseLine& pose : poses) pose.body = body;
  return poses;
}

std::string correction_line(const CorrectionLine& correction) { return line_of(correction); }

std::vector<CorrectionLine> read_corrections(const std::filesystem::path& path) {
  return read_increasing<CorrectionLine>(path);
}

std::string timing_header(std::span<const std::string> stages) {
  std::string text = "frame";
  for (const std::string& stage : stages) text += "," + stage + "_ms";
  return text + "\n";
}

std::string timing_line(int frame, std::span<const double> ms) {
  std::string text = fmt::format("{}", frame);
  for (const double value : ms) text += fmt::format(",{:.3f}", value);
  return text + "\n";
}

TimingTable read_timing(const std::filesystem::path& path) {
  TimingTable table;
  bool is_header = true;
  for_each_line(path, [&](const std::string& line) {
    if (is_header) {
      table.stages = stages_of(line);
      is_header = false;
      return;
    }
    const std::optional<std::vector<double>> numbers = to_numbers(line);
    if (!numbers || numbers->size() != table.stages.size() + 1) {
      throw Error(fmt::format("{} numbers are wanted", table.stages.size() + 1));
    }
    table.frames.push_back(static_cast<int>(numbers->front()));
    table.ms.emplace_back(numbers->begin() + 1, numbers->end());
  });
  return table;
}

}  // namespace palpable
