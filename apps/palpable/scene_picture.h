/// @file
/// A scene in the terms of the renderer, and how well it shows the situations of the paper's
/// Fig. 9.
#pragma once

#include "apps/palpable/live_output.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/session/session.h"

namespace palpable::app {

/// The picture of a scene: pointers into both arguments, valid while they are.
[[nodiscard]] SceneView view_of(const Scene& scene, const Session& session);

/// @param pressing  what may press in this frame (Session::pressing_depth)
[[nodiscard]] FigureScores figure_scores(const Scene& scene, const Session& session,
                                         const MaskImage& visible, const DepthImage& body_depth,
                                         const DepthImage& pressing);

}  // namespace palpable::app
