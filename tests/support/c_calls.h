/// @file
/// Structs and a body for tests of the C interface (palpable.h).
#pragma once

#include "palpable/common/body_file/touch_file.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"

#include <string>

namespace palpable::test {

/// A struct of palpable.h that is zero but for its size.
template <class Struct>
Struct sized() {
  Struct empty{};
  empty.size = sizeof empty;
  return empty;
}

/// Writes a ball of 10 cm diameter that stands on Z = 0, is held below 5 mm and can be pressed
/// anywhere. @returns its file
/// @param spacing  m, of its contact points
/// @param swings   it has inertia
inline std::string write_ball_body(const ScratchFolder& folder, const char* name, double spacing,
                                   bool swings = false) {
  const ReducedBody body = DentedSphere{}.body();
  const std::string file = (folder / name).string();
  TouchTables tables = yielding_tables(body.surface);
  tables.point_spacing = spacing;
  if (swings) tables.vibration = swinging_vibration(tables.shell.nodes());
  write_touchable_body(file, body, tables);
  return file;
}

}  // namespace palpable::test
