/// @file
/// Full-order solutions for the loads on a touched body, from a process that runs beside
/// the session: when they are requested, and when they are taken up (response/refinement.h
/// describes what they then do).
///
///     frame n              requested, for the load of this frame's state
///     frame n + latency    taken up, or dropped if it has not arrived
///
/// A solution is never taken up earlier than that. Where frames wait for the loop, the loop also
/// waits for the solution, so that a recording gives the same bytes each time it is played. With a
/// live camera it depends on the clock which solutions are taken up: a recording stores what was
/// done in which frame (RefinerStep), and its replay does the same, without the process.
#pragma once

#include "palpable/common/base/child_process.h"
#include "palpable/common/response/solution_messages.h"
#include "palpable/common/response/touch_solver.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct RefinerSettings {
  std::filesystem::path program = {};      ///< palpable-bake
  std::filesystem::path description = {};  ///< the body's, as text
  std::filesystem::path body = {};         ///< its file, with which the text is compared; or empty
  int latency = 6;                         ///< frames, >= 1; 0.2 s
  bool waits = true;                       ///< false: a solution that is late is dropped
  double patience = 30;                    ///< s to wait for a solution, if `waits`
  double patience_at_first = 600;          ///< s to wait for the body's mesh and factorisation
};

/// What the refiner did in one frame, as far as the body's state depends on it.
struct RefinerStep {
  bool asked = false;      ///< a solution was requested after the frame's contact
  Eigen::Matrix3Xf exact;  ///< (3 x W) m, taken up before its contact; no columns: none was
};

struct RefinerCounts {
  int asked = 0;
  int taken_up = 0;
  int late = 0;     ///< dropped because they had not arrived
  int refused = 0;  ///< the body does not bear the load by itself
};

/// For one body. Once it has had its room it allocates nothing, and it blocks only where its
/// settings say that it waits.
class Refiner {
 public:
  /// What is wrong with the description, before a run begins: the line that `program refine
  /// --check` prints; empty if it prints nothing. Without it a mistake would show at the first
  /// touch only. The program reads the text, but makes no mesh. What it prints is bounded, and so
  /// is the time that it may take.
  [[nodiscard]] static std::string trouble_of_description(const RefinerSettings& settings);

  /// Starts the process. A problem when it cannot be started.
  [[nodiscard]] static Result<Refiner> start(const RefinerSettings& settings);

  /// A refiner without a process that repeats the steps of a recorded one.
  /// @param step_of  fills the step of the n-th frame, from 0 on; called once for each, in order
  [[nodiscard]] static Refiner repeating(std::function<void(int n, RefinerStep& step)> step_of);

  /// To be called before a frame's contact: takes up the solution that is due.
  void begin_frame(TouchSolver& solver, TouchState& state);
  /// To be called after it: requests the solution for the state's load if no other is pending.
  /// @param report  of this frame
  void end_frame(TouchSolver& solver, const TouchState& state, const TouchReport& report);

  [[nodiscard]] const RefinerCounts& counts() const { return counts_; }
  /// What was done in the last frame: whether a solution was requested, and the solution that was
  /// taken up, (3 x W) m, valid until the next frame; null: none was.
  [[nodiscard]] bool asked() const { return requested_now_; }
  [[nodiscard]] const Eigen::Matrix3Xf* taken_up() const {
    if (!took_up_now_) return nullptr;
    return stage_ == Stage::kRepeats ? &step_.exact : &exact_;
  }
  /// Why refinement ended; returned once. Contact continues without it.
  [[nodiscard]] std::optional<std::string> take_trouble();

 private:
  enum class Stage { kStarts, kIsProbed, kIdle, kRequested, kEnded, kRepeats };

  Refiner(ChildProcess child, const RefinerSettings& settings)
      : settings_(settings), child_(std::move(child)), messages_(kLargestPayload) {}
  explicit Refiner(std::function<void(int n, RefinerStep& step)> step_of)
      : messages_(0), stage_(Stage::kRepeats), step_of_(std::move(step_of)) {}
  void take_up(TouchSolver& solver, TouchState& state, const Eigen::Matrix3Xf& exact);
  void receive(TouchSolver& solver, double wait);
  void read(const ExactMessage& message, TouchSolver& solver);
  void send_load();
  void end(std::string why);

  static constexpr std::size_t kLargestPayload = std::size_t{1} << 23;  // bytes: 700,000 nodes

  RefinerSettings settings_;
  std::optional<ChildProcess> child_;
  ExactMessages messages_;
  Stage stage_ = Stage::kStarts;
  std::uint32_t number_ = 0;  // of the load that was sent last
  int frame_ = 0, requested_at_ = 0;
  bool dropped_ = false;       // the pending solution is too late
  bool has_solution_ = false;  // it has arrived in `exact_`; no columns: it was refused
  RequestedLoad load_;         // of the last request
  Eigen::Matrix3Xf exact_;
  bool requested_now_ = false;
  bool took_up_now_ = false;
  std::function<void(int n, RefinerStep& step)> step_of_;  // of kRepeats
  RefinerStep step_;
  std::vector<std::byte> bytes_;
  RefinerCounts counts_;
  std::optional<std::string> trouble_;
};

}  // namespace palpable
