/// @file
/// A scene of a session in the terms of the renderer.
#pragma once

#include "palpable/render/scene_renderer.h"
#include "palpable/session/scene.h"
#include "palpable/session/session.h"
#include "palpable/view/scene_show.h"

#include <span>
#include <string>

namespace palpable {

/// A body of a scene where the camera sees it; pointers into both arguments. A body that stands
/// elsewhere than on the first one's ground throws no shadow on it.
/// @param session  that made the scene
/// @param number   of the body
/// @param scale    Pa, top of the colours
[[nodiscard]] BodyLook look_of_body(const Scene& scene, const Session& session, int number,
                                    double scale);

/// One line about a scene: its time and its touches.
[[nodiscard]] std::string caption_of(const Scene& scene);
/// Depth of the deepest touch, and the force of all, or the site; "not touched".
[[nodiscard]] std::string caption_of(std::span<const Touch> touches);
/// That the camera is lost, and what to do; or that what presses is not seen. Else empty.
[[nodiscard]] std::string warning_of(const Scene& scene);

/// The picture of a scene: pointers into both, valid while they are.
/// @param session  that made the scene
/// @param scale    Pa, top of the colours
/// @param show     what of it is shown
/// @param view     filled anew, for which its memory is used again
void fill_view(const Scene& scene, const Session& session, double scale, const SceneShow& show,
               SceneView& view);

}  // namespace palpable
