/// @file
/// A neutral background for looking at a body: a bright floor with grids of 1 cm and 5 cm, and a
/// soft backdrop.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/render/gl_objects.h"

#include <memory>
#include <vector>

namespace palpable {

/// Draws the studio with the OpenGL context that is current now and in every later call.
class Studio {
 public:
  /// Needs a current context. The problem names shader and line.
  [[nodiscard]] static Result<Studio> make();

  /// Draws the floor and the backdrop.
  /// @param camera_from_body  the floor is Z = 0 of the body frame
  /// @param picture           overwritten, camera size
  /// Takes about 10 ms at 720p on a software renderer, so redraw only when the camera has moved.
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
