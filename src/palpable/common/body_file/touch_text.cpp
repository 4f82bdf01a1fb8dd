#include "palpable/common/body_file/touch_text.h"

#include "palpable/common/response/stated_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// The highest order of the load in the displacement.
int order_of(const TouchTables& tables) {
  int order = 1;
  for (const RegionTable& region : tables.regions) {
    order = std::max(order, region.leading() > 0 ? 3 : 2);
  }
  return order;
}

double megabytes(const TouchTables& tables) { return static_cast<double>(bytes_of(tables)) / 1e6; }

double hertz(double omega) { return omega / (2 * std::numbers::pi); }

Json error_scale_json(const std::vector<HeldOutTouch>& touches) {
  const auto scale = error_scale(touches);
  if (!scale) return nullptr;
  return {{"displacement", scale->displacement}, {"von_mises", scale->von_mises}};
}

Json held_out_json(const std::vector<HeldOutTouch>& touches) {
  if (touches.empty()) return nullptr;
  Json result{{"touches", touches_json(touches)}};
  for (const auto& [name, difference] : kHeldOutDifferences) {
    const TouchErrors errors = errors_of(touches, difference);
    result[fmt::format("{}_median", name)] = errors.median;
    result[fmt::format("{}_worst", name)] = errors.worst;
  }
  return result;
}

}  // namespace

std::string vibration_text(const std::optional<VibrationTable>& table) {
  if (!table) return "no mass: it follows what presses it, and does not swing back";
  return fmt::format(
      "{} vibration modes from {:.3g} to {:.3g} Hz, damping ratio {:g}; {:.3g} kg of {:g} kg/m^3",
      table->mode_count(), hertz(table->omega.front()), hertz(table->omega.back()),
      table->damping(), table->mass, table->density);
}

Json vibration_json(const std::optional<VibrationTable>& table) {
  if (!table) return nullptr;
  Json frequencies = Json::array();
  for (const double omega : table->omega) frequencies.push_back(hertz(omega));
  return {{"modes", table->mode_count()},      {"frequencies_hz", std::move(frequencies)},
          {"damping_ratio", table->damping()}, {"loss_factor", table->loss_factor},
          {"density", table->density},         {"mass", table->mass}};
}

std::string touch_text(const std::optional<TouchTables>& tables) {
  if (!tables) return "at its sites, one at a time";
  constexpr const char* kOrders[] = {"", "1st order: small touches", "2nd order", "3rd order"};
  std::string text = fmt::format("anywhere, several at a time, {}", kOrders[order_of(*tables)]);
  if (!tables->regions.empty()) text += fmt::format("; {} regions", tables->regions.size());
  if (tables->coarse) {
    text += fmt::format("; carried by a coarser skin of {} vertices",
                        tables->coarse->surface.vertex_count());
  }
  if (tables->friction > 0) text += fmt::format("; friction {:g}", tables->friction);
  text += fmt::format("; {:.3g} MB", megabytes(*tables));
  if (tables->vibration) text += "; " + vibration_text(tables->vibration);
  if (!tables->held_out.empty()) text += "; " + held_out_text(tables->held_out);
  if (const auto scale = error_scale(tables->held_out)) {
    text += fmt::format(
        "; states its error live, as calibrated by these touches: its indicators of error times "
        "{:.2f} for displacement, times {:.2f} for stress",
        scale->displacement, scale->von_mises);
  } else if (!tables->held_out.empty()) {
    text += "; does not state its error live: baked by an older version, or too few touches";
  }
  return text;
}

std::string touch_text(const Result<std::optional<TouchTables>>& tables) {
  return tables.ok() ? touch_text(tables.value()) : "not as baked: " + tables.problem().message;
}

Json touches_json(const std::vector<HeldOutTouch>& touches) {
  Json rows = Json::array();
  for (const HeldOutTouch& touch : touches) {
    Json row{{"obstacle", name_of(touch.thing)}, {"depth_mm", 1e3 * touch.depth}};
    for (const auto& [name, difference] : kHeldOutDifferences) row[name] = touch.*difference;
    rows.push_back(std::move(row));
  }
  return rows;
}

Json touch_json(const std::optional<TouchTables>& tables) {
  if (!tables) return nullptr;
  return {
      {"response_order", order_of(*tables)},
      {"coarse_vertices", tables->coarse ? Json(tables->coarse->surface.vertex_count()) : Json()},
      {"clusters", tables->compliance.clusters},
      {"regions", tables->regions.size()},
      {"cross_modes", tables->cross.cubic.variables},
      {"table_mb", megabytes(*tables)},
      {"friction", tables->friction},
      {"vibration", vibration_json(tables->vibration)},
      {"held_out", held_out_json(tables->held_out)},
      {"error_estimate_factors", error_scale_json(tables->held_out)}};
}

std::string touch_line(const TouchTables& tables) {
  const ComplianceTable& c = tables.compliance;
  std::string line = fmt::format(
      "compliance of {} vertices in {} clusters: {} directions each between those far apart, as it "
      "is "
      "between each vertex and its {:.0f} neighbours (mean)",
      c.vertices, c.clusters, c.basis.width,
      static_cast<double>(c.neighbours.size()) / static_cast<double>(c.vertices));
  if (!tables.regions.empty()) {
    const RegionTable& first = tables.regions.front();
    line += fmt::format("; {} regions of {} modes, {} of them to the third order",
                        tables.regions.size(), first.mode_count(), first.leading());
  }
  if (tables.cross.cubic.variables > 0) {
    line +=
        fmt::format("; {} modes in which touches act on each other", tables.cross.cubic.variables);
  }
  if (tables.vibration) {
    line += fmt::format("; {} vibration modes up to {:.3g} Hz", tables.vibration->mode_count(),
                        hertz(tables.vibration->omega.back()));
  }
  if (tables.shell.element_count() > 0) {
    line += fmt::format("; stress from {} elements round the skin with {} nodes",
                        tables.shell.element_count(), tables.shell.nodes());
  }
  return line;
}

std::string touch_text(const ModalTables& tables, const ReducedBody& body) {
  return fmt::format(
      "anywhere, several at a time, also by other bodies; energy in {} modes; {:.3g} MB",
      body.several->mode_count(), static_cast<double>(bytes_of(tables)) / 1e6);
}

Json touch_json(const ModalTables& tables, const ReducedBody& body) {
  return {{"energy_modes", body.several->mode_count()},
          {"table_mb", static_cast<double>(bytes_of(tables)) / 1e6}};
}

}  // namespace palpable
