#include "palpable/bake/pipeline/solution_service.h"

#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/touch_bake/full_solution.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/response/solution_messages.h"
#include "palpable/common/response/touch_solver.h"

#include <algorithm>
#include <cerrno>
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
