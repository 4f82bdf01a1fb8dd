/// @file
/// A neutral place to look at a body: bright floor with a grid of 1 cm and 5 cm, soft backdrop.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/render/gl_objects.h"

#include <memory>
#include <vector>

namespace palpable {

/// Draws the studio with the OpenGL context that is current now and in every later call.
class Studio {
 public:
  [[nodiscard]] static Result<Studio> make();

  /// @param camera_from_body  the floor is Z = 0 of the body frame
  /// @param picture           overwritten, camera size
  /// About 10 ms at 720p on a software renderer: draw it again only when the camera has moved.
  void draw(const PinholeCamera& camera, const Rigid3& camera_from_body, ColorImage& picture);

 private:
  explicit Studio(GlProgram program) : program_(std::move(program)) {}
  struct Target {
    GlTexture color;
    GlFramebuffer framebuffer;
  };
  GlProgram program_;
  FullScreenTriangle triangle_;
  std::unique_ptr<Target> target_;
  std::vector<std::uint8_t> rgba_;
};

}  // namespace palpable
