#include "palpable/clip_files/contact_file.h"

#include "palpable/base/contract.h"
#include "palpable/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string contact_line(const ContactLine& contact) {
  if (!contact.touching) {
    return fmt::format("{{\"frame\":{},\"touching\":false,\"depth_m\":0,\"site\":-1}}\n",
                       contact.frame);
  }
  PALPABLE_EXPECT(contact.point.has_value(), "a touch is somewhere");
  return fmt::format(
      "{{\"frame\":{},\"touching\":true,\"depth_m\":{:.6f},\"site\":{},"
      "\"point\":[{:.6f},{:.6f},{:.6f}]}}\n",
      contact.frame, contact.depth, contact.site, contact.point->x(), contact.point->y(),
      contact.point->z());
}

std::vector<ContactLine> read_contacts(const std::filesystem::path& path) {
  std::vector<ContactLine> contacts;
  for_each_object(path, [&](const JsonObject& line) {
    ContactLine contact;
    contact.frame = line.frame_after(contacts.empty() ? -1 : contacts.back().frame);
    contact.touching = line.flag("touching");
    contact.site = line.whole_or("site", -1);
    contact.depth = line.number_if_any("depth_m").value_or(0);
    if (const auto p = line.numbers_if_any("point", 3)) {
      contact.point = Eigen::Vector3d((*p)[0], (*p)[1], (*p)[2]);
    }
    contacts.push_back(contact);
  });
  return contacts;
}

}  // namespace palpable
