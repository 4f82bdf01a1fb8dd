/// @file
/// From the options of `live` to a run that is ready to begin; also for `bench live`.
#pragma once

#include "apps/palpable/live_options.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/play/live_set_up.h"
#include "palpable/live/play/preview.h"
#include "palpable/live/player/live_run.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace palpable::app {

/// Sets the number of threads of a software OpenGL. Must be called before anything is drawn.
/// @param threads  LiveOptions::threads
void share_drawing_threads(int threads);

/// The files and folders that the options name.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const LiveOptions& options);

/// The body's pose from --place: camera_from_body. Empty without it.
/// @throws Error when it is no pose
[[nodiscard]] std::optional<Rigid3> given_place(const LiveOptions& options);

/// The bodies of the command line or of the scene file. @throws Error
[[nodiscard]] std::vector<DescribedBody> wanted_bodies(const LiveOptions& options);

/// The folder in which clips of the synthetic desk are kept for this body.
/// @throws Error when the body file cannot be read or the user has no folder for caches
[[nodiscard]] std::filesystem::path clip_cache(const std::filesystem::path& body_file);

/// Reads the bodies, renders the synthetic clip if it is required and missing, opens the images and
/// determines the poses.
/// @param images  already open, those that options.input names; null: they are opened
/// @throws Error for every failure
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options,
                                    std::unique_ptr<FrameSource> images = nullptr);

/// The settings of `live --preview`. @throws Error for invalid options
[[nodiscard]] PreviewSettings preview_settings(const LiveOptions& options, const PlayOptions& play);

}  // namespace palpable::app
