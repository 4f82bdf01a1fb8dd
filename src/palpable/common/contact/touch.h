/// @file
/// What presses a body: the list that crosses from contact to reconstruction, scene and files.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// One place where something presses a body. Body frame.
struct Touch {
  int site = -1;           ///< index into ReducedBody::sites; -1: it presses where `point` says
  double level = 0;        ///< (0, 1] of the site's full load: the paper's pseudo-time; 0: no site
  double force = 0;        ///< N, of the sum of all forces there
  double press_depth = 0;  ///< m, how far the skin gives way there, along the force
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();  ///< m, where it presses
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();      ///< unit, of the force on the body
  double unseen_for = 0;  ///< s since what presses was measured (held_balls.h); 0: it is now
  double area = 0;        ///< m^2 of the skin that is pressed; 0: not known, as at a site
  /// Share of the force at places of the object that the camera does not see: its other side.
  double assumed = 0;
  int body = 0;  ///< which of the scene's bodies (Scene::bodies)
  int by = -1;   ///< which other body presses it; -1: something real
};

}  // namespace palpable
