/// @file
/// The true hand of a filmed clip, in the frame of a body.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/frame_records.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// The hand (with all other moving things) and its touches, for each frame from 0 on.
struct ClipHands {
  std::vector<std::vector<Capsule>> capsules;  ///< by frame; m, body frame
  std::vector<ContactLine> contacts;           ///< by frame
  std::vector<Rigid3> body_from_camera;        ///< by frame
  std::vector<double> times;                   ///< by frame; s
  [[nodiscard]] int frame_count() const { return static_cast<int>(contacts.size()); }
};

/// Reads truth/hand.jsonl, truth/contact.jsonl, truth/trajectory.txt and frames/scene.toml of a
/// clip as `palpable synth` lays it out (docs/benchmark_files.md).
/// @param body  name of the body in a clip of several; empty: the clip has one body
/// @throws Error naming the file that is missing, cannot be read or has another number of frames
[[nodiscard]] ClipHands read_clip_hands(const std::filesystem::path& clip,
                                        const std::string& body = {});

}  // namespace palpable
