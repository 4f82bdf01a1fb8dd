/// @file
/// Exact answers to the loads that a touched body bears, from a process that runs beside: when it
/// is asked, and when its answers are taken up (response/refinement.h says what they then do).
///
///     frame n              asked for the load of this frame's state
///     frame n + latency    its answer is taken up, or dropped where it is not there yet
///
/// An answer never comes earlier than that. Where frames wait for the loop, this waits for the
/// answer, too, so that a recording gives the same bytes each time it is played. Elsewhere it
/// depends on the clock which answers are taken up: a recording keeps what was done in which frame
/// (RefinerStep), and its replay does the same, without the process.
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
  int latency = 6;                         ///< frames, >= 1; 0.2 s
  bool waits = true;                       ///< false: what is not there in time is dropped
  double patience = 30;                    ///< s that an answer is waited for, if it is
  double patience_at_first = 600;          ///< s, likewise, until the body is meshed and factorised
};

/// What was done in one frame, as far as the body's state depends on it.
struct RefinerStep {
  bool asked = false;      ///< after its contact, for the load of its state
  Eigen::Matrix3Xf exact;  ///< (3 x W) m: before its contact, taken up; no columns: nothing was
};

struct RefinerCounts {
  int asked = 0;
  int taken_up = 0;
  int late = 0;     ///< not there in time: dropped
  int refused = 0;  ///< the body does not bear the load by itself
};

/// Between frames of one body. Once it has had its room it allocates nothing, and it blocks only
/// where its settings say that it waits.
class Refiner {
 public:
  /// Starts the process. A problem when it cannot be started.
  [[nodiscard]] static Result<Refiner> start(const RefinerSettings& settings);

  /// Does what another one did.
  /// @param step_of  fills what was done in the n-th frame, from 0 on; called once for each, in
  /// order
  [[nodiscard]] static Refiner repeating(std::function<void(int n, RefinerStep& step)> step_of);

  /// Before the frame's contact: takes up the answer that is due.
  void begin_frame(TouchSolver& solver, TouchState& state);
  /// After it: asks for the state's load if nothing is on its way. @param report  of this frame
  void end_frame(TouchSolver& solver, const TouchState& state, const TouchReport& report);

  [[nodiscard]] const RefinerCounts& counts() const { return counts_; }
  /// What was done in the last frame: whether the load of its state was asked for, and the answer
  /// that was taken up, (3 x W) m, valid until the next frame; null: none was.
  [[nodiscard]] bool asked() const { return asked_now_; }
  [[nodiscard]] const Eigen::Matrix3Xf* taken_up() const {
    if (!took_up_now_) return nullptr;
    return stage_ == Stage::kRepeats ? &step_.exact : &exact_;
  }
  /// Why nothing is refined any more, once; the body goes on without.
  [[nodiscard]] std::optional<std::string> take_trouble();

 private:
  enum class Stage { kStarts, kIsProbed, kIdle, kAsked, kEnded, kRepeats };

  Refiner(ChildProcess child, const RefinerSettings& settings)
      : settings_(settings), child_(std::move(child)), messages_(kLargestAnswer) {}
  explicit Refiner(std::function<void(int n, RefinerStep& step)> step_of)
      : messages_(0), stage_(Stage::kRepeats), step_of_(std::move(step_of)) {}
  void take_up(TouchSolver& solver, TouchState& state, const Eigen::Matrix3Xf& exact);
  void listen(TouchSolver& solver, double wait);
  void read(const ExactMessage& message, TouchSolver& solver);
  void send_load();
  void end(std::string why);

  static constexpr std::size_t kLargestAnswer = std::size_t{1} << 23;  // bytes: 700,000 nodes

  RefinerSettings settings_;
  std::optional<ChildProcess> child_;
  ExactMessages messages_;
  Stage stage_ = Stage::kStarts;
  std::uint32_t number_ = 0;  // of the load that was sent last
  int frame_ = 0, asked_at_ = 0;
  bool dropped_ = false;   // the answer on its way is too late
  bool answered_ = false;  // it is there: `exact_`, of no columns where it was refused
  RequestedLoad asked_;
  Eigen::Matrix3Xf exact_;
  bool asked_now_ = false;
  bool took_up_now_ = false;
  std::function<void(int n, RefinerStep& step)> step_of_;  // of kRepeats
  RefinerStep step_;
  std::vector<std::byte> bytes_;
  RefinerCounts counts_;
  std::optional<std::string> trouble_;
};

}  // namespace palpable
