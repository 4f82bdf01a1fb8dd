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
               session.settings().touch),
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
  state_ = frame.state;
  surface_.build(frame.balls, region_, camera_);
  contact_.find_touches(state_, &surface_, {}, touches_);
}

void BetweenFrames::advance(double ahead) {
  const double frame = motion_.interval() > 0 ? motion_.interval() : kUsual;
  motion_.carry(ahead, balls_);
  // What friction carries along moves as it did in the frame: less than the balls, which tremble.
  const auto part = static_cast<float>((motion_.reached(ahead) - motion_.reached(ahead_)) / frame);
  for (ObjectBall& ball : balls_) ball.way *= part;
  surface_.build(balls_, region_, camera_);
  // The step limit is for one frame: between frames a share of it applies.
  const double passed = ahead - ahead_;
  const double share = std::clamp(passed / frame, 0.0, 1.0);
  ahead_ = ahead;
  if (surface_.balls().empty() && state_.forces.empty() && !state_.vibration.moves) {
    touches_.clear();
    return;
  }
  const double largest = std::max(share * SkinContact::kMove, 2 * surface_.moved());
  const std::optional<double> time = dynamics_ ? std::optional(passed) : std::nullopt;
  contact_.solver().advance(state_, surface_, largest, time);
  contact_.find_touches(state_, &surface_, {}, touches_);
}

}  // namespace palpable
