/// @file
/// A scene in the terms of the renderer, and how well it shows the situations of the paper's
/// Fig. 9.
#pragma once

#include "apps/palpable/live_output.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/session/session.h"

#include <string>

namespace palpable::app {

/// Pa at the top of the colour scale: what one vertex in a hundred exceeds under a full press, at a
/// site that is stiffer than three quarters of the others. The very largest stress stands at single
/// vertices and would leave everything else in the lowest colours.
[[nodiscard]] double stress_scale(const ReducedBody& body);

/// The pressed body of a scene where the camera sees it; pointers into both arguments.
/// @param scale  Pa, top of the colours
[[nodiscard]] BodyLook look_of_body(const Scene& scene, const Session& session, double scale);

/// What is said about a scene: when it is, and the touch.
[[nodiscard]] std::string caption_of(const Scene& scene);
/// That the camera is lost, and what to do; empty while it is not.
[[nodiscard]] std::string warning_of(const Scene& scene);

/// The picture of a scene: pointers into both arguments, valid while they are.
/// @param scale  Pa, top of the colours
[[nodiscard]] SceneView view_of(const Scene& scene, const Session& session, double scale);

/// @param pressing  what may press in this frame (Session::pressing_depth)
[[nodiscard]] FigureScores figure_scores(const Scene& scene, const Session& session,
                                         const MaskImage& visible, const DepthImage& body_depth,
                                         const DepthImage& pressing);

}  // namespace palpable::app
