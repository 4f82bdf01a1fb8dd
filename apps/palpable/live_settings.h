/// @file
/// From the options of `live` to a run that is ready to begin; also for `bench live`.
#pragma once

#include "apps/palpable/live_options.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/play/live_set_up.h"
#include "palpable/live/player/live_run.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace palpable::app {

/// Sets the number of threads of a software OpenGL. Must be called before anything is drawn.
/// @param threads  LiveOptions::threads
void share_drawing_threads(int threads);

/// The files and folders that the options name.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const LiveOptions& options);

/// Reads the bodies, renders the synthetic clip if it is required and missing, opens the images and
/// determines the poses.
/// @param images  already open, those that options.input names; null: they are opened
/// @throws Error for every failure
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options,
                                    std::unique_ptr<FrameSource> images = nullptr);

}  // namespace palpable::app
