#include "palpable/bake/pipeline/solution_service.h"

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/touch_bake/full_solution.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/solution_messages.h"
#include "palpable/common/response/touch_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>
#include <span>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

// Largest message with a load, bytes; no load of a live run needs as much.
constexpr std::size_t kLargestLoad = std::size_t{1} << 20;

bool are_on(const SkinResponse& skin, const std::vector<VertexForce>& forces) {
  return std::all_of(forces.begin(), forces.end(), [&](const VertexForce& f) {
    return 0 <= f.vertex && f.vertex < skin.vertex_count() && f.force.allFinite();
  });
}

}  // namespace

std::unique_ptr<FullBody> exact_body(const BodyDescription& description) {
  const BodyProblem problem = pose_for_touch(description);
  return std::make_unique<FullBody>(problem.model, problem.mesh.boundary, problem.preload,
                                    EquilibriumSettings{.tolerance = kFullSolutionTolerance});
}

std::string other_body_text(const BodyDescription& description, const ReducedBody& body) {
  // Corners that remeshing rounds: an octahedron of 100 mm with edges of 12 mm loses 7 mm.
  constexpr double kLikelySize = 0.25;
  // Remeshing leaves a mean edge within some 20 % of the one that was asked for.
  constexpr double kLikelyEdge = 1.5;
  const std::string& stated = body.provenance.material;
  const std::string material = materials_line(description);
  if (!stated.empty() && stated != material) {
    return fmt::format("describes another body than '{}': its material is '{}', the body's '{}'",
                       body.name, material, stated);
  }
  if (const auto& edge = description.shape.edge) {
    const double mean = mean_edge_length(body.surface), ratio = mean / *edge;
    if (ratio > kLikelyEdge || ratio * kLikelyEdge < 1.0) {
      return fmt::format(
          "describes another mesh than that of '{}': its edges are {:.3g} mm, the body's {:.3g} mm",
          body.name, 1e3 * *edge, 1e3 * mean);
    }
  }
  const Eigen::Vector3d here = size_of_body(description);
  const Eigen::Vector3d there = extent_of(body.surface.vertices);
  if (std::abs(here.norm() - there.norm()) <= kLikelySize * there.norm()) return {};
  return fmt::format("describes another body than '{}': it is {}, the body {}", body.name,
                     size_text(here), size_text(there));
}

bool serve_full_solutions(const std::function<std::unique_ptr<FullBody>()>& make_body, int in,
                          int out) {
  std::vector<std::byte> bytes;
  std::unique_ptr<FullBody> body;
  try {
    body = make_body();
    write_ready(body->skin.shell_count(), bytes);
  } catch (const Error& error) { write_sorry(error.what(), bytes); }
  if (!write_all(out, bytes)) return false;
  if (!body) return true;
  ExactMessages messages(kLargestLoad);
  std::vector<VertexForce> forces;
  for (;;) {
    const std::span<std::byte> room = messages.room();
    const ssize_t count = ::read(in, room.data(), room.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count == 0;
    messages.add(static_cast<std::size_t>(count));
    while (const auto message = messages.next()) {
      if (message->kind != ExactMessage::Kind::kLoad) return false;
      message->read_load(forces);
      if (!are_on(body->skin, forces)) return false;
      write_solution(message->number,
                     full_solution(body->solver, body->skin, body->presses.preloaded(), forces),
                     bytes);
      if (!write_all(out, bytes)) return false;
    }
    if (messages.broken()) return false;
  }
}

}  // namespace palpable
