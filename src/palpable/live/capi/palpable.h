/** @file
 * Palpable for C and for languages that can call C: load bodies, pass in the images of a camera or
 * capsules that press, and read touches, forces and the deformed skin. docs/c_interface.md has a
 * program of ten lines.
 *
 *     palpable_load_body
 *       palpable_open            with a camera or without
 *         palpable_feed_stereo   a pair of images,  or
 *         palpable_feed_depth    a depth image,  or
 *         palpable_press_at      things made of capsules, without a camera
 *           palpable_get_frame, palpable_get_touch, palpable_get_skin, palpable_get_depth
 *
 * Units     SI: m, N, Pa, s; px where stated. Pixel coordinates (0, 0) are the centre of the first
 *           pixel.
 * Frames    Body: Z up, the body stands on Z = 0. Camera: X right, Y down, Z forward, of the
 *           (rectified) left eye or of the depth image. World: the camera of the first frame; the
 *           world of the caller's poses where those are given; without a camera, the caller's own.
 * Poses     double[16], row by row, the last row 0 0 0 1; target_from_source maps points of the
 *           source into the target: x_in_world = world_from_body * x_in_body.
 *
 * Errors    A function that may fail returns a palpable_status. When that is not PALPABLE_OK,
 *           nothing was changed, and palpable_last_error() gives the reason in one line. Null
 *           pointers, NaN, wrong sizes and damaged files are such errors. A pointer that is neither
 *           null nor from this library is not detected.
 *
 * Threads   A handle may be used by one thread at a time. Different handles may be used at the same
 *           time, also sessions on the same bodies. A call returns when its work is done; meanwhile
 *           a session may use threads of its own (to match stereo, to follow the camera).
 *
 * Memory    Pointers that a session returns are valid until its next feed, press, reset or close;
 *           palpable_keep_frame() makes them last longer.
 *           After the first frames a frame allocates nothing, except while the map of the room
 *           grows and where the camera is followed.
 *
 * Growing   A struct that begins with `size` may get more members at its end. The caller sets size
 *           to sizeof of the struct, and the library reads and writes no more than that. Zero in
 *           any other member of a setup means its default: { .size = sizeof setup } is complete.
 *           Functions and enum values may be added; while the major version stays the same, none
 *           is changed or removed.
 */
#ifndef PALPABLE_PALPABLE_H
#define PALPABLE_PALPABLE_H

#include <stddef.h>
#include <stdint.h>

#define PALPABLE_VERSION_MAJOR 0
#define PALPABLE_VERSION_MINOR 2
#define PALPABLE_VERSION_PATCH 0

#if defined(__GNUC__)
#define PALPABLE_API __attribute__((visibility("default")))
#else
#define PALPABLE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum palpable_status {
  PALPABLE_OK = 0,
  PALPABLE_WRONG_ARGUMENT = 1,
  PALPABLE_WRONG_FILE = 2,   /**< missing, not readable, damaged or of another layout */
  PALPABLE_NOT_POSSIBLE = 3, /**< this body or this session cannot do that */
  PALPABLE_NO_MEMORY = 4,
  PALPABLE_BROKEN = 5 /**< a bug of the library: the session can only be reset or closed */
} palpable_status;

/** Version of the library that is running, e.g. "0.2.0". */
PALPABLE_API const char* palpable_version(void);

/** Reason of the last failed call on this thread; empty before the first one. The text is valid
 * until the next failed call. */
PALPABLE_API const char* palpable_last_error(void);

/* ---- bodies ---- */

/** A baked body and its pose in the world. */
typedef struct palpable_body palpable_body;

/** Reads a body file (palpable bake makes it).
 * @param scale  factor of every length, with the same material, 0.001 to 1000; 1: as it was baked
 * @param body   set to the new body, or to null */
PALPABLE_API palpable_status palpable_load_body(const char* path, double scale,
                                                palpable_body** body);

/** Sets the pose of the body in sessions that are opened later. Without this call the body stands
 * at the world's origin.
 * @param world_from_body  rotation and translation (m, each coordinate within 10 km), finite.
 *                         Entries of the rotation may be off by 0.001 */
PALPABLE_API palpable_status palpable_place_body(palpable_body* body,
                                                 const double world_from_body[16]);

/** Sets Coulomb's coefficient of friction of the body's skin in sessions that are opened later,
 * from 0 (no friction) to 10. Without this call it is that of the body file, 0 in files without
 * one. Dry silicone rubber on skin has about 0.6. */
PALPABLE_API palpable_status palpable_set_friction(palpable_body* body, double coefficient);

/** Whether the body has inertia in sessions that are opened later: what is let go rings, and a hit
 * is opposed by mass. Only a body whose file has vibration modes (a density was given when it was
 * baked) can have it, and has it without this call; not in sessions with a camera.
 * @param on  0: the body is always in the static state under its forces */
PALPABLE_API palpable_status palpable_set_dynamics(palpable_body* body, int32_t on);

/** Frees a body. Sessions that were opened on it stay valid. Null is allowed. */
PALPABLE_API void palpable_free_body(palpable_body* body);

/* ---- sessions ---- */

typedef enum palpable_camera {
  PALPABLE_NO_CAMERA = 0,  /**< capsules press, see palpable_press_at() */
  PALPABLE_STEREO = 1,     /**< pairs, rectified or raw with a calibration file */
  PALPABLE_COLOR_DEPTH = 2 /**< depth images, optionally colour of the same view */
} palpable_camera;

typedef struct palpable_setup {
  size_t size;    /**< sizeof(palpable_setup) */
  int32_t camera; /**< a palpable_camera */
  int32_t width;  /**< px, of each image; 0: the size in the calibration file */
  int32_t height;
  double fx, fy, cx, cy; /**< px, of a rectified eye or of the depth image */
  /** m, between rectified eyes; 1 mm to 10 m. With a calibration file it is needed only if the
   * file's is below 10 mm or above 1 m: then it has to say the same, as such a number is nearly
   * always in another unit. */
  double baseline;
  /** Calibration file: OpenCV YAML of a rig (raw pairs) or of rectified pairs, a ZED's SN*.conf, or
   * `fx fy cx cy width height` as text for depth, or one of another program
   * (docs/recordings.md). Null: the numbers above. Beside a file these may repeat it, to 1 %, but
   * not contradict it. */
  const char* calibration;
  int32_t follow_camera; /**< 1: the camera moves, and its pose is found from the images */
  /** 1: everything that the camera sees presses from the first frame on. 0: only things that came
   * after the first frame press, each from the third frame on that shows it. */
  int32_t press_static;
  double nearest;          /**< m, stereo: the smallest depth that is searched; 0: 0.12 */
  double farthest;         /**< m: larger depths count as unknown; 0: 20, more for a wide rig */
  int32_t threads;         /**< for stereo matching, up to 64; 0: 2. Does not change any result */
  int32_t full_resolution; /**< 1: stereo at full resolution, which takes 6 times as long */
} palpable_setup;

/** Bodies, at most one camera, and the state from frame to frame. */
typedef struct palpable_session palpable_session;

/** Opens a session on bodies, at the poses that they have now.
 * @param bodies   `count` pointers. Several bodies also press each other. Without a camera all must
 *                 have tables of touch (every body has, unless it was baked without), else
 *                 PALPABLE_NOT_POSSIBLE
 * @param session  set to the new session, or to null */
PALPABLE_API palpable_status palpable_open(const palpable_body* const* bodies, size_t count,
                                           const palpable_setup* setup, palpable_session** session);

/** Discards all frames: the next one counts as the first. */
PALPABLE_API palpable_status palpable_reset(palpable_session* session);

/** Closes a session. Null is allowed. */
PALPABLE_API void palpable_close(palpable_session* session);

/* ---- input ---- */

typedef enum palpable_pixels {
  PALPABLE_GRAY8 = 1, /**< one byte */
  PALPABLE_RGB8 = 2,  /**< three, sRGB */
  PALPABLE_BGR8 = 3,
  PALPABLE_RGBA8 = 4, /**< alpha is ignored */
  /** a float: Z in m; unknown where it is NaN, infinite or <= 0. An image with most depths beyond
   * 100 m is refused: it is in mm */
  PALPABLE_DEPTH_F32 = 5
} palpable_pixels;

typedef struct palpable_image {
  size_t size;        /**< sizeof(palpable_image) */
  const void* pixels; /**< top row first; read during the call only */
  int32_t width;      /**< px, equal to that of the setup */
  int32_t height;
  int32_t format; /**< a palpable_pixels */
  /** Bytes from row to row; 0: no bytes between rows. Else at least a row, at most 1048576, and a
   * multiple of 4 for PALPABLE_DEPTH_F32. Pictures whose bottom row comes first are refused. */
  size_t stride;
} palpable_image;

/** Processes one frame of a session with PALPABLE_STEREO.
 * @param world_from_camera  null: the camera stands still or is followed. Else the pose of the
 *                           camera, which then must be given with every frame. A pose whose first
 *                           number is NaN is unknown, and nothing presses in this frame
 * @param time               s, larger than that of the previous frame, less than 1e12 from 0 */
PALPABLE_API palpable_status palpable_feed_stereo(palpable_session* session,
                                                  const palpable_image* left,
                                                  const palpable_image* right,
                                                  const double* world_from_camera, double time);

/** Processes one frame of a session with PALPABLE_COLOR_DEPTH.
 * The other arguments are as in palpable_feed_stereo().
 * @param color  null: no colour image; refused if the camera is to be followed. With colour the
 *               outlines of moving things are more accurate */
PALPABLE_API palpable_status palpable_feed_depth(palpable_session* session,
                                                 const palpable_image* depth,
                                                 const palpable_image* color,
                                                 const double* world_from_camera, double time);

/** The union of the balls with centres on the segment from a to b, whose radius changes linearly
 * from radius_a to radius_b; one ball where a equals b. World frame, m. Coordinates within 1000 m,
 * radii from 0.1 mm to 100 m. This struct never gets more members. */
typedef struct palpable_capsule {
  double a[3];
  double b[3];
  double radius_a;
  double radius_b;
} palpable_capsule;

/** Capsules that belong together, such as those of a hand (palpable/hands.h) or a tool. */
typedef struct palpable_thing {
  size_t size; /**< sizeof(palpable_thing), the same in all things of a call: their distance, too */
  /** The caller's name for it: the same from call to call, another one for each other thing.
   * Touches carry it. Not PALPABLE_NO_THING. */
  int64_t id;
  const palpable_capsule* capsules; /**< `count` of them; read during the call only */
  size_t count;                     /**< with 0, the thing presses nothing */
  /** Coulomb's coefficient between the thing and the skins, up to 10; 0: that of each body;
   * PALPABLE_NO_FRICTION: none. Friction follows the thing from call to call by its id and the
   * order of its capsules; a thing whose count changes begins anew. A capsule does not spin about
   * its own axis. */
  double friction;
} palpable_thing;

#define PALPABLE_NO_FRICTION (-1.0) /**< palpable_thing::friction of a thing that slides freely */

#define PALPABLE_NO_THING INT64_MIN /**< palpable_touch::thing where none is known */

/** Processes one frame of a session with PALPABLE_NO_CAMERA: the skins deform until they no longer
 * penetrate the capsules. Bodies with friction are taken along by things that slide over them, and
 * those with inertia move on by the time since the previous call: capsules come to them on their
 * ways, and what is let go rings. After more than an eighth of a second capsules are where they
 * are, without a velocity, and what rang has rung on. From
 * call to call a capsule should advance by less than its radius: the skin may slip to the other
 * side of one that jumps farther. PALPABLE_OK says that the call was processed, and
 * palpable_frame::answer whether the skins give way to all capsules.
 * @param things   `count` of them, 256 at most, with 4096 capsules together. A thing that is left
 *                 out is gone; with 0 things nothing presses
 * @param seconds  larger than that of the previous call, less than 1e12 from 0 */
PALPABLE_API palpable_status palpable_press_at(palpable_session* session,
                                               const palpable_thing* things, size_t count,
                                               double seconds);

/** What the bodies do to a thing. This struct never gets more members. */
typedef struct palpable_thing_force {
  double force[3];  /**< N, world frame */
  double torque[3]; /**< N m, about the world's origin */
} palpable_thing_force;

/** A tick, for force devices: as palpable_press_at(), but computes nothing but the forces on the
 * things, in a fraction of the time, and may be called a thousand times a second
 * (docs/haptics.md). Touches, skins and palpable_frame stay those of the last palpable_press_at(),
 * which may be called in between as often as there are pictures, and goes on from the last tick. A
 * tick costs as much as a frame where there are several bodies, where a capsule comes by more than
 * a millimetre or is new, after one that did not reach its answer, and, with inertia, after more
 * than some milliseconds.
 * @param seconds  larger than that of the previous call of either function
 * @param forces   `count` of them, one for each thing, overwritten; null if count is 0
 * @param reached  null, or set to 1 where the forces balance the body, 0 where the iterations did
 *                 not come to an end: a device then keeps its last force. Whether skin gives way
 *                 where no contact was solved is judged in frames alone (palpable_frame::answer) */
PALPABLE_API palpable_status palpable_tick_at(palpable_session* session,
                                              const palpable_thing* things, size_t count,
                                              double seconds, palpable_thing_force* forces,
                                              int32_t* reached);

/** palpable_press_at() with one thing without friction whose id is 0, a second after the previous
 * call; the first call is at 1 s. No body has inertia in it: the skins come to rest at once. */
PALPABLE_API palpable_status palpable_press(palpable_session* session,
                                            const palpable_capsule* capsules, size_t count);

/* ---- results ---- */

typedef enum palpable_camera_state {
  PALPABLE_STANDS = 0,   /**< it stands still: at the world's origin, or where it came to rest */
  PALPABLE_STARTING = 1, /**< it is to be followed, but no pose has been found yet */
  PALPABLE_TRACKED = 2,  /**< its pose was found or given */
  PALPABLE_LOST = 3      /**< its pose is unknown: nothing presses */
} palpable_camera_state;

/** Whether the skin gives way to everything that presses. */
typedef enum palpable_answer {
  /** Not judged: before the first palpable_press_at(), with a camera (see inside), and by an older
   * library. */
  PALPABLE_NOT_JUDGED = 0,
  PALPABLE_REACHED = 1, /**< yes: left_to_go is 0.3 mm at most */
  PALPABLE_LATER =
      2, /**< not yet: this call came nearer, the next ones with these capsules go on */
  /** No, and this call came no nearer: forces and shape are no answer to these capsules. One of
   * them is sharper than the distance of the contact points (radius below 2.2 mm times the scale)
   * and stands between them, presses skin that the support holds, or contains so much of the body
   * that the skin finds no way out. */
  PALPABLE_NOT_REACHED = 3
} palpable_answer;

typedef struct palpable_frame {
  size_t size; /**< sizeof(palpable_frame) */
  double time; /**< s, of the frame processed last; NaN before the first */
  int32_t body_count;
  int32_t touch_count; /**< of all bodies */
  int32_t camera;      /**< a palpable_camera_state */
  int32_t wrong_pair;  /**< 1: the images do not fit the calibration; depths are unreliable */
  double world_from_camera[16];
  /** m, how far the skins still are from their solution after palpable_press_at(): the way that
   * they have yet to move, or `inside` if that is more. A skin moves by at most 15 mm in one call,
   * the rest follows in later calls. Up to 0.3 mm the solution is reached. With a camera always 0.
   */
  double left_to_go;
  /** m, how deep obstacles still are inside the skin, judged everywhere: at all contact points, at
   * vertices that the support holds, and inside of triangles where an obstacle is sharper than the
   * distance of the contact points. With a camera a few mm are usual while a hand comes fast. Other
   * bodies are no obstacles. */
  double inside;
  int32_t answer; /**< a palpable_answer, of the last palpable_press_at() */
  /** Capsules that came out of a skin in the last call after they had passed through it, from
   * outside to outside, in one call or in several; only those that advanced by more than their
   * radius in a call may, and those to which the skin did not give way. Of things that had equally
   * many capsules in all of these calls, in the same order. */
  int32_t passed_through;
  /** J, energy of the bodies' motion around their static states after the last call; 0 where
   * nothing moves, without inertia and with a camera. */
  double ringing;
} palpable_frame;

PALPABLE_API palpable_status palpable_get_frame(const palpable_session* session,
                                                palpable_frame* frame);

/** One contact patch on a body; vectors in the body frame. */
typedef struct palpable_touch {
  size_t size;       /**< sizeof(palpable_touch) */
  int32_t body;      /**< index of the pressed body in the session */
  int32_t by;        /**< index of the body that presses; -1: a real thing or capsules */
  double point[3];   /**< m, on the deformed skin */
  double normal[3];  /**< unit, out of the body: opposite to the force without its friction */
  double force[3];   /**< N, on the body, with friction */
  double depth;      /**< m, displacement of the skin against `normal` */
  double area;       /**< m^2, pressed area of the skin; 0: unknown */
  double assumed;    /**< share of the force that comes from sides which the camera does not see */
  double unseen_for; /**< s since the obstacle was last measured; 0: measured in this frame */
  int64_t thing;     /**< palpable_thing::id of what presses; PALPABLE_NO_THING: not known */
  /** contact points near what presses the body for which there was no room: the nearest ones took
   * part, and the force is theirs; 0: there was */
  int64_t left_out;
} palpable_touch;

/** Returns a touch of the frame processed last. Touches are sorted by force, the largest first. */
PALPABLE_API palpable_status palpable_get_touch(const palpable_session* session, int32_t index,
                                                palpable_touch* touch);

/** A body's skin: V vertices and T triangles. The triangles never change. Before the first frame
 * the skin is at rest. */
typedef struct palpable_skin {
  size_t size;            /**< sizeof(palpable_skin) */
  int32_t vertex_count;   /**< V */
  int32_t triangle_count; /**< T */
  const float* vertices;  /**< x0 y0 z0 x1 ..., 3V of them, m, body frame, deformed */
  const float* normals;   /**< 3V, unit, outwards */
  /** V, Pa, von Mises stress of the true stress, the body's own weight included; 0 before the first
   * frame. */
  const float* von_mises;
  const int32_t* triangles; /**< 3T, counterclockwise from outside */
  double world_from_body[16];
  double camera_from_body[16]; /**< in the frame processed last */
  /** Error of the body's response as the library estimates it, without errors of the obstacle's
   * shape: relative error of displacement (L2 over the skin) and of stress (largest error of a
   * vertex / largest stress). NaN: unknown, or nothing touches. */
  double stated_displacement_error;
  double stated_stress_error;
  /** V, Pa: contact pressure. Its sum, weighted by the area around each vertex, is the contact
   * force. NULL before the first frame, and for a body without tables of touch. */
  const float* contact_pressure;
} palpable_skin;

/** Returns the skin of a body.
 * @param body  index into the bodies of palpable_open() */
PALPABLE_API palpable_status palpable_get_skin(const palpable_session* session, int32_t body,
                                               palpable_skin* skin);

/** The measured depth, and the pinhole camera that it belongs to. */
typedef struct palpable_depth {
  size_t size;   /**< sizeof(palpable_depth) */
  int32_t width; /**< px; for stereo half that of the images, unless full_resolution */
  int32_t height;
  const float* depth;    /**< Z in m, NaN where unknown; top row first, no bytes between rows */
  double fx, fy, cx, cy; /**< px */
} palpable_depth;

/** Returns the depth of the frame processed last. PALPABLE_NOT_POSSIBLE before the first frame, and
 * without a camera. */
PALPABLE_API palpable_status palpable_get_depth(const palpable_session* session,
                                                palpable_depth* depth);

/** The arrays of a frame, kept beyond the next one. */
typedef struct palpable_kept_frame palpable_kept_frame;

/** Keeps the arrays to which palpable_get_skin() and palpable_get_depth() have pointed since the
 * last frame: they stay as they are, where they are, until palpable_free_kept_frame(), even when
 * the session is closed and its bodies are freed. Nothing is copied; the next frame gets memory of
 * its own. Until then the getters of skins and depth return PALPABLE_NOT_POSSIBLE.
 * @param kept  set to the arrays, or to null */
PALPABLE_API palpable_status palpable_keep_frame(palpable_session* session,
                                                 palpable_kept_frame** kept);

/** Null is allowed. */
PALPABLE_API void palpable_free_kept_frame(palpable_kept_frame* kept);

#ifdef __cplusplus
}
#endif

#endif /* PALPABLE_PALPABLE_H */
