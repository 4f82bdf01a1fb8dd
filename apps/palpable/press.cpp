// palpable press: prints a body's response to one load, or to several at once.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "apps/palpable/shared_options.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/reduced/loaded_body.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct PressOptions {
  std::filesystem::path body;
  std::vector<std::string> loads;
  std::vector<std::string> set;  // NAME=VALUE
  bool json = false;
};

// What a load is on, "site" or "reaction", and the number of it.
std::pair<const char*, int> kind_of_place(const ReducedBody& body, int place) {
  const auto S = static_cast<int>(body.sites.size());
  return place < S ? std::pair{"site", place} : std::pair{"reaction", place - S};
}

// @param largest  m, the largest displacement, which is that of `vertex`
Json json_of_response(const ReducedBody& body, const std::vector<PlacedLoad>& loads,
                      const PressResponse& response, double largest, Eigen::Index vertex) {
  Json result;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Site& at = load_place(body, loads[k].place);
    const auto [kind, number] = kind_of_place(body, loads[k].place);
    result["loads"].push_back({{kind, number},
                               {"vertex", at.vertex},
                               {"force_n", loads[k].level * at.full_load},
                               {"level", loads[k].level},
                               {"depth_m", response.depth[k]}});
  }
  result["largest_displacement_m"] = largest;
  result["largest_displacement_vertex"] = vertex;
  if (response.largest_von_mises) result["largest_von_mises_pa"] = *response.largest_von_mises;
  result["displacement_error_worst"] = response.error;
  return result;
}

// @param largest, vertex  as in json_of_response()
void print_response(const ReducedBody& body, const std::vector<PlacedLoad>& loads,
                    const PressResponse& response, double largest, Eigen::Index vertex) {
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Site& at = load_place(body, loads[k].place);
    const auto [kind, number] = kind_of_place(body, loads[k].place);
    const Eigen::Vector3d X = body.surface.vertices.col(at.vertex);
    print_text(
        "{:<22}{:.4g} N at {} {} ({:.4g}, {:.4g}, {:.4g}) m, which moves {:.4g} mm along it\n",
        fmt::format("load {}", k + 1), loads[k].level * at.full_load, kind, number, X[0], X[1],
        X[2], 1e3 * response.depth[k]);
  }
  const Eigen::Vector3d where = body.surface.vertices.col(vertex);
  print_text("{:<22}{:.4g} mm, at ({:.4g}, {:.4g}, {:.4g}) m\n", "largest displacement",
             1e3 * largest, where[0], where[1], where[2]);
  if (response.largest_von_mises) {
    print_text("{:<22}{:.3g} kPa (von Mises)\n", "largest stress",
               1e-3 * *response.largest_von_mises);
  } else {
    print_text("{:<22}not known under several loads\n", "largest stress");
  }
  print_text("{:<22}{:.2e} of the displacement, relative L2, at the worst that was checked\n",
             "error", response.error);
}

void press(const PressOptions& options) {
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.body, parse_settings(options.set)));
  const std::vector<PlacedLoad> loads = parse_loads(body, options.loads);
  const PressResponse response = find_press_response(body, loads);
  const Eigen::Map<const Eigen::Matrix3Xf> u(response.displacement.data(), 3,
                                             body.surface.vertex_count());
  Eigen::Index vertex = 0;
  const double largest = static_cast<double>(u.colwise().norm().maxCoeff(&vertex));
  if (options.json) {
    print_json(json_of_response(body, loads, response, largest, vertex));
  } else {
    print_response(body, loads, response, largest, vertex);
  }
}

}  // namespace

void add_press(Command app) {
  auto options = std::make_shared<PressOptions>();
  Command command =
      app.add_subcommand("press", "Say what a body does under one load or several, in numbers");
  command.add_option("body", options->body, "Body file, or the name of an installed one (post)")
      .required();
  command
      .add_option("--load", options->loads,
                  "A point of the skin at rest (m, body frame) and the force there (N). The point "
                  "has to lie in the patch of a site, where the body was loaded when it was baked, "
                  "and the force "
                  "has that load's direction. Several act together, where palpable inspect says "
                  "that the body supports several loads")
      .required()
      .type_name("X,Y,Z=F")
      .further_words(has_equals_sign);
  add_set_option(command, options->set);
  command.add_json(options->json);
  command.footer(
      "These are the loads at the body's sites, also of a body that palpable live and palpable "
      "view "
      "let you touch anywhere: touches there come from an obstacle, and the force follows from it. "
      "Elsewhere a point is refused with the nearest site.\n"
      "Example: palpable press beam.palpable --load 0.15,0,0.05=1.5 --load 0.18,0,0=0.6");
  command.callback([options] {
    options->body = find_body(options->body);
    press(*options);
  });
}

}  // namespace palpable::app
