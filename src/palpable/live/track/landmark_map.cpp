#include "palpable/live/track/landmark_map.h"

#include <algorithm>
#include <utility>

namespace palpable {

void LandmarkMap::add(Landmark landmark, Keyframe& keyframe) {
  int slot = static_cast<int>(landmarks.size());
  if (free_slots.empty()) {
    landmarks.push_back(std::move(landmark));
  } else {
    slot = free_slots.back();
    free_slots.pop_back();
    landmarks[slot] = std::move(landmark);
  }
  keyframe.landmarks.push_back(slot);
}

int LandmarkMap::room_for_landmarks(int most) const {
  return most - static_cast<int>(landmarks.size()) + static_cast<int>(free_slots.size());
}

int LandmarkMap::count_alive() const {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                        [](const Landmark& landmark) { return landmark.alive; }));
}

void LandmarkMap::clear() {
  keyframes.clear();
  landmarks.clear();
  free_slots.clear();
}

Eigen::Matrix2d image_from_anchor(const TrackCamera& camera, const Landmark& landmark,
                                  const Rigid3& anchor_from_world,
                                  const Rigid3& camera_from_world) {
  constexpr double kStep = 4;  // px, step of the finite differences
  const Rigid3 camera_from_anchor = camera_from_world * anchor_from_world.inverse(Eigen::Isometry);
  const double w = 1 / (anchor_from_world * landmark.x_in_world).z();
  const auto seen = [&](double du, double dv) -> Eigen::Vector2d {
    // 1/Z of the plane at this pixel. Z is limited to twice the landmark's depth; otherwise a wrong
    // inclination could move the point to infinity or behind the camera.
    const double inverse = std::max(w + landmark.slope.dot(Eigen::Vector2d(du, dv)), 0.5 * w);
    const Eigen::Vector3d x =
        camera.camera.unproject(landmark.uv.x() + du, landmark.uv.y() + dv, 1 / inverse);
    return camera.camera.project(camera_from_anchor * x);
  };
  const Eigen::Vector2d at = seen(0, 0);
  Eigen::Matrix2d A;
  A.col(0) = (seen(kStep, 0) - at) / kStep;
  A.col(1) = (seen(0, kStep) - at) / kStep;
  return A;
}

}  // namespace palpable
