#include "palpable/live/track/track_states.h"

namespace palpable {

TrackState next_state(TrackState before, FrameEvidence evidence) {
  const bool was_fixed = before == TrackState::kFixed;
  switch (evidence) {
    case FrameEvidence::kStartView:
      return TrackState::kStarting;
    case FrameEvidence::kFirstKeyframe:
    case FrameEvidence::kPatchesAtRest:
    case FrameEvidence::kCameToRest:
      return TrackState::kFixed;
    case FrameEvidence::kPoseFound:
      return TrackState::kTracking;
    case FrameEvidence::kPoseAtRest:
      return was_fixed ? TrackState::kFixed : TrackState::kTracking;
    case FrameEvidence::kHidden:
      return was_fixed ? TrackState::kFixed : TrackState::kLost;
    case FrameEvidence::kUnreadable:
    case FrameEvidence::kOtherView:
    case FrameEvidence::kNoPose:
      break;
  }
  return TrackState::kLost;
}

}  // namespace palpable
