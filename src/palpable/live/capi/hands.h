/** @file
 * From the joints of a hand tracker to capsules that press: OpenXR, WebXR, MediaPipe.
 * docs/c_interface.md has a program.
 *
 *     double joints[26 * 3];                       // from xrLocateHandJointsEXT, in the world
 *     palpable_capsule hand[PALPABLE_HAND_CAPSULES];
 *     palpable_hand_capsules(PALPABLE_OPENXR_HAND, PALPABLE_RIGHT, joints, NULL, hand);
 *     palpable_thing thing = { .size = sizeof thing, .id = 1, .capsules = hand,
 *                             .count = PALPABLE_HAND_CAPSULES };
 *     palpable_press_at(session, &thing, 1, seconds);
 */
#ifndef PALPABLE_HANDS_H
#define PALPABLE_HANDS_H

#include "palpable.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The joints that a tracker gives, in its order. */
typedef enum palpable_hand_joints {
  PALPABLE_OPENXR_HAND = 1,   /**< 26, as XrHandJointEXT */
  PALPABLE_WEBXR_HAND = 2,    /**< 25, as XRHandJoint */
  PALPABLE_MEDIAPIPE_HAND = 3 /**< 21 landmarks, in metres and in the world */
} palpable_hand_joints;

typedef enum palpable_side { PALPABLE_LEFT = 1, PALPABLE_RIGHT = 2 } palpable_side;

#define PALPABLE_HAND_CAPSULES 26

/** The hand around these joints, for a palpable_thing: always as many capsules, in the same order.
 * Bones of fingers have the radii of their joints. The palm, and everything where there are no
 * radii, is that of a mean hand of the same length. Fails on joints that are no numbers and on
 * hands that are not 80 to 300 mm long, as when joints are in mm.
 * @param layout    a palpable_hand_joints
 * @param side      a palpable_side
 * @param joints    x0 y0 z0 x1 ..., m, world frame
 * @param radii     m, of each joint: from it to the skin; null: not known
 * @param capsules  PALPABLE_HAND_CAPSULES of them, overwritten */
PALPABLE_API palpable_status palpable_hand_capsules(int32_t layout, int32_t side,
                                                    const double* joints, const double* radii,
                                                    palpable_capsule* capsules);

#ifdef __cplusplus
}
#endif

#endif /* PALPABLE_HANDS_H */
