/// @file
/// What truly moves before a body in a filmed clip, as the body sees it.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/contact_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// The hand (and whatever else moves) and its touches, frame by frame from 0 on.
struct ClipHands {
  std::vector<std::vector<Capsule>> capsules;  ///< by frame; m, body frame
  std::vector<ContactLine> contacts;           ///< by frame
  std::vector<Rigid3> body_from_camera;        ///< by frame
  [[nodiscard]] int frame_count() const { return static_cast<int>(contacts.size()); }
};

/// Reads truth/hand.jsonl, truth/contact.jsonl, truth/trajectory.txt and frames/scene.toml of a
/// clip as `palpable synth` lays it out (docs/benchmark.md).
/// @param body  which of several; empty: there is one
/// @throws Error naming the file that is missing, cannot be read or has another number of frames
[[nodiscard]] ClipHands read_clip_hands(const std::filesystem::path& clip,
                                        const std::string& body = {});

/// A touch from its first frame on.
struct Episode {
  int first = 0;            ///< the first touching frame
  std::vector<int> wanted;  ///< frames whose answer is wanted, rising; within the episode
};

/// Spreads `count` frames over the touching ones whose depth is at most `deepest`, and sorts them
/// by the touch to which they belong. A touch ends where a frame has none.
/// @return fewer than `count` where fewer frames touch
[[nodiscard]] std::vector<Episode> episodes_of(const std::vector<ContactLine>& contacts, int count,
                                               double deepest);

/// The capsules at a time between two frames: their ends and radii on straight lines. Where two
/// frames have different numbers of them, those of the nearer frame.
/// @param t  frames; before the first and after the last as there
[[nodiscard]] std::vector<Capsule> capsules_at(const ClipHands& hands, double t);

}  // namespace palpable
