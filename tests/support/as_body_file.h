/// @file
/// The bytes of a body file of a body: one comparison of all that a body holds.
#pragma once

#include "palpable/common/body_file/touch_file.h"
#include "tests/support/scratch_folder.h"

#include <filesystem>
#include <string>

namespace palpable::test {

/// The same body gives the same bytes. @param folder  for the file
inline std::string as_body_file(const TouchableBody& body, const ScratchFolder& folder) {
  const std::filesystem::path path = folder / "body.palpable";
  if (body.touch) {
    write_touchable_body(path, body.body, *body.touch);
  } else if (body.modal) {
    write_touchable_body(path, body.body, *body.modal);
  } else {
    write_body_file(path, body.body);
  }
  return file_bytes(path);
}

}  // namespace palpable::test
