#include "palpable/desk/script/working_hand.h"

#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/hand_script.h"
#include "palpable/desk/script/random.h"

#include <Eigen/Geometry>

#include <utility>

namespace palpable {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

struct Span {
  double low, high;
};

// The order of the random numbers must not change: it determines the films (random.h).
Vector3d between(Random& random, const Span& x, const Span& y, const Span& z) {
  const double at_z = random.between(z.low, z.high);
  const double at_y = random.between(y.low, y.high);
  const double at_x = random.between(x.low, x.high);
  return {at_x, at_y, at_z};
}

// The path in a frame that moves with the camera: X right, Y forward, Z up.
HandPath hand_before_camera(int frames, std::uint64_t seed) {
  HandPath hand;
  hand.tool = index_finger();
  hand.arm = {{0.55, -0.55, -0.50}, {0.5, -0.6, -0.5}};
  hand.tremor_seed = seed;
  Random random(seed, "working hand");
  const auto key = [&](double at, const Vector3d& knuckles, const Vector3d& fingers,
                       const Vector3d& back, double open) {
    const Quaterniond turn(frame_of(fingers, back));
    hand.keys.push_back({at, tip_for_knuckles(hand.tool, knuckles, turn), turn, open});
  };
  const auto spot = [&](double nearest, double farthest) {
    return between(random, {0.015, 0.065}, {nearest, farthest}, {-0.055, -0.005});
  };
  const Vector3d away(0.34, 0.16, -0.24);
  const Vector3d left_up(-0.80, 0.25, 0.50), palm_down(0.30, -0.35, 0.88);
  double now = kFramesWithoutHand;
  key(now, away, left_up, palm_down, 0.5);
  while (now < frames) {
    key(now += 10, spot(0.20, 0.22), left_up, palm_down, 0.9);
    const int moves = 4 + static_cast<int>(random.between(0.0, 3.0));
    for (int i = 0; i < moves; ++i) {
      const Vector3d fingers = between(random, {-0.95, -0.55}, {0.0, 0.5}, {0.05, 0.75});
      const Vector3d back = between(random, {0.0, 0.5}, {-0.9, -0.2}, {0.4, 1.0});
      const double open = random.between(0.2, 1.0);
      const Vector3d knuckles = spot(0.17, 0.22);
      now += random.between(12.0, 26.0);
      key(now, knuckles, fingers, back, open);
    }
    key(now += 11, away, left_up, palm_down, 0.5);
    key(now += random.between(4.0, 12.0), away, left_up, palm_down, 0.5);
  }
  return hand;
}

}  // namespace

std::function<Movers(double)> working_hand(CameraPath path, int frames, std::uint64_t seed) {
  Rigid3 camera_from_own = Rigid3::Identity();
  camera_from_own.linear() << 1, 0, 0,  //
      0, 0, -1,                         //
      0, 1, 0;
  return [hand = hand_alone(hand_before_camera(frames, seed)), path = std::move(path),
          camera_from_own](double frame) {
    Movers movers = hand(frame);
    const Rigid3 desk_from_own = path(frame).inverse() * camera_from_own;
    for (HandCapsule& c : movers.capsules) c = transformed(c, desk_from_own);
    return movers;
  };
}

}  // namespace palpable
