/// @file
/// A scene of a session in the terms of the renderer.
#pragma once

#include "palpable/reduced/reduced_body.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/session/scene.h"

#include <span>
#include <string>

namespace palpable {

/// The pressed body of a scene where the camera sees it; pointers into both arguments.
/// @param body   of the session that made the scene
/// @param scale  Pa, top of the colours
[[nodiscard]] BodyLook look_of_body(const Scene& scene, const ReducedBody& body, double scale);

/// One line about a scene: its time and its touches.
[[nodiscard]] std::string caption_of(const Scene& scene);
/// Depth of the deepest touch, and the force of all, or the site; "not touched".
[[nodiscard]] std::string caption_of(std::span<const Touch> touches);
/// That the camera is lost, and what to do; or that what presses is not seen. Else empty.
[[nodiscard]] std::string warning_of(const Scene& scene);

/// The picture of a scene: pointers into both arguments, valid while they are.
/// @param body   of the session that made the scene
/// @param scale  Pa, top of the colours
[[nodiscard]] SceneView view_of(const Scene& scene, const ReducedBody& body, double scale);

}  // namespace palpable
