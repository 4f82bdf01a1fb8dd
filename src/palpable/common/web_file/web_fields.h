/// @file
/// The values and arrays of a delivery file (web_file.h), listed once for writing and reading: each
/// function passes every member of a structure, with its name in the file, to an archive. The
/// archive writes the member (web_file_writer.cpp) or reads it (web_file.cpp). When writing, the
/// structures are const.
///
/// An archive has
///
///     number, text        a value of the header
///     column              (n) a std::vector or an Eigen vector as an array
///     matrix              (r x c) an Eigen matrix, by columns: an array of shape [c, r]
///     optional            what need not be there; a value says that it is
///     group               names within begin with "group/"
///     rows, form, places, energy, materials, touches, regions
///                         structures that are stored in another form than they have in memory
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/touch_tables.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpable::web {

inline constexpr std::string_view kFormat = "palpable web body";
inline constexpr std::size_t kPrefix = 32;      ///< bytes before the header
inline constexpr std::size_t kHashedFrom = 24;  ///< the first byte that the checksum covers
inline constexpr std::size_t kAlignment = 16;

/// The name of a number's type in the header.
inline std::string_view type_name(std::int16_t) { return "int16"; }
inline std::string_view type_name(std::int32_t) { return "int32"; }
inline std::string_view type_name(std::uint8_t) { return "uint8"; }
inline std::string_view type_name(float) { return "float32"; }
inline std::string_view type_name(double) { return "float64"; }

template <class Archive, class Surface>
void visit_surface(Archive& a, Surface& surface) {
  a.matrix("vertices", surface.vertices);
  a.matrix("triangles", surface.triangles);
}

template <class Archive, class Course>
void visit_course(Archive& a, Course& course) {
  a.column("modes", course.modes);
  a.column("pooled", course.pooled);
  a.matrix("snapshots", course.snapshots);
}

template <class Archive, class Errors>
void visit_error(Archive& a, Errors& error) {
  a.number("displacement_pooled", error.displacement_pooled);
  a.number("displacement_worst", error.displacement_worst);
  a.number("stress_pooled", error.stress_pooled);
  a.number("stress_worst", error.stress_worst);
  a.number("displacement_rounding", error.displacement_rounding);
  a.number("stress_rounding", error.stress_rounding);
  a.optional("between_sites", error.between_sites, [&](auto& e) { a.number("value", e); });
  const auto course = [&](auto& c) { visit_course(a, c); };
  a.optional("displacement_course", error.displacement_course, course);
  a.optional("stress_course", error.stress_course, course);
  a.optional("von_mises_course", error.von_mises_course, course);
  a.optional("held_out", error.held_out, [&](auto& record) {
    a.column("levels", record.levels);
    a.matrix("displacement", record.displacement);
    a.number("displacement_pooled", record.displacement_pooled);
    a.matrix("von_mises", record.von_mises);
  });
}

/// The body without its name, its fields and its provenance.
template <class Archive, class Body>
void visit_body(Archive& a, Body& body) {
  a.text("material", body.material);
  a.text("method", body.method);
  a.number("largest_von_mises", body.largest_von_mises);
  a.group("surface", [&] {
    visit_surface(a, body.surface);
    a.column("fixed", body.fixed);
  });
  a.group("sites", [&] {
    a.places(body.sites);
    a.matrix("press_depth", body.press_depth);
    a.matrix("depth_slope", body.depth_slope);
    a.matrix("level_slope", body.level_slope);
  });
  a.group("error", [&] { visit_error(a, body.error); });
  a.optional("several_loads", body.several, [&](auto& several) {
    a.matrix("modes", several.modes);
    a.energy(several.energy, several.modes.cols());
    a.number("checked", several.checked);
    a.number("error_median", several.error_median);
    a.number("error_worst", several.error_worst);
    a.group("reactions", [&] { a.places(several.reactions); });
  });
}

template <class Archive, class Table>
void visit_compliance(Archive& a, Table& table) {
  a.number("vertices", table.vertices);
  a.number("clusters", table.clusters);
  a.column("cluster_of", table.cluster_of);
  a.rows("basis", table.basis);
  a.rows("beyond", table.beyond);
  a.column("far_first", table.far_first);
  a.column("far_second", table.far_second);
  a.rows("couplings", table.couplings);
  a.column("first", table.first);
  a.column("neighbours", table.neighbours);
  a.column("near", table.near);
  a.column("near_scale", table.near_scale);
}

template <class Archive, class Table>
void visit_region(Archive& a, Table& table) {
  int leading = table.leading();
  a.number("vertex", table.vertex);
  a.number("leading", leading);
  a.column("vertices", table.vertices);
  a.rows("modes", table.modes);
  a.rows("far_shapes", table.far_shapes);
  a.rows("far_shares", table.far_shares);
  a.form("cubic", table.cubic, static_cast<int>(table.modes.width), 3);
  a.form("quartic", table.quartic, leading, 4);
}

template <class Archive, class Table>
void visit_shell(Archive& a, Table& table) {
  a.matrix("stress_free", table.stress_free);
  a.matrix("preload", table.preload);
  a.number("element_nodes", table.element_nodes);
  a.column("elements", table.elements);
  a.materials(table.materials);
  a.column("material_of", table.material_of);
  a.column("first", table.first);
  a.column("points", table.points);
  a.column("weights", table.weights);
}

template <class Archive, class Tables>
void visit_touch(Archive& a, Tables& tables) {
  a.optional("skin", tables.coarse, [&](auto& coarse) {
    visit_surface(a, coarse.surface);
    a.column("fixed", coarse.fixed);
  });
  a.group("compliance", [&] { visit_compliance(a, tables.compliance); });
  a.regions(tables.regions, [&](auto& region) { visit_region(a, region); });
  a.group("cross", [&] {
    a.rows("modes", tables.cross.modes);
    a.form("cubic", tables.cross.cubic, static_cast<int>(tables.cross.modes.width), 3);
  });
  a.group("shell", [&] { visit_shell(a, tables.shell); });
  a.number("region_reach", tables.region_reach);
  a.number("point_spacing", tables.point_spacing);
  a.group("held_out", [&] { a.touches(tables.held_out); });
  a.optional("vibration", tables.vibration, [&](auto& vibration) {
    a.number("density", vibration.density);
    a.number("mass", vibration.mass);
    a.number("loss_factor", vibration.loss_factor);
    a.column("omega", vibration.omega);
    a.matrix("shapes", vibration.shapes);
  });
}

template <class Archive, class Tables>
void visit_modal(Archive& a, Tables& tables) {
  a.group("shell", [&] { visit_shell(a, tables.shell); });
  a.matrix("inner_modes", tables.inner_modes);
  a.number("half_space", tables.half_space);
  a.number("point_spacing", tables.point_spacing);
}

/// "region_0007"
[[nodiscard]] std::string region_name(std::size_t k);

}  // namespace palpable::web
