#include "palpable/common/body_file/touch_file.h"

#include "palpable/common/body_file/body_file_groups.h"
#include "palpable/common/body_file/touch_groups.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

namespace palpable {
namespace {

using hdf5::Handle;
using hdf5::open_group;
using hdf5::require;

std::string region_name(int k) { return fmt::format("region_{:04}", k); }

void write_touch(hid_t file, const TouchTables& tables) {
  const Handle g = hdf5::make_group(file, "touch");
  hdf5::write_number(g, "layout", kTouchLayout);
  hdf5::write_number(g, "point_spacing", tables.point_spacing);
  hdf5::write_number(g, "region_reach", tables.region_reach);
  if (tables.friction > 0) hdf5::write_number(g, "friction", tables.friction);
  hdf5::write_number(g, "regions", static_cast<double>(tables.regions.size()));
  if (tables.coarse) write_group(hdf5::make_group(g, "skin"), *tables.coarse);
  write_group(hdf5::make_group(g, "compliance"), tables.compliance);
  int k = 0;
  for (const RegionTable& region : tables.regions) {
    write_group(hdf5::make_group(g, region_name(k++).c_str()), region);
  }
  if (tables.cross.cubic.variables > 0) { write_group(hdf5::make_group(g, "cross"), tables.cross); }
  write_group(hdf5::make_group(g, "shell"), tables.shell);
  if (!tables.held_out.empty()) write_group(hdf5::make_group(g, "held_out"), tables.held_out);
  if (tables.vibration) write_group(hdf5::make_group(g, "vibration"), *tables.vibration);
}

// Reads a table; errors within its group are reported with the group's name.
template <class Table>
Table table_of(hid_t touch, const std::string& name) {
  Table table;
  try {
    read_group(open_group(touch, name.c_str()), table);
  } catch (const hdf5::Trouble& trouble) {
    throw hdf5::Trouble{fmt::format("touch/{}: {}", name, trouble.what)};
  }
  return table;
}

std::optional<TouchTables> read_touch(hid_t file, const ReducedBody& body) {
  if (!hdf5::has_link(file, "touch")) return std::nullopt;
  const Handle g = open_group(file, "touch");
  const double layout = hdf5::read_number(g, "layout");
  require(layout == kTouchLayout,
          fmt::format("its tables of touch have layout {} where this program reads {}; bake the "
                      "body again",
                      layout, kTouchLayout));
  TouchTables tables;
  tables.point_spacing = hdf5::read_number(g, "point_spacing");
  tables.region_reach = hdf5::read_number(g, "region_reach");
  // Files of 0.1 have none, and no friction.
  if (hdf5::has(g, "friction")) tables.friction = hdf5::read_number(g, "friction");
  if (hdf5::has_link(g, "skin")) tables.coarse = table_of<CoarseSkin>(g, "skin");
  tables.compliance = table_of<ComplianceTable>(g, "compliance");
  const double regions = hdf5::read_number(g, "regions");
  require(regions >= 0 && regions <= 1e6, "touch: the number of regions is not valid");
  for (int k = 0; k < static_cast<int>(regions); ++k) {
    tables.regions.push_back(table_of<RegionTable>(g, region_name(k)));
  }
  if (hdf5::has_link(g, "cross")) tables.cross = table_of<CrossTable>(g, "cross");
  tables.shell = table_of<ShellTable>(g, "shell");
  if (hdf5::has_link(g, "held_out")) {
    tables.held_out = table_of<std::vector<HeldOutTouch>>(g, "held_out");
  }
  // Files older than vibration modes have none, nor have those of bodies without a density.
  if (hdf5::has_link(g, "vibration")) tables.vibration = table_of<VibrationTable>(g, "vibration");
  const std::string trouble = trouble_of(tables, body.surface);
  require(trouble.empty(), "touch: " + trouble);
  return tables;
}

std::optional<ModalTables> read_modal(hid_t file, const ReducedBody& body) {
  if (!hdf5::has_link(file, "touch_modes")) return std::nullopt;
  ModalTables tables = table_of<ModalTables>(file, "touch_modes");
  const std::string trouble = trouble_of(tables, body);
  require(trouble.empty(), "touch_modes: " + trouble);
  return tables;
}

}  // namespace

Result<TouchableBody> read_touchable_body(const std::filesystem::path& path) {
  std::optional<TouchTables> touch;
  std::optional<ModalTables> modal;
  Result<ReducedBody> body = read_body_file(path, [&](hid_t file, const ReducedBody& read) {
    touch = read_touch(file, read);
    modal = read_modal(file, read);
  });
  if (!body.ok()) return body.problem();
  return TouchableBody{std::move(body).value(), std::move(touch), std::move(modal)};
}

Result<BodyAndTouch> read_body_and_touch(const std::filesystem::path& path) {
  Result<TouchableBody> both = read_touchable_body(path);
  if (both.ok()) {
    return BodyAndTouch{std::move(both.value().body), std::move(both.value().touch),
                        std::move(both.value().modal)};
  }
  Result<ReducedBody> body = read_body_file(path);
  if (!body.ok()) return body.problem();
  return BodyAndTouch{std::move(body).value(), both.problem()};
}

Result<TouchableBody> read_pressable_touchable_body(const std::filesystem::path& path,
                                                    const std::map<std::string, double>& values) {
  Result<TouchableBody> read = read_touchable_body(path);
  if (!read.ok()) return read;
  Result<ReducedBody> body = settled(read.value().body, values);
  if (!body.ok()) { return Problem{fmt::format("{}: {}", path.string(), body.problem().message)}; }
  const bool as_baked = read.value().body.further.empty();
  if (!as_baked) return TouchableBody{std::move(body).value()};
  return TouchableBody{std::move(body).value(), std::move(read.value().touch),
                       std::move(read.value().modal)};
}

ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const TouchTables& tables, ModeStorage storage) {
  return write_body_file(path, body, storage, [&](hid_t file) {
    const std::string trouble = trouble_of(tables, body.surface);
    require(trouble.empty(), "touch: " + trouble);
    write_touch(file, tables);
  });
}

ReductionError write_touchable_body(const std::filesystem::path& path, const ReducedBody& body,
                                    const ModalTables& tables, ModeStorage storage) {
  return write_body_file(path, body, storage, [&](hid_t file) {
    const std::string trouble = trouble_of(tables, body);
    require(trouble.empty(), "touch_modes: " + trouble);
    write_group(hdf5::make_group(file, "touch_modes"), tables);
  });
}

}  // namespace palpable
