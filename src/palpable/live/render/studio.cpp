#include "palpable/live/render/studio.h"

#include "palpable/live/render/shader_files.h"

#include <array>
#include <utility>

namespace palpable {

Result<Studio> Studio::make() {
  Result<GlProgram> program =
      GlProgram::make(render_shader_files(), "full_screen.vert", "studio.frag");
  if (!program.ok()) return program.problem();
  return Studio(std::move(program).value());
}

void Studio::draw(const PinholeCamera& camera, const Rigid3& camera_from_body,
                  ColorImage& picture) {
  const int width = camera.width, height = camera.height;
  PALPABLE_EXPECT(width > 0 && height > 0, "the picture has a size");
  if (!target_ || target_->color.width() != width || target_->color.height() != height) {
    target_ = std::make_unique<Target>();
    target_->color = GlTexture(GL_RGBA8, width, height);
    target_->framebuffer = GlFramebuffer(std::array<const GlTexture*, 1>{&target_->color}, nullptr);
  }
  const Rigid3 body_from_camera = camera_from_body.inverse();
  program_.set(
      "pinhole",
      Eigen::Vector4d(camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px).cast<float>().eval());
  program_.set("body_from_camera", body_from_camera.linear().cast<float>().eval());
  program_.set("eye", body_from_camera.translation().cast<float>().eval());
  program_.set("fade", static_cast<float>(2.2 * body_from_camera.translation().norm()));
  target_->framebuffer.bind();
  program_.use();
  triangle_.draw();

  picture.resize(width, height);
  rgba_.resize(4 * picture.size());
  target_->framebuffer.read(0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba_.data());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    picture.data()[i] = {rgba_[4 * i], rgba_[4 * i + 1], rgba_[4 * i + 2]};
  }
}

}  // namespace palpable
