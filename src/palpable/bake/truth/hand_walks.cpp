#include "palpable/bake/truth/hand_walks.h"

#include "palpable/bake/truth/frame_steps.h"
#include "palpable/common/base/parallel_work.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;

std::string why_not_scored(double path_change, bool began_before, double held_entry) {
  if (held_entry > kHeldMatters) return "presses skin that the support holds";
  // What friction held before the clip began is not known.
  if (began_before) return "touched from the first frame on: what friction holds is not known";
  if (path_change <= kPathMatters) return {};
  return fmt::format("depends on the way: half the step changes it by {:.1f} %",
                     100.0 * path_change);
}

namespace {

// Whether two walks differ so much that a third one in shorter steps is worth its time: by half of
// what matters, because here all nodes count, not only those of a skin.
bool differs(const Episode& episode, const Walked& fine, const Walked& coarse,
             const Preloaded* preloaded) {
  return std::any_of(episode.wanted.begin(), episode.wanted.end(), [&](int frame) {
    const auto one = fine.frames.find(frame), other = coarse.frames.find(frame);
    if (one == fine.frames.end()) return false;
    if (other == coarse.frames.end()) return true;
    const Matrix3Xd& u = one->second.displacement;
    const Matrix3Xd rest = preloaded != nullptr ? preloaded->rest : Matrix3Xd();
    return relative_change(u, other->second.displacement, {}, rest) > 0.5 * kPathMatters;
  });
}

}  // namespace

void follow_hand(const EquilibriumSolver& solver, const ClipHands& hands,
                 const std::vector<Episode>& episodes, const HandWalkSettings& settings,
                 const Progress& progress,
                 const std::function<void(const Episode&, const Walked& by_half_steps,
                                          const Walked& by_steps)>& keep) {
  double to_do = 0, done = 0;
  for (const Episode& episode : episodes) {
    to_do += 2.0 * (episode.wanted.back() - episode.first + 1);
  }
  const bool rubs = settings.contact.friction > 0.0 || settings.contact.mutual_friction > 0.0;
  const FrameSteps frame_steps(hands, solver.model().mesh);
  std::mutex mutex;
  // @param shorter  factor by which steps are shorter than those of the first walk
  const auto walk_of = [&](const Episode& episode, int shorter) {
    const auto way = [&](double t) { return Obstacle{.capsules = capsules_at(hands, t)}; };
    ContactWalk walk(solver, way, std::max(0, episode.first - 1), settings.contact,
                     settings.preloaded);
    Walked walked;
    double held_entry = 0.0;
    for (int frame = episode.first; frame <= episode.wanted.back(); ++frame) {
      const int steps =
          rubs ? frame_steps.count(frame, walk.now().displacement, kFrictionStep, shorter)
               : shorter;
      const bool is_wanted =
          std::find(episode.wanted.begin(), episode.wanted.end(), frame) != episode.wanted.end();
      for (int step = 1; step <= steps; ++step) {
        const double t = frame - 1 + static_cast<double>(step) / steps;
        if (step == steps && is_wanted ? walk.advance(t) : walk.pass(t)) continue;
        walked.why_stopped = walk.why_stopped();
        return walked;
      }
      {
        const std::lock_guard lock(mutex);
        report(progress, {"following the hand", ++done, std::max(1.0, to_do), ""});
      }
      const ContactState& now = walk.now();
      // Friction carries on what was dragged there.
      held_entry = std::max(rubs ? held_entry : 0.0, now.held_entry);
      if (!is_wanted) continue;
      WalkedFrame& solution = walked.frames[frame];
      solution = {now.displacement, now.force, now.centre, now.entry_between, held_entry, {}, {}};
      if (!settings.contact.mutual) continue;
      solution.hand_forces = walk.nodal_forces();
      solution.other_forces = walk.mutual_nodal_forces();
    }
    return walked;
  };
  // Jobs are handed out one by one: 2 e follows episode e in half steps, 2 e + 1 in whole ones.
  std::vector<std::optional<Walked>> results(2 * episodes.size());
  work_in_parallel(static_cast<int>(results.size()), settings.threads, "", {}, [&](int job) {
    const auto at = static_cast<std::size_t>(job), first = at - at % 2;
    const Episode& episode = episodes[first / 2];
    Walked walked = walk_of(episode, at == first ? 2 : 1);
    {
      const std::lock_guard lock(mutex);
      results[at] = std::move(walked);
      if (!results[first] || !results[first + 1]) return;
    }
    Walked fine = std::move(*results[first]), coarse = std::move(*results[first + 1]);
    if (rubs && differs(episode, fine, coarse, settings.preloaded)) {
      {
        const std::lock_guard lock(mutex);
        to_do += episode.wanted.back() - episode.first + 1;
      }
      for (auto& [frame, solution] : walk_of(episode, 4).frames) {
        if (const auto finer = fine.frames.find(frame); finer != fine.frames.end()) {
          coarse.frames[frame] = std::move(finer->second);
        }
        fine.frames[frame] = std::move(solution);
      }
    }
    const std::lock_guard lock(mutex);
    keep(episode, fine, coarse);
  });
}

double relative_change(const Matrix3Xd& a, const Matrix3Xd& b, const std::vector<int>& nodes,
                       const Matrix3Xd& rest) {
  const auto from_rest = [&](const Matrix3Xd& u) -> Matrix3Xd {
    const Matrix3Xd moved = rest.cols() == 0 ? u : Matrix3Xd(u - rest);
    return nodes.empty() ? moved : Matrix3Xd(moved(Eigen::all, nodes));
  };
  const Matrix3Xd one = from_rest(a), other = from_rest(b);
  const double whole = std::max(one.norm(), other.norm());
  return whole > 0 ? (one - other).norm() / whole : 0;
}

}  // namespace palpable
