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
  [[nodiscard]] int frame_count() const { return static_cast<int>(contacts.size()); }
};

/// Reads truth/hand.jsonl, truth/contact.jsonl, truth/trajectory.txt and frames/scene.toml of a
/// clip as `palpable synth` lays it out (docs/benchmark.md).
/// @param body  name of the body in a clip of several; empty: the clip has one body
/// @throws Error naming the file that is missing, cannot be read or has another number of frames
[[nodiscard]] ClipHands read_clip_hands(const std::filesystem::path& clip,
                                        const std::string& body = {});

/// One touch, and the frames of it that are solved for.
struct Episode {
  int first = 0;            ///< the first touching frame
  std::vector<int> wanted;  ///< frames whose solution is wanted, increasing
};

/// Chooses `count` frames, evenly spread over the touching ones whose depth (m) is at most
/// `deepest`, and groups them by touch. A touch ends where a frame has none.
/// @return fewer than `count` where fewer frames touch
[[nodiscard]] std::vector<Episode> episodes_of(const std::vector<ContactLine>& contacts, int count,
                                               double deepest);

/// The capsules at a time between two frames, by linear interpolation of their ends and radii.
/// Where the two frames have different numbers of capsules, those of the nearer frame.
/// @param t  in frames; clamped to the first and the last frame
[[nodiscard]] std::vector<Capsule> capsules_at(const ClipHands& hands, double t);

}  // namespace palpable
