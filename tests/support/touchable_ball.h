/// @file
/// A ball with contact points and tables of arbitrary numbers, for tests of the contact search.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/tables_body.h"
#include "tests/support/some_touch_tables.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace palpable::test {

// A ball of radius 40 mm at rest, with contact points 2 mm apart.
struct TouchableBall {
  SurfaceMesh surface = sphere_surface({0, 0, 0.04}, 0.04, 3);
  TouchTables tables = some_touch_tables(surface, 1);
  std::vector<std::uint8_t> fixed =
      std::vector<std::uint8_t>(static_cast<std::size_t>(surface.vertex_count()), 0);
  double entry;  // m, TouchSettings
  TouchState state;
  std::unique_ptr<TablesBody> body;

  explicit TouchableBall(double the_entry) : entry(the_entry), body(made()) {}

  std::unique_ptr<TablesBody> made() {
    tables.point_spacing = 0.002;
    TouchSettings settings;
    settings.entry = entry;
    auto one = std::make_unique<TablesBody>(surface, fixed, tables, settings);
    one->use(state);
    one->begin_frame();
    return one;
  }
};

}  // namespace palpable::test
