#include "palpable/live/session/refiner.h"

#include "palpable/common/base/contract.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

std::string Refiner::trouble_of_description(const RefinerSettings& settings) {
  constexpr std::size_t kLongestLine = 4096;  // bytes
  constexpr std::chrono::seconds kPatience(20);
  std::vector<std::string> words{"refine", "--check-description", settings.description.string()};
  if (!settings.body.empty()) words.insert(words.end(), {"--of", settings.body.string()});
  Result<ChildProcess> child = ChildProcess::start(settings.program, words);
  if (!child.ok()) return {};  // start() says so
  const auto until = std::chrono::steady_clock::now() + kPatience;
  std::string text;
  while (text.size() < kLongestLine) {
    const std::chrono::duration<double> left = until - std::chrono::steady_clock::now();
    if (left.count() <= 0) return fmt::format("was not read within {} s", kPatience.count());
    std::array<std::byte, 512> room{};
    const auto count = child.value().receive(room, left.count());
    if (!count) break;
    text.append(reinterpret_cast<const char*>(room.data()), *count);
  }
  return text.substr(0, text.find('\n'));
}

Result<Refiner> Refiner::start(const RefinerSettings& settings) {
  PALPABLE_EXPECT(settings.latency >= 1,
                  "a solution is taken up after the frame that requested it");
  Result<ChildProcess> child =
      ChildProcess::start(settings.program, {"refine", settings.description.string()});
  if (!child.ok()) return child.problem();
  return Refiner(std::move(child).value(), settings);
}

Refiner Refiner::repeating(std::function<void(int n, RefinerStep& step)> step_of) {
  return Refiner(std::move(step_of));
}

void Refiner::take_up(TouchSolver& solver, TouchState& state, const Eigen::Matrix3Xf& exact) {
  took_up_now_ = true;
  if (solver.refine(state, load_, exact)) {
    ++counts_.taken_up;
  } else {
    ++counts_.refused;
  }
}

void Refiner::begin_frame(TouchSolver& solver, TouchState& state) {
  requested_now_ = false;
  took_up_now_ = false;
  if (stage_ == Stage::kRepeats) {
    step_.asked = false;
    step_.exact.resize(3, 0);
    step_of_(frame_++, step_);
    // The number of columns differs only if the replay's earlier frames differed from the
    // recording.
    const bool fits = step_.exact.cols() > 0 && step_.exact.cols() == load_.tables.cols();
    if (fits) take_up(solver, state, step_.exact);
    return;
  }
  ++frame_;
  if (stage_ == Stage::kEnded) return;
  const bool is_due = stage_ == Stage::kRequested && frame_ == requested_at_ + settings_.latency;
  if (stage_ == Stage::kStarts || stage_ == Stage::kIsProbed) {
    receive(solver, settings_.waits ? settings_.patience_at_first : 0);
  } else {
    receive(solver, is_due && settings_.waits ? settings_.patience : 0);
  }
  if (stage_ != Stage::kRequested) return;
  if (!has_solution_) {
    if (is_due) {
      ++counts_.late;
      dropped_ = true;
    }
    return;
  }
  if (!is_due && !dropped_) return;  // not before its frame
  stage_ = Stage::kIdle;
  if (dropped_) return;
  if (exact_.cols() == 0) {
    ++counts_.refused;
    return;
  }
  take_up(solver, state, exact_);
}

void Refiner::end_frame(TouchSolver& solver, const TouchState& state, const TouchReport& report) {
  if (stage_ == Stage::kRepeats) {
    requested_now_ = step_.asked && solver.request(state, load_);
    counts_.asked += requested_now_;
    return;
  }
  if (stage_ != Stage::kIdle || report.unsolved() > 0 || !solver.request(state, load_)) return;
  ++counts_.asked;
  requested_now_ = true;
  requested_at_ = frame_;
  stage_ = Stage::kRequested;
  send_load();
}

// Sends the load of load_.
void Refiner::send_load() {
  has_solution_ = dropped_ = false;
  write_load(++number_, load_.forces, bytes_);
  if (!child_->send(bytes_)) end(fmt::format("it ended {}", child_->how_it_ended()));
}

// Reads the messages that have arrived. With a wait (s) it returns when the pending message has
// come, or ends refinement when the wait is over.
void Refiner::receive(TouchSolver& solver, double wait) {
  using Clock = std::chrono::steady_clock;
  const bool is_patient = wait > 0;
  const auto until = Clock::now() + std::chrono::duration<double>(wait);
  while (stage_ != Stage::kEnded) {
    while (const auto message = messages_.next()) read(*message, solver);
    if (stage_ == Stage::kEnded) return;
    if (messages_.broken()) return end("it sent an invalid message");
    if (stage_ == Stage::kIdle || (stage_ == Stage::kRequested && has_solution_)) return;
    const double left =
        is_patient ? std::chrono::duration<double>(until - Clock::now()).count() : 0;
    const auto count = child_->receive(messages_.room(), left);
    if (!count) return end(fmt::format("it ended {}", child_->how_it_ended()));
    messages_.add(*count);
    if (*count > 0) continue;
    if (!is_patient) return;
    if (Clock::now() >= until) return end(fmt::format("no solution came within {:g} s", wait));
  }
}

void Refiner::read(const ExactMessage& message, TouchSolver& solver) {
  using Kind = ExactMessage::Kind;
  const bool is_answer = message.kind == Kind::kAnswer && message.number == number_;
  if (message.kind == Kind::kSorry) return end(std::string(message.text()));
  if (message.kind == Kind::kReady && stage_ == Stage::kStarts) {
    solver.probe(load_);
    if (static_cast<Eigen::Index>(message.count) != load_.tables.cols())
      return end("it was started for another body");
    stage_ = Stage::kIsProbed;
    return send_load();
  }
  const auto nodes = static_cast<Eigen::Index>(message.count);
  const bool fits = nodes == 0 || nodes == load_.tables.cols();
  if (is_answer && fits && stage_ == Stage::kIsProbed) {
    if (nodes > 0) message.read_solution(exact_);
    if (nodes == 0 || !TouchSolver::agrees(load_, exact_))
      return end("it was started for another body");
    stage_ = Stage::kIdle;
    return;
  }
  if (is_answer && fits && stage_ == Stage::kRequested && !has_solution_) {
    has_solution_ = true;
    if (nodes > 0) {
      message.read_solution(exact_);
    } else {
      exact_.resize(3, 0);
    }
    return;
  }
  end("it sent an invalid message");
}

void Refiner::end(std::string why) {
  if (stage_ == Stage::kEnded) return;
  stage_ = Stage::kEnded;
  child_.reset();
  trouble_ = fmt::format("--refine {}: {}; contact continues without it",
                         settings_.description.string(), why);
}

std::optional<std::string> Refiner::take_trouble() { return std::exchange(trouble_, std::nullopt); }

}  // namespace palpable
