#include "palpable/bake/touch_bake/touch_store.h"

#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_groups.h"
#include "palpable/common/geometry/digest.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using hdf5::Trouble;

constexpr std::string_view kTableKind = "palpable table of touch";
constexpr std::string_view kListKind = "palpable list of tables of touch";
constexpr const char* kListFile = "tables.h5";
constexpr const char* kStageName = "stage";
constexpr const char* kHeldOutFile = "held_out.h5";
constexpr double kMostHeldOut = 1e6;

std::string key_text(std::uint64_t key) { return fmt::format("{:016x}", key); }

std::uint64_t region_key(const TouchKeys& keys, int vertex) {
  Digest digest(keys.regions);
  digest.add(vertex);
  return digest.value();
}

std::string region_file(int vertex) { return fmt::format("region_{:06}.h5", vertex); }

void add(Digest& digest, const Material& material) {
  digest.add(law_name(material));
  for (const double constant : constants_of(material)) digest.add(constant);
}

void write_file(const fs::path& file, std::string_view kind, std::uint64_t key,
                const std::function<void(hid_t)>& fill) {
  make_folder(file.parent_path());
  try {
    std::string bytes;
    {
      const std::scoped_lock turn(hdf5::turn());
      const hdf5::Quiet quiet;
      bytes = hdf5::image_of(kind, kTouchLayout, [&](hid_t h) {
        hdf5::write_text(h, "key", key_text(key));
        fill(h);
      });
    }
    hdf5::write_durably(file, bytes, own_part_suffix());
  } catch (const Trouble& trouble) {
    throw Error(fmt::format("{}: {}", file.string(), trouble.what));
  }
}

// Reads a file with `look`. @returns false if the file is missing, damaged or has another key
bool read_file(const fs::path& file, std::string_view kind, std::uint64_t key,
               const std::function<void(hid_t)>& look) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  try {
    const hdf5::ImageKind of_file{kind, kTouchLayout, "a table of touch", "bake it again"};
    const std::string bytes = hdf5::image_bytes(file, of_file);
    const std::scoped_lock turn(hdf5::turn());
    const hdf5::Quiet quiet;
    const hdf5::Image image(bytes, of_file);
    if (hdf5::read_text(image.file(), "key") != key_text(key)) return false;
    look(image.file());
    return true;
  } catch (const Trouble&) { return false; } catch (const std::bad_alloc&) {
    return false;
  }
}

template <class Table>
std::optional<Table> find(const fs::path& file, std::uint64_t key) {
  Table table;
  if (!read_file(file, kTableKind, key, [&](hid_t h) { read_group(h, table); })) {
    return std::nullopt;
  }
  return table;
}

}  // namespace

// A new setting breaks the structured bindings below: either add it to the digest, or only name it,
// if it does not change the table.
TouchKeys touch_keys(const SkinResponse& skin, const TouchBakeSettings& settings) {
  const SolidModel& model = skin.body().model();
  Digest body;
  body.add(kTouchRevision);
  body.add(kTouchLayout);
  body.add(model.mesh.nodes);
  body.add(model.mesh.tets);
  body.add(model.mesh.edge_nodes);
  for (const HeldComponent& held : held_components(model)) body.add(static_cast<int>(held.at));
  add(body, model.material);
  for (const MaterialGroup& group : model.groups) {
    add(body, group.material);
    body.add(group.elements);
  }
  body.add(skin.body().rest());

  TouchKeys keys;
  {
    const auto& [spacing, most, near_radius, rank, threads] = settings.compliance;
    Digest digest = body;
    for (const int count : {most, rank}) digest.add(count);
    for (const double length : {spacing, near_radius}) digest.add(length);
    keys.compliance = digest.value();
  }
  {
    const auto& [spacing, most, reach, modes, leading, loads, least_load, largest_load, core,
                 far_shapes] = settings.regions;
    Digest digest(keys.compliance);
    for (const int count : {modes, leading, loads, far_shapes}) digest.add(count);
    for (const double length : {reach, least_load, largest_load, core}) digest.add(length);
    keys.regions = digest.value();
  }
  {
    const auto& [modes, places, pairs, radius] = settings.cross;
    Digest digest = body;
    for (const int count : {modes, places, pairs}) digest.add(count);
    digest.add(radius);
    keys.cross = digest.value();
  }
  keys.shell = body.value();
  if (settings.inertia) {
    const auto& [density, loss_factor, modes, below] = *settings.inertia;
    Digest digest(keys.compliance);  // with which they are compared
    digest.add(modes);
    for (const double number : {density, loss_factor, below}) digest.add(number);
    keys.vibration = digest.value();
  }
  return keys;
}

std::vector<HeldOutTouch> followed(const SolvedTouches& touches) {
  std::vector<HeldOutTouch> all;
  for (const auto& touch : touches) {
    if (touch && std::isfinite(touch->displacement)) all.push_back(*touch);
  }
  return all;
}

std::optional<ComplianceTable> TouchStore::find_compliance(const TouchKeys& keys) const {
  return find<ComplianceTable>(folder_ / "compliance.h5", keys.compliance);
}

std::optional<RegionTable> TouchStore::find_region(const TouchKeys& keys, int vertex) const {
  return find<RegionTable>(folder_ / region_file(vertex), region_key(keys, vertex));
}

std::optional<CrossTable> TouchStore::find_cross(const TouchKeys& keys) const {
  return find<CrossTable>(folder_ / "cross.h5", keys.cross);
}

std::optional<ShellTable> TouchStore::find_shell(const TouchKeys& keys) const {
  return find<ShellTable>(folder_ / "shell.h5", keys.shell);
}

std::optional<VibrationTable> TouchStore::find_vibration(const TouchKeys& keys) const {
  return find<VibrationTable>(folder_ / "vibration.h5", keys.vibration);
}

std::optional<SolvedTouches> TouchStore::find_held_out(const TouchKeys& keys) const {
  SolvedTouches touches;
  const bool found = read_file(folder_ / kHeldOutFile, kTableKind, keys.held_out, [&](hid_t h) {
    const double count = hdf5::read_number(h, "count");
    hdf5::require(count >= 0 && count <= kMostHeldOut, "there is no such count");
    const std::vector<int> numbers = hdf5::read_table<int>(h, "numbers").data;
    std::vector<HeldOutTouch> solved;
    read_group(h, solved);
    hdf5::require(solved.size() == numbers.size(), "numbers do not fit");
    touches.resize(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      hdf5::require(numbers[k] >= 0 && numbers[k] < count, "there is no such number");
      touches[static_cast<std::size_t>(numbers[k])] = solved[k];
    }
  });
  return found ? std::optional(std::move(touches)) : std::nullopt;
}

void TouchStore::keep(const TouchKeys& keys, const ComplianceTable& table) const {
  write_file(folder_ / "compliance.h5", kTableKind, keys.compliance,
             [&](hid_t h) { write_group(h, table); });
}

void TouchStore::keep(const TouchKeys& keys, const RegionTable& table) const {
  write_file(folder_ / region_file(table.vertex), kTableKind, region_key(keys, table.vertex),
             [&](hid_t h) { write_group(h, table); });
}

void TouchStore::keep(const TouchKeys& keys, const CrossTable& table) const {
  write_file(folder_ / "cross.h5", kTableKind, keys.cross, [&](hid_t h) { write_group(h, table); });
}

void TouchStore::keep(const TouchKeys& keys, const ShellTable& table) const {
  write_file(folder_ / "shell.h5", kTableKind, keys.shell, [&](hid_t h) { write_group(h, table); });
}

void TouchStore::keep(const TouchKeys& keys, const VibrationTable& table) const {
  write_file(folder_ / "vibration.h5", kTableKind, keys.vibration,
             [&](hid_t h) { write_group(h, table); });
}

void TouchStore::keep(const TouchKeys& keys, const SolvedTouches& touches) const {
  std::vector<int> numbers;
  std::vector<HeldOutTouch> solved;
  for (std::size_t k = 0; k < touches.size(); ++k) {
    if (!touches[k]) continue;
    numbers.push_back(static_cast<int>(k));
    solved.push_back(*touches[k]);
  }
  write_file(folder_ / kHeldOutFile, kTableKind, keys.held_out, [&](hid_t h) {
    hdf5::write_number(h, "count", static_cast<double>(touches.size()));
    hdf5::write_table(h, "numbers", numbers.data(), numbers.size(), 1);
    write_group(h, solved);
  });
}

void TouchStore::keep_list(std::uint64_t of, const TouchKeys& keys, const TouchTables& tables,
                           const std::string& stage) const {
  write_file(folder_ / kListFile, kListKind, of, [&](hid_t h) {
    if (!stage.empty()) hdf5::write_text(h, kStageName, stage);
    hdf5::write_text(h, "compliance", key_text(keys.compliance));
    hdf5::write_text(h, "shell", key_text(keys.shell));
    hdf5::write_text(h, "regions", key_text(keys.regions));
    hdf5::write_text(h, "cross",
                     tables.cross.cubic.variables > 0 ? key_text(keys.cross) : std::string());
    if (tables.vibration) hdf5::write_text(h, "vibration", key_text(keys.vibration));
    hdf5::write_text(h, "held_out", keys.held_out != 0 ? key_text(keys.held_out) : std::string());
    hdf5::write_number(h, "region_reach", tables.region_reach);
    hdf5::write_number(h, "point_spacing", tables.point_spacing);
    if (tables.friction > 0) hdf5::write_number(h, "friction", tables.friction);
    std::vector<int> middles;
    for (const RegionTable& region : tables.regions) middles.push_back(region.vertex);
    hdf5::write_table(h, "middles", middles.data(), middles.size(), 1);
    if (tables.coarse) write_group(hdf5::make_group(h, "skin"), *tables.coarse);
  });
}

std::string TouchStore::listed_stage(std::uint64_t of) const {
  std::string stage;
  const bool listed = read_file(folder_ / kListFile, kListKind, of, [&](hid_t h) {
    if (hdf5::has(h, kStageName)) stage = hdf5::read_text(h, kStageName);
  });
  return listed ? stage : std::string();
}

std::optional<TouchTables> TouchStore::find_listed(std::uint64_t of) const {
  TouchTables tables;
  TouchKeys keys;
  std::vector<int> middles;
  bool has_cross = false;
  const auto key_of = [](const std::string& text) {
    return static_cast<std::uint64_t>(std::strtoull(text.c_str(), nullptr, 16));
  };
  const bool listed = read_file(folder_ / kListFile, kListKind, of, [&](hid_t h) {
    keys.compliance = key_of(hdf5::read_text(h, "compliance"));
    keys.shell = key_of(hdf5::read_text(h, "shell"));
    keys.regions = key_of(hdf5::read_text(h, "regions"));
    const std::string cross = hdf5::read_text(h, "cross");
    has_cross = !cross.empty();
    keys.cross = key_of(cross);
    // Lists of 0.1 have none.
    if (hdf5::has(h, "vibration")) keys.vibration = key_of(hdf5::read_text(h, "vibration"));
    keys.held_out = key_of(hdf5::read_text(h, "held_out"));
    tables.region_reach = hdf5::read_number(h, "region_reach");
    tables.point_spacing = hdf5::read_number(h, "point_spacing");
    if (hdf5::has(h, "friction")) tables.friction = hdf5::read_number(h, "friction");
    middles = hdf5::read_table<int>(h, "middles").data;
    if (hdf5::has_link(h, "skin")) {
      read_group(hdf5::open_group(h, "skin"), tables.coarse.emplace());
    }
  });
  if (!listed) return std::nullopt;
  if (auto compliance = find_compliance(keys)) {
    tables.compliance = std::move(*compliance);
  } else {
    return std::nullopt;
  }
  auto shell = find_shell(keys);
  if (!shell) return std::nullopt;
  tables.shell = std::move(*shell);
  for (const int vertex : middles) {
    auto region = find_region(keys, vertex);
    if (!region) return std::nullopt;
    tables.regions.push_back(std::move(*region));
  }
  if (has_cross) {
    auto cross = find_cross(keys);
    if (!cross) return std::nullopt;
    tables.cross = std::move(*cross);
  }
  if (keys.vibration != 0) {
    tables.vibration = find_vibration(keys);
    if (!tables.vibration) return std::nullopt;
  }
  // The tables can be used without the held-out touches.
  if (keys.held_out != 0) {
    if (auto touches = find_held_out(keys)) tables.held_out = followed(*touches);
  }
  return tables;
}

void TouchStore::remove_leftovers() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string();
    if (name.find(".part-") != std::string::npos && !is_part_of_running_process(name)) {
      fs::remove(entry.path(), error);
    }
  }
}

}  // namespace palpable
