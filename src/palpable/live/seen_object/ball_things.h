/// @file
/// Tells the things apart of which balls are: balls that overlap, or nearly do, are of one thing.
/// Fingers that touch each other are one thing, and so is a hand with all fingers where the camera
/// sees what joins them.
#pragma once

#include "palpable/common/contact/pressing_surface.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Keeps its memory. Compares 256 balls with each other, and all balls with these.
class BallThings {
 public:
  BallThings();

  void find(std::span<const ObjectBall> balls);

  /// Of each ball the number of its thing, from 0 on.
  [[nodiscard]] std::span<const int> of_balls() const { return of_balls_; }
  [[nodiscard]] int count() const { return static_cast<int>(centres_.size()); }
  /// m, the mean of the centres of a thing's balls.
  [[nodiscard]] std::span<const Eigen::Vector3f> centres() const { return centres_; }

 private:
  void join_chosen(std::span<const ObjectBall> balls);
  [[nodiscard]] int root_of(int chosen) const;
  void find_centres(std::span<const ObjectBall> balls);

  std::vector<int> chosen_;   // indices of balls
  std::vector<int> parents_;  // of chosen_: a forest, each tree of which is a thing
  std::vector<int> numbers_;  // of chosen_: the number of its thing
  std::vector<int> of_balls_;
  std::vector<Eigen::Vector3f> centres_;
  std::vector<int> counts_;  // balls of each thing
};

}  // namespace palpable
