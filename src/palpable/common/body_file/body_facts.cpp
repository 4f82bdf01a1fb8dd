#include "palpable/common/body_file/body_facts.h"

#include "palpable/common/body_file/body_file.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>

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
  text += fmt::format("; error {:.2e} over all snapshots, {:.2e} in the worst", pooled, worst);
  if (rounding > 0) text += fmt::format("; stored in half precision, which adds {:.1e}", rounding);
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
  if (!body.several) return "no: one load at a time";
  const SeveralLoads& several = *body.several;
  std::string text = "yes, displacement only: presses at the sites, together up to one full load";
  if (!several.reactions.empty()) {
    text += fmt::format(", and pushes back at {}, together up to one of {:.3g} N",
                        places_text(body, several.reactions), several.reactions[0].full_load);
  }
  text += fmt::format("; {} modes", several.mode_count());
  if (several.checked > 0) {
    text += fmt::format("; error {:.2e} at the median of {} pairs, {:.2e} at the worst",
                        several.error_median, several.checked, several.error_worst);
  }
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> body_facts(const ReducedBody& body,
                                                            const std::filesystem::path& file,
                                                            std::string_view setting) {
  const Eigen::Vector3d low = body.surface.vertices.rowwise().minCoeff();
  const Eigen::Vector3d size = body.surface.vertices.rowwise().maxCoeff() - low;
  const auto fixed = std::count(body.fixed.begin(), body.fixed.end(), std::uint8_t{1});
  const Eigen::Index last = body.levels().size() - 1;
  std::vector<std::pair<std::string, std::string>> facts;
  const auto line = [&facts](const char* name, std::string text) {
    facts.emplace_back(name, std::move(text));
  };
  line("body", body.name);
  line("file",
       fmt::format("{}, {:.1f} MB, layout {}", file.string(),
                   static_cast<double>(std::filesystem::file_size(file)) / 1e6, kBodyFileVersion));
  line("size", fmt::format("{:.1f} x {:.1f} x {:.1f} mm, {:.1f} cm^3", size.x() * 1e3,
                           size.y() * 1e3, size.z() * 1e3, enclosed_volume(body.surface) * 1e6));
  line("surface", fmt::format("{} vertices, {} triangles; {} vertices held by the support",
                              body.surface.vertex_count(), body.surface.triangle_count(), fixed));
  line("material", body.material);
  line("sites", places_text(body, body.sites));
  line("levels", fmt::format("{} of the load, and rest", last));
  line("full load",
       range_text(body, [&](std::size_t s) { return body.sites[s].full_load; }) + " N per site");
  line("press at full load", range_text(body, [&](std::size_t s) {
                               return body.press_depth(last, static_cast<Eigen::Index>(s)) * 1e3;
                             }) + " mm");
  for (const FurtherParameter& p : body.further) {
    line("parameter",
         fmt::format("{}: {:g} to {:g} from {} samples, {:g} unless {}", p.name, p.samples[0],
                     p.samples[p.samples.size() - 1], p.samples.size(), p.value, setting));
  }
  line("between levels", "cubic splines of depth, displacement and stress");
  line("between sites",
       "nothing: the nearest one counts" +
           (body.error.between_sites
                ? fmt::format(", wrong by {:.0f} % in the median", 100 * *body.error.between_sites)
                : std::string("; what that costs is not known")));
  line("displacement", modes_text(body.displacement, body.error.displacement_pooled,
                                  body.error.displacement_worst, body.error.displacement_rounding));
  line("stress", modes_text(body.stress, body.error.stress_pooled, body.error.stress_worst,
                            body.error.stress_rounding));
  line("several loads", several_text(body));
  line("inside", body.volume ? fmt::format("{} nodes, {} tetrahedra", body.volume->nodes.cols(),
                                           body.volume->tets.cols())
                             : std::string("none, the boundary only"));
  line("largest stress", fmt::format("{:.3g} kPa (von Mises)", body.largest_von_mises / 1e3));
  return facts;
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
  result["layout"] = kBodyFileVersion;
  result["form"] = has_blocks(body.displacement) ? "per-site" : "global";
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
  for (const auto& [key, value] : lines_of(body.provenance)) result["provenance"][key] = value;
  return result;
}

}  // namespace palpable
