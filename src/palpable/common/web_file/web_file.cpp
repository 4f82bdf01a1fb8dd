#include "palpable/common/web_file/web_file.h"

#include "palpable/common/reduced/body_check.h"
#include "palpable/common/web_file/web_fields.h"
#include "palpable/common/web_file/web_reader.h"

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>

namespace palpable {
namespace {

Problem damaged(const std::string& what) { return Problem{"its content is not valid: " + what}; }

Result<TouchableBody> read_content(web::Reader& reader) {
  std::string name;
  Provenance provenance;
  reader.origin(name, provenance);
  std::optional<SeparatedField> displacement = reader.field("displacement");
  std::optional<SeparatedField> stress = reader.field("stress");
  if (!reader.ok()) return Problem{reader.trouble()};
  TouchableBody read(ReducedBody{.name = std::move(name),
                                 .surface = {},
                                 .fixed = {},
                                 .sites = {},
                                 .displacement = std::move(*displacement),
                                 .stress = std::move(*stress),
                                 .press_depth = {},
                                 .largest_von_mises = 0,
                                 .error = {},
                                 .material = {},
                                 .provenance = std::move(provenance)});
  web::visit_body(reader, read.body);
  reader.optional("touch", read.touch, [&](auto& tables) { web::visit_touch(reader, tables); });
  reader.optional("touch_modes", read.modal,
                  [&](auto& tables) { web::visit_modal(reader, tables); });
  if (!reader.ok()) return Problem{reader.trouble()};
  std::string trouble = trouble_of(read.body);
  if (!trouble.empty()) return damaged(trouble);
  if (read.touch) trouble = trouble_of(*read.touch, read.body.surface);
  if (!trouble.empty()) return damaged("touch: " + trouble);
  if (read.modal) trouble = trouble_of(*read.modal, read.body);
  if (!trouble.empty()) return damaged("touch_modes: " + trouble);
  return read;
}

}  // namespace

Result<TouchableBody> read_web_file(std::span<const std::byte> bytes) {
  try {
    web::Reader reader(bytes);
    return read_content(reader);
  } catch (const std::bad_alloc&) {
    return Problem{"needs more memory than there is"};
  } catch (const std::exception& error) { return damaged(error.what()); }
}

}  // namespace palpable
