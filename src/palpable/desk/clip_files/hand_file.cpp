#include "palpable/desk/clip_files/hand_file.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string hand_line(const HandLine& hand) {
  std::string line = fmt::format("{{\"frame\":{},\"capsules\":[", hand.frame);
  bool first = true;
  for (const auto& [a, b, ra, rb] : hand.capsules) {
    line += fmt::format("{}[{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}]",
                        first ? "" : ",", a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), ra, rb);
    first = false;
  }
  return line + "]}\n";
}

std::vector<HandLine> read_hands(const std::filesystem::path& path) {
  std::vector<HandLine> hands;
  for_each_object(path, [&](const JsonObject& line) {
    HandLine hand;
    hand.frame = line.frame_after(hands.empty() ? -1 : hands.back().frame);
    for (const std::vector<double>& v : line.rows("capsules", 8)) {
      if (v[6] < 0 || v[7] < 0) throw Error("a capsule's radius is negative");
      hand.capsules.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
    }
    hands.push_back(std::move(hand));
  });
  return hands;
}

}  // namespace palpable
