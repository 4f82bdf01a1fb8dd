#include "palpable/desk/clip_files/contact_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {
namespace {

constexpr double kLargestContactDistance = 1e3;  // m; a larger value is a mistake in the file

// The value of `key`, nothing if the line lacks it. @throws Error unless it lies in [0, largest]
std::optional<double> within(const JsonObject& line, const char* key, double largest) {
  if (!line.has(key)) return std::nullopt;
  const double value = line.number(key);
  if (value >= 0 && value <= largest) return value;
  throw Error(fmt::format("{} is {}: it lies between 0 and {}", key, value, largest));
}

}  // namespace

std::string contact_line(const ContactLine& contact) {
  if (!contact.touching) {
    const std::string gap = contact.gap ? fmt::format(",\"gap_m\":{:.6f}", *contact.gap) : "";
    return fmt::format("{{\"frame\":{},\"touching\":false,\"depth_m\":0,\"site\":-1{}}}\n",
                       contact.frame, gap);
  }
  PALPABLE_EXPECT(contact.point.has_value(), "a touch is somewhere");
  return fmt::format(
      "{{\"frame\":{},\"touching\":true,\"depth_m\":{:.6f},\"site\":{},"
      "\"point\":[{:.6f},{:.6f},{:.6f}]{}}}\n",
      contact.frame, contact.depth, contact.site, contact.point->x(), contact.point->y(),
      contact.point->z(),
      contact.seen_share ? fmt::format(",\"seen_share\":{:.3f}", *contact.seen_share) : "");
}

std::vector<ContactLine> read_contacts(const std::filesystem::path& path) {
  std::vector<ContactLine> contacts;
  for_each_object(path, [&](const JsonObject& line) {
    ContactLine contact;
    contact.frame = line.frame_after(contacts.empty() ? -1 : contacts.back().frame);
    contact.touching = line.flag("touching");
    contact.site = line.whole_or("site", -1);
    contact.depth = within(line, "depth_m", kLargestContactDistance).value_or(0);
    contact.gap = within(line, "gap_m", kLargestContactDistance);
    contact.seen_share = within(line, "seen_share", 1);
    if (const auto p = line.numbers_if_any("point", 3)) {
      contact.point = Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
    }
    contacts.push_back(contact);
  });
  return contacts;
}

}  // namespace palpable
