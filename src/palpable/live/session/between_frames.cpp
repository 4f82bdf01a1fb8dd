#include "palpable/live/session/between_frames.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace palpable {
namespace {

// s, the interval between frames where the frames' times do not give it.
constexpr double kUsual = 1.0 / 30;

const TouchTables& tables_of(const Session& session) {
  PALPABLE_EXPECT(!BetweenFrames::trouble_of(session),
                  "a session of one body with tables of touch");
  return *session.body().response.tables();
}

// Ticks have inertia exactly where the session's frames have it.
TouchSettings settings_of(const Session& session) {
  TouchSettings settings = session.settings().touch;
  settings.inertia = settings.inertia && session.settings().dynamics;
  return settings;
}

}  // namespace

void SolvedFrame::take(const Session& session, const Scene& scene) {
  number = scene.number;
  time = scene.time;
  const std::span<const ObjectBall> seen = session.body().response.surface().balls();
  balls.assign(seen.begin(), seen.end());
  interval.reset();
  if (const SurfaceFriction* friction = session.body().response.friction()) {
    const std::span<const Eigen::Vector3f> known = friction->motion().velocities();
    velocities.assign(balls.empty() ? known.end() : known.begin(), known.end());
    interval = friction->motion().interval();
  }
  camera = scene.bodies.front().camera_from_body.inverse().translation().cast<float>();
  state = session.body().response.touched();
  left_to_move = scene.left_to_move;
}

std::optional<Problem> BetweenFrames::trouble_of(const Session& session) {
  if (session.body_count() != 1)
    return Problem{"contact between frames needs a session of one body"};
  if (session.body().response.tables() == nullptr) {
    return Problem{"contact between frames needs a body with tables of touch"};
  }
  if (session.refiner() != nullptr) {
    return Problem{"full-order solutions are blended in frame by frame, and not between frames"};
  }
  return std::nullopt;
}

BetweenFrames::BetweenFrames(const Session& session)
    : region_(box_of(session.body().model().surface)),
      contact_(session.body().model().surface, session.body().model().fixed, tables_of(session),
               settings_of(session)),
      surface_(session.body().response.surface().settings()),
      dynamics_(session.settings().dynamics) {}

void BetweenFrames::begin(const SolvedFrame& frame) {
  if (frame.interval) {
    motion_.take(frame.balls, frame.velocities, *frame.interval);
  } else {
    motion_.add(frame.balls, frame.camera, frame.time);
  }
  camera_ = frame.camera;
  ahead_ = 0;
  is_solved_ = !(frame.left_to_move > kReached);
  fastest_ = 0;
  for (const Eigen::Vector3f& velocity : motion_.velocities()) {
    fastest_ = std::max(fastest_, static_cast<double>(velocity.norm()));
  }
  contact_.solver().drop_ticks();
  state_ = frame.state;
  surface_.build(frame.balls, region_, camera_);
  contact_.find_touches(state_, &surface_, {}, touches_);
}

void BetweenFrames::place(Eigen::Matrix3Xf& skin) {
  contact_.solver().end_ticks();
  contact_.place(state_, skin);
}

void BetweenFrames::advance(double ahead) {
  const double frame = motion_.interval() > 0 ? motion_.interval() : kUsual;
  motion_.carry(ahead, balls_);
  // What friction carries along moves as it did in the frame: less than the balls, which tremble.
  const double reached = motion_.reached(ahead) - motion_.reached(ahead_);
  const auto part = static_cast<float>(reached / frame);
  for (ObjectBall& ball : balls_) ball.way *= part;
  surface_.build(balls_, region_, camera_);
  const double passed = ahead - ahead_;
  ahead_ = ahead;
  if (surface_.balls().empty() && state_.forces.empty() && !state_.vibration.moves) {
    touches_.clear();
    return;
  }
  if (is_solved_) {
    contact_.solver().tick(state_, surface_, passed, reached * fastest_);
  } else {
    // The skin is still on its way to the frame's answer. The step limit is for one frame: between
    // frames a share of it applies.
    const double share = std::clamp(passed / frame, 0.0, 1.0);
    const double largest = std::max(share * SkinContact::kMove, 2 * surface_.moved());
    const std::optional<double> time = dynamics_ ? std::optional(passed) : std::nullopt;
    contact_.solver().advance(state_, surface_, largest, time);
  }
  contact_.find_touches(state_, &surface_, {}, touches_);
}

}  // namespace palpable
