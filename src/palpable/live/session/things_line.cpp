#include "palpable/live/session/things_line.h"

#include "palpable/common/base/json.h"
#include "palpable/common/response/touch_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr double kLatestTime = 1e11;  // s; ns since 1970 are 1e18

// Nothing: all is well.
using Complaint = std::optional<Problem>;

// The numbers of a list, or nothing if one of its values is no number.
std::optional<std::vector<double>> numbers_in(const Json* list) {
  if (list == nullptr || !list->is_array()) return std::nullopt;
  std::vector<double> numbers;
  numbers.reserve(list->size());
  for (const Json& value : *list) {
    const std::optional<double> number = value.if_number();
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

Complaint capsule_of(const Json& json, Capsule& capsule) {
  const auto numbers = numbers_in(&json);
  if (!numbers || numbers->size() != 8) {
    return Problem{
        "is no list of eight numbers: write [ax, ay, az, bx, by, bz, ra, rb], in metres"};
  }
  const std::vector<double>& n = *numbers;
  for (std::size_t i = 0; i < 6; ++i) {
    if (std::abs(n[i]) <= kFarthestThing) continue;
    return Problem{fmt::format("has the coordinate {:.6g} m, beyond {:g} m: are these metres?",
                               n[i], kFarthestThing)};
  }
  for (const double r : {n[6], n[7]}) {
    if (r >= kLeastThingRadius && r <= kMostThingRadius) continue;
    return Problem{
        fmt::format("has the radius {:.6g} m, not within {:g} and {:g}: are these metres?", r,
                    kLeastThingRadius, kMostThingRadius)};
  }
  capsule = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7]};
  return {};
}

Complaint add_capsules(const Json& list, std::vector<Capsule>& capsules) {
  if (!list.is_array()) return Problem{"\"capsules\" is no list"};
  if (capsules.size() + list.size() > kMostThingCapsules) {
    return Problem{fmt::format("with it there are {} capsules; {} at most may press at a time",
                               capsules.size() + list.size(), kMostThingCapsules)};
  }
  std::size_t number = 0;
  for (const Json& one : list) {
    if (const Complaint wrong = capsule_of(one, capsules.emplace_back())) {
      return Problem{fmt::format("capsule {} {}", number, wrong->message)};
    }
    ++number;
  }
  return {};
}

Complaint joints_of(const Json* list, std::size_t count, std::string_view layout,
                    std::array<Vector3d, 26>& joints) {
  if (list == nullptr || !list->is_array() || list->size() != count) {
    return Problem{
        fmt::format("\"joints\" is no list of the {} joints that {} has", count, layout)};
  }
  std::size_t number = 0;
  for (const Json& joint : *list) {
    const auto place = numbers_in(&joint);
    if (!place || place->size() != 3) {
      return Problem{
          fmt::format("joint {} is no list of three numbers, x y z in metres; leave a "
                      "hand out while it is not tracked",
                      number)};
    }
    joints[number] = Vector3d((*place)[0], (*place)[1], (*place)[2]);
    if (joints[number].cwiseAbs().maxCoeff() > kFarthestThing) {
      return Problem{fmt::format("joint {} is farther than {:g} m away: are these metres?", number,
                                 kFarthestThing)};
    }
    ++number;
  }
  return {};
}

Complaint add_hand(const Json& thing, std::vector<Capsule>& capsules) {
  const Json* hand = thing.find("hand");
  const std::string* name = hand != nullptr ? hand->if_text() : nullptr;
  const auto layout = name != nullptr ? hand_layout_named(*name) : std::nullopt;
  if (!layout) return Problem{"its \"hand\" is none of \"openxr\", \"webxr\", \"mediapipe\""};
  const Json* side = thing.find("side");
  const std::string* side_name = side != nullptr ? side->if_text() : nullptr;
  const auto which = side_name != nullptr ? hand_side_named(*side_name) : std::nullopt;
  if (!which) return Problem{"its \"side\" is neither \"left\" nor \"right\""};
  const auto count = static_cast<std::size_t>(joint_count(*layout));
  std::array<Vector3d, 26> joints;
  if (Complaint wrong = joints_of(thing.find("joints"), count, *name, joints)) return wrong;
  std::vector<double> radii;
  if (const Json* given = thing.find("radii")) {
    auto numbers = numbers_in(given);
    if (!numbers || numbers->size() != count) {
      return Problem{
          fmt::format("\"radii\" is no list of {} numbers; leave it out if the radii of "
                      "the joints are not known",
                      count)};
    }
    radii = std::move(*numbers);
  }
  const auto made = tracked_hand(*layout, *which, std::span(joints).first(count), radii);
  if (!made.ok()) return made.problem();
  if (capsules.size() + made.value().size() > kMostThingCapsules) {
    return Problem{fmt::format("with it there are more than {} capsules; leave some things out",
                               kMostThingCapsules)};
  }
  capsules.insert(capsules.end(), made.value().begin(), made.value().end());
  return {};
}

Complaint add_thing(const Json& thing, ThingsLine& line) {
  if (!thing.is_object()) return Problem{"is no object with \"id\" and \"capsules\" or \"joints\""};
  const Json* id = thing.find("id");
  const auto number = id != nullptr ? id->if_whole() : std::nullopt;
  if (!number) return Problem{"its \"id\" is no whole number; each thing keeps one of its own"};
  for (const ThingsLine::Thing& other : line.things) {
    if (other.id != *number) continue;
    return Problem{fmt::format(
        "has the id {} as an earlier thing of the line has; give each its own", *number)};
  }
  const Json* capsules = thing.find("capsules");
  if ((capsules != nullptr) == thing.contains("joints")) {
    return Problem{"must have either \"capsules\" or \"joints\""};
  }
  const std::size_t first = line.capsules.size();
  Complaint wrong =
      capsules != nullptr ? add_capsules(*capsules, line.capsules) : add_hand(thing, line.capsules);
  if (wrong) return wrong;
  float friction = kFrictionOfBody;
  if (const Json* given = thing.find("friction")) {
    const std::optional<double> mu = given->if_number();
    if (!mu || !is_friction(*mu)) {
      return Problem{
          fmt::format("its \"friction\" is no coefficient from 0 to {:g}; leave it out "
                      "for that of the bodies",
                      kMostFriction)};
    }
    friction = static_cast<float>(*mu);
  }
  line.things.push_back({*number, first, line.capsules.size() - first, friction});
  return {};
}

Complaint read_time(const Json& json, std::optional<double> after, double& time) {
  const Json* given = json.find("time");
  const auto number = given != nullptr ? given->if_number() : std::nullopt;
  if (!number) return Problem{"\"time\" is no number of seconds"};
  if (!(std::abs(*number) <= kLatestTime)) {
    return Problem{
        fmt::format("the time is {:.6g}, beyond {:g}: is it in seconds?", *number, kLatestTime)};
  }
  if (after && !(*number > *after)) {
    return Problem{
        fmt::format("the time {:.9g} s does not come after {:.9g} s, that of the line "
                    "before: times must grow",
                    *number, *after)};
  }
  time = *number;
  return {};
}

Complaint read_wants(const Json& json, bool& wants_vertices) {
  const Json* want = json.find("want");
  if (want == nullptr) return {};
  if (!want->is_array()) return Problem{"\"want\" is no list, such as [\"vertices\"]"};
  for (const Json& one : *want) {
    const std::string* name = one.if_text();
    if (name == nullptr || *name != "vertices") {
      return Problem{"\"want\" has something other than \"vertices\""};
    }
    wants_vertices = true;
  }
  return {};
}

void add_numbers(std::string& text, std::span<const double> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}{:.6f}", i > 0 ? "," : "[", numbers[i]);
  }
  text += "]";
}

}  // namespace

Result<ThingsLine> read_things_line(std::string_view text, std::optional<double> after) {
  if (text.size() > kLongestThingsLine) {
    return Problem{
        fmt::format("has {} bytes; a line has {} at most", text.size(), kLongestThingsLine)};
  }
  const Result<Json> parsed = Json::parse(text);
  if (!parsed.ok() || !parsed.value().is_object()) {
    return Problem{
        "is no JSON object in one line, such as {\"time\":0.5,\"things\":[]}; NaN is no number in "
        "JSON"};
  }
  const Json& json = parsed.value();
  ThingsLine line;
  if (const Complaint wrong = read_time(json, after, line.time)) return *wrong;
  if (const Complaint wrong = read_wants(json, line.wants_vertices)) return *wrong;
  const Json* things = json.find("things");
  if (things == nullptr || !things->is_array()) {
    return Problem{"\"things\" is no list; where nothing presses write \"things\":[]"};
  }
  if (things->size() > kMostThings) {
    return Problem{
        fmt::format("has {} things; {} at most may press at a time", things->size(), kMostThings)};
  }
  std::size_t number = 0;
  for (const Json& thing : *things) {
    if (const Complaint wrong = add_thing(thing, line)) {
      return Problem{fmt::format("thing {}: {}", number, wrong->message)};
    }
    ++number;
  }
  return line;
}

std::string things_line(const ThingsLine& line) {
  std::string text = fmt::format("{{\"time\":{:.6f},\"things\":[", line.time);
  for (std::size_t t = 0; t < line.things.size(); ++t) {
    const auto& [id, first, count, friction] = line.things[t];
    fmt::format_to(std::back_inserter(text), "{}{{\"id\":{},", t > 0 ? "," : "", id);
    if (!(friction < 0)) fmt::format_to(std::back_inserter(text), "\"friction\":{:.9g},", friction);
    text += "\"capsules\":[";
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [a, b, ra, rb] = line.capsules[first + k];
      if (k > 0) text += ",";
      add_numbers(text, std::array{a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), ra, rb});
    }
    text += "]}";
  }
  text += line.wants_vertices ? "],\"want\":[\"vertices\"]}\n" : "]}\n";
  return text;
}

void things_in(const ThingsLine& line, std::vector<CapsuleThing>& things) {
  things.clear();
  for (const auto& [id, first, count, friction] : line.things) {
    things.push_back({id, std::span(line.capsules).subspan(first, count), friction});
  }
}

}  // namespace palpable
