#include "palpable/common/body_file/body_facts.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

namespace palpable {
namespace {

// The range of one figure over all sites.
template <class Figure>
std::string range_text(const ReducedBody& body, Figure figure) {
  double least = figure(0);
  double most = least;
  for (std::size_t s = 1; s < body.sites.size(); ++s) {
    least = std::min(least, figure(s));
    most = std::max(most, figure(s));
  }
  return fmt::format("{:.3g} to {:.3g}", least, most);
}

bool has_blocks(const SeparatedField& field) { return field.largest_block() < field.mode_count(); }

std::string modes_text(const SeparatedField& field, double pooled, double worst, double rounding) {
  std::string text = has_blocks(field) ? fmt::format("{} modes, up to {} of its own per site",
                                                     field.mode_count(), field.largest_block())
                                       : fmt::format("{} modes for all sites", field.mode_count());
  text += fmt::format("; off by {} over all snapshots together, {} in the worst one",
                      percent_text(pooled), percent_text(worst));
  if (rounding > 0) {
    text += fmt::format("; stored in half precision, which adds {}", percent_text(rounding));
  }
  return text;
}

// The number of places, and the box around them.
std::string places_text(const ReducedBody& body, const std::vector<Site>& places) {
  Eigen::AlignedBox3d box;
  for (const Site& place : places) box.extend(body.surface.vertices.col(place.vertex));
  std::string text = fmt::format("{}, at", places.size());
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("{} {} {:.1f} to {:.1f}", i > 0 ? "," : "", "xyz"[i], 1e3 * box.min()[i],
                        1e3 * box.max()[i]);
  }
  return text + " mm";
}

std::string several_text(const ReducedBody& body) {
  if (!body.several) return "no: of these, one at a time";
  const SeveralLoads& several = *body.several;
  std::string text = "yes, displacement only: presses at the sites, together up to one full load";
  if (!several.reactions.empty()) {
    text += fmt::format(", and pushes back at {}, together up to one of {:.3g} N",
                        places_text(body, several.reactions), several.reactions[0].full_load);
  }
  text += fmt::format("; {} modes", several.mode_count());
  if (several.checked > 0) {
    text += fmt::format("; displacement off by {} in the median of {} pairs, {} in the worst",
                        percent_text(several.error_median), several.checked,
                        percent_text(several.error_worst));
  }
  return text;
}

constexpr double kTyped = 1e-14;  // accuracy of numbers that somebody typed, see number_text()

struct LargerUnit {
  double value;
  const char* unit;
};

// A pressure in the largest of Pa, kPa, MPa and GPa in which it is 1 or more.
// @param thousand  what counts as 1000 kPa, so as 1 MPa: less than 1000 where the text is rounded
LargerUnit in_larger_unit(double pascals, double thousand = 1e3) {
  constexpr const char* kUnits[] = {"Pa", "kPa", "MPa", "GPa"};
  int unit = 0;
  for (; unit < 3 && std::abs(pascals) >= thousand; ++unit) pascals /= 1e3;
  return {pascals, kUnits[unit]};
}

std::string largest_stress_text(double von_mises) {
  const auto [value, unit] = in_larger_unit(von_mises, 999.5);
  return fmt::format("{:.3g} {} (von Mises)", value, unit);
}

// Collects facts under headings.
class FactList {
 public:
  void begin(const char* heading) { groups_.push_back({heading, {}}); }
  void add(const char* name, std::string text) {
    groups_.back().lines.emplace_back(name, std::move(text));
  }
  [[nodiscard]] std::vector<FactGroup> groups() { return std::move(groups_); }

 private:
  std::vector<FactGroup> groups_;
};

void add_shape(const ReducedBody& body, const std::filesystem::path& file, FactList& facts) {
  const Eigen::Vector3d low = body.surface.vertices.rowwise().minCoeff();
  const Eigen::Vector3d size = body.surface.vertices.rowwise().maxCoeff() - low;
  const auto fixed = std::count(body.fixed.begin(), body.fixed.end(), std::uint8_t{1});
  facts.begin("shape and material");
  facts.add("body", body.name);
  facts.add("file", fmt::format("{}, {:.1f} MB, version {} of the format", file.string(),
                                static_cast<double>(std::filesystem::file_size(file)) / 1e6,
                                kBodyFileVersion));
  facts.add("size",
            fmt::format("{:.1f} x {:.1f} x {:.1f} mm, {:.1f} cm^3", size.x() * 1e3, size.y() * 1e3,
                        size.z() * 1e3, enclosed_volume(body.surface) * 1e6));
  facts.add("surface",
            fmt::format("{} vertices, {} triangles; {} vertices held by the support",
                        body.surface.vertex_count(), body.surface.triangle_count(), fixed));
  facts.add("inside", body.volume ? fmt::format("{} nodes, {} tetrahedra",
                                                body.volume->nodes.cols(), body.volume->tets.cols())
                                  : std::string("none, the boundary only"));
  facts.add("material", with_larger_pascals(body.material));
  facts.add("largest stress", largest_stress_text(body.largest_von_mises));
}

void add_loads(const ReducedBody& body, std::string_view setting, FactList& facts) {
  const Eigen::Index last = body.levels().size() - 1;
  facts.begin("loads for which it was solved");
  facts.add("sites", places_text(body, body.sites));
  facts.add("levels", fmt::format("{} of the load, and rest", last));
  facts.add("full load", range_text(body, [&](std::size_t s) { return body.sites[s].full_load; }) +
                             " N per site");
  facts.add("press at full load", range_text(body, [&](std::size_t s) {
                                    return body.press_depth(last, static_cast<Eigen::Index>(s)) *
                                           1e3;
                                  }) + " mm");
  for (const FurtherParameter& p : body.further) {
    facts.add("parameter", fmt::format("{}: {} to {} from {} samples, {} unless {}", p.name,
                                       number_text(p.samples[0], kTyped),
                                       number_text(p.samples[p.samples.size() - 1], kTyped),
                                       p.samples.size(), number_text(p.value, kTyped), setting));
  }
  facts.add("between levels", "cubic splines of depth, displacement and stress");
  facts.add("between sites",
            "nothing: the nearest one counts" +
                (body.error.between_sites ? fmt::format(", wrong by {:.0f} % in the median",
                                                        100 * *body.error.between_sites)
                                          : std::string("; what that costs is not known")));
  facts.add("several loads", several_text(body));
}

}  // namespace

std::string percent_text(double ratio) { return fmt::format("{:.3g} %", 100 * ratio); }

std::string with_larger_pascals(std::string_view text) {
  constexpr std::string_view kUnit = " Pa";
  std::string result;
  std::size_t from = 0;
  for (std::size_t at = text.find(kUnit); at != text.npos; at = text.find(kUnit, at + 1)) {
    const std::size_t end = at + kUnit.size();
    const bool is_word = end < text.size() && std::isalnum(static_cast<unsigned char>(text[end]));
    const std::size_t blank = text.find_last_of(" (", at - 1);
    const std::size_t begin = at == 0 ? 0 : blank == text.npos ? 0 : blank + 1;
    const std::optional<double> value = to_number(text.substr(begin, at - begin));
    if (is_word || !value || std::abs(*value) < 1e3 || begin < from) continue;
    result += text.substr(from, begin - from);
    const auto [larger, unit] = in_larger_unit(*value);
    result += fmt::format("{} {}", number_text(larger), unit);
    from = end;
  }
  return result += text.substr(from);
}

std::vector<FactGroup> body_facts(const ReducedBody& body, const std::filesystem::path& file,
                                  std::string_view setting) {
  FactList facts;
  add_shape(body, file, facts);
  add_loads(body, setting, facts);
  facts.begin("reduced model, error of its fields against full finite elements (relative, L2)");
  facts.add("displacement",
            modes_text(body.displacement, body.error.displacement_pooled,
                       body.error.displacement_worst, body.error.displacement_rounding));
  facts.add("stress", modes_text(body.stress, body.error.stress_pooled, body.error.stress_worst,
                                 body.error.stress_rounding));
  return facts.groups();
}

Json json_of(const ReducedBody& body) {
  Json result;
  result["name"] = body.name;
  result["vertices"] = body.surface.vertex_count();
  result["triangles"] = body.surface.triangle_count();
  result["sites"] = body.sites.size();
  result["levels"] = body.levels().size() - 1;
  result["displacement_modes"] = body.displacement.mode_count();
  result["stress_modes"] = body.stress.mode_count();
  result["file_version"] = kBodyFileVersion;
  result["basis"] = has_blocks(body.displacement) ? "per-site" : "global";
  result["displacement_modes_per_site"] = body.displacement.largest_block();
  result["stress_modes_per_site"] = body.stress.largest_block();
  result["displacement_rounding"] = body.error.displacement_rounding;
  result["stress_rounding"] = body.error.stress_rounding;
  if (body.error.between_sites) result["between_sites_error"] = *body.error.between_sites;
  for (const FurtherParameter& p : body.further) {
    result["parameters"][p.name] = {{"first", p.samples[0]},
                                    {"last", p.samples[p.samples.size() - 1]},
                                    {"samples", p.samples.size()},
                                    {"value", p.value}};
  }
  if (body.several) {
    result["several_loads"] = {{"modes", body.several->mode_count()},
                               {"reactions", body.several->reactions.size()},
                               {"pairs_checked", body.several->checked},
                               {"error_median", body.several->error_median},
                               {"error_worst", body.several->error_worst}};
  } else {
    result["several_loads"] = nullptr;  // one at a time
  }
  result["volume_nodes"] = body.volume ? body.volume->nodes.cols() : 0;
  result["displacement_error"] = body.error.displacement_pooled;
  result["displacement_error_worst"] = body.error.displacement_worst;
  result["stress_error"] = body.error.stress_pooled;
  result["stress_error_worst"] = body.error.stress_worst;
  result["largest_von_mises_pa"] = body.largest_von_mises;
  result["material"] = body.material;
  if (const std::string_view stage = key_of(body.provenance.stage); !stage.empty()) {
    result["stage"] = stage;
  }
  for (const auto& [key, value] : lines_of(body.provenance)) result["provenance"][key] = value;
  return result;
}

}  // namespace palpable
