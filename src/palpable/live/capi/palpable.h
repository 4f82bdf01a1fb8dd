/** @file
 * Palpable for C, and for whatever can call C: load bodies, feed what a camera saw or what presses,
 * read touches, forces and the deformed skin. docs/c_interface.md has a program of ten lines.
 *
 *     palpable_load_body
 *       palpable_open            with a camera or without
 *         palpable_feed_stereo   a pair of images,  or
 *         palpable_feed_depth    a depth image,  or
 *         palpable_press         capsules, without a camera
 *           palpable_get_frame, palpable_get_touch, palpable_get_skin, palpable_get_depth
 *
 * Units     SI: m, N, Pa, s; pixels where it says px. Pixel (0, 0) is the centre of the first one.
 * Frames    body: Z up, the body stands on Z = 0. Camera: X right, Y down, Z forward, of the
 *           (rectified) left eye or of the depth image. World: the camera of the first frame; where
 *           poses are given, theirs; without a camera, whatever the caller means by it.
 * Poses     double[16], rows one after the other, the last one 0 0 0 1; target_from_source maps
 *           points of the source into the target: x_in_world = world_from_body * x_in_body.
 *
 * Errors    A function that may fail returns a palpable_status. Where that is not PALPABLE_OK
 *           nothing was changed, and palpable_last_error() says why in one line. Null pointers,
 *           numbers that are none, wrong sizes and damaged files are such errors. A pointer that is
 *           neither null nor one of this library's is not noticed.
 *
 * Threads   One thread at a time uses a handle; different handles may be used at the same time,
 *           sessions on the same bodies, too. A call returns when it is answered; meanwhile a
 *           session may use threads of its own (to match stereo, to follow the camera).
 *
 * Memory    What a session hands out holds until its next feed, press, reset or close. After the
 *           first frames nothing is allocated for a frame, except while the map of the room grows
 *           and where the camera is followed.
 *
 * Growing   A struct that begins with `size` may get more members at its end. The caller sets size
 *           to sizeof of the struct, and the library reads and writes no more than that. Zero in
 *           any other member of a setup means its default: { .size = sizeof setup } is a whole one.
 *           Functions and values are added; while the major version stays, none is changed or
 *           taken away.
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
  PALPABLE_WRONG_FILE = 2,   /**< not there, not readable, damaged, of another layout */
  PALPABLE_NOT_POSSIBLE = 3, /**< this body or this session cannot do that */
  PALPABLE_NO_MEMORY = 4,
  PALPABLE_BROKEN = 5 /**< a bug of the library: a session can then only be reset or closed */
} palpable_status;

/** Of the library that is running, as "0.2.0". */
PALPABLE_API const char* palpable_version(void);

/** Why the last call on this thread that failed did so; empty before. Holds until the next one. */
PALPABLE_API const char* palpable_last_error(void);

/* ---- bodies ---- */

/** A baked body and where it is to stand. */
typedef struct palpable_body palpable_body;

/** Reads a body file (palpable bake makes it).
 * @param scale  every length times this, of the same material; 1: as it was baked
 * @param body   set to the new body, or to null */
PALPABLE_API palpable_status palpable_load_body(const char* path, double scale,
                                                palpable_body** body);

/** Where sessions that are opened from now on put it: at the world's origin unless somebody says.
 * @param world_from_body  rotation and translation (m), finite */
PALPABLE_API palpable_status palpable_place_body(palpable_body* body,
                                                 const double world_from_body[16]);

/** Sessions keep what they need of it. Null is allowed. */
PALPABLE_API void palpable_free_body(palpable_body* body);

/* ---- sessions ---- */

typedef enum palpable_camera {
  PALPABLE_NO_CAMERA = 0,  /**< palpable_press() says what presses */
  PALPABLE_STEREO = 1,     /**< pairs; rectified, or raw with a calibration file */
  PALPABLE_COLOR_DEPTH = 2 /**< depth images, colour of the same view if there is any */
} palpable_camera;

typedef struct palpable_setup {
  size_t size;    /**< sizeof(palpable_setup) */
  int32_t camera; /**< a palpable_camera */
  int32_t width;  /**< px, of each image; with a calibration file 0 means that file's */
  int32_t height;
  double fx, fy, cx, cy; /**< px, of a rectified eye or of the depth image */
  double baseline;       /**< m, between rectified eyes; 1 mm to 10 m */
  /** File of a camera: OpenCV YAML of a rig (raw pairs) or of rectified pairs, a ZED's SN*.conf, or
   * `fx fy cx cy width height` as text for depth. Null: the numbers above. */
  const char* calibration;
  int32_t follow_camera; /**< 1: the camera moves, and its pose is found from the images */
  /** 1: everything that is seen presses from the first frame on. 0: only what has come since; a
   * thing is believed in the third frame that shows it. */
  int32_t press_static;
  double nearest;          /**< m, stereo: depths from here on are searched; 0: 0.12 */
  double farthest;         /**< m: depths beyond count as unknown; 0: 20, more for a wide rig */
  int32_t threads;         /**< of stereo matching, up to 64; 0: 2. No result depends on it */
  int32_t full_resolution; /**< 1: stereo is matched at full resolution, in six times the time */
} palpable_setup;

/** Bodies, a camera or none, and what is remembered from frame to frame. */
typedef struct palpable_session palpable_session;

/** Opens a session on bodies where they were placed.
 * @param bodies   count pointers. Several press each other; without a camera there is one, and it
 *                 has tables of touch (bodies have, unless they are baked without), else
 *                 PALPABLE_NOT_POSSIBLE
 * @param session  set to the new session, or to null */
PALPABLE_API palpable_status palpable_open(const palpable_body* const* bodies, size_t count,
                                           const palpable_setup* setup, palpable_session** session);

/** Forgets every frame: the next one is the first. */
PALPABLE_API palpable_status palpable_reset(palpable_session* session);

/** Null is allowed. */
PALPABLE_API void palpable_close(palpable_session* session);

/* ---- what goes in ---- */

typedef enum palpable_pixels {
  PALPABLE_GRAY8 = 1, /**< one byte */
  PALPABLE_RGB8 = 2,  /**< three, sRGB */
  PALPABLE_BGR8 = 3,
  PALPABLE_RGBA8 = 4,    /**< alpha is not looked at */
  PALPABLE_DEPTH_F32 = 5 /**< a float: Z in m; unknown where it is NaN, infinite or <= 0 */
} palpable_pixels;

typedef struct palpable_image {
  size_t size;        /**< sizeof(palpable_image) */
  const void* pixels; /**< top row first; read during the call only */
  int32_t width;      /**< px, the setup's */
  int32_t height;
  int32_t format; /**< a palpable_pixels */
  size_t stride;  /**< bytes from row to row; 0: rows follow each other */
} palpable_image;

/** One frame of a session with PALPABLE_STEREO.
 * @param world_from_camera  null: the camera stands, or is followed. Else its pose, which then
 *                           comes with every frame; one that begins with NaN is not known in this
 *                           frame, and nothing presses
 * @param time               s, above that of the frame before */
PALPABLE_API palpable_status palpable_feed_stereo(palpable_session* session,
                                                  const palpable_image* left,
                                                  const palpable_image* right,
                                                  const double* world_from_camera, double time);

/** One frame of a session with PALPABLE_COLOR_DEPTH.
 * @param color  null: there is none, and following the camera is refused. With colour, outlines of
 *               what moves are found better
 * Everything else as palpable_feed_stereo(). */
PALPABLE_API palpable_status palpable_feed_depth(palpable_session* session,
                                                 const palpable_image* depth,
                                                 const palpable_image* color,
                                                 const double* world_from_camera, double time);

/** The balls with middles between a and b whose radius changes evenly from radius_a to radius_b; a
 * ball where a is b. World frame, m; within 1000 m, radii from 0.1 mm to 100 m. Never grows. */
typedef struct palpable_capsule {
  double a[3];
  double b[3];
  double radius_a;
  double radius_b;
} palpable_capsule;

/** What presses now, in a session with PALPABLE_NO_CAMERA: the skin gives way until none of it is
 * entered, without friction. A thing is to come on by less than its radius from call to call: the
 * skin slips round one that has jumped farther. Each call counts as a frame, the first one has the
 * time 1.
 * @param capsules  count of them, 4096 at most; none: nothing presses */
PALPABLE_API palpable_status palpable_press(palpable_session* session,
                                            const palpable_capsule* capsules, size_t count);

/* ---- what comes out ---- */

typedef enum palpable_camera_state {
  PALPABLE_STANDS = 0,   /**< it stands still: where the world begins, or where it came to rest */
  PALPABLE_STARTING = 1, /**< it is to be followed, and has seen nothing to follow yet */
  PALPABLE_TRACKED = 2,  /**< its pose was found, or was given */
  PALPABLE_LOST = 3      /**< its pose is not known: nothing presses */
} palpable_camera_state;

typedef struct palpable_frame {
  size_t size; /**< sizeof(palpable_frame) */
  double time; /**< s, of the frame answered last; NaN before the first */
  int32_t body_count;
  int32_t touch_count; /**< of all bodies */
  int32_t camera;      /**< a palpable_camera_state */
  int32_t wrong_pair;  /**< 1: the images do not fit the calibration, no depth can be trusted */
  double world_from_camera[16];
  /** m that the skin is still off after palpable_press(): a thing that came on by more than 15 mm
   * is given way to in several calls. Below 0.3 mm the answer is there. With a camera 0. */
  double left_to_go;
} palpable_frame;

PALPABLE_API palpable_status palpable_get_frame(const palpable_session* session,
                                                palpable_frame* frame);

/** One place where something presses a body; body frame. */
typedef struct palpable_touch {
  size_t size;       /**< sizeof(palpable_touch) */
  int32_t body;      /**< which of the session's */
  int32_t by;        /**< what presses: another body's number; -1: a real thing, or capsules */
  double point[3];   /**< m, where the skin is pressed, as it is deformed */
  double normal[3];  /**< unit, out of the body: against the force, for there is no friction */
  double force[3];   /**< N, on the body */
  double depth;      /**< m, how far the skin gives way there, along the force */
  double area;       /**< m^2 of the skin that is pressed; 0: not known */
  double assumed;    /**< share of the force on sides of the thing that the camera does not see */
  double unseen_for; /**< s since what presses was measured; 0: it is now */
} palpable_touch;

/** Of the frame answered last; the strongest has the index 0. */
PALPABLE_API palpable_status palpable_get_touch(const palpable_session* session, int32_t index,
                                                palpable_touch* touch);

/** A body's skin: V vertices, T triangles that never change. Before the first frame at rest. */
typedef struct palpable_skin {
  size_t size;            /**< sizeof(palpable_skin) */
  int32_t vertex_count;   /**< V */
  int32_t triangle_count; /**< T */
  const float* vertices;  /**< x0 y0 z0 x1 ..., 3V of them, m, body frame, deformed */
  const float* normals;   /**< 3V, unit, outwards */
  /** V, Pa, true stress. At rest that of its own weight; 0 before the first frame. */
  const float* von_mises;
  const int32_t* triangles; /**< 3T, counterclockwise from outside */
  double world_from_body[16];
  double camera_from_body[16]; /**< in the frame answered last */
  /** What the library itself says of the frame's answer, the thing that presses taken as it is told
   * or seen: relative error of displacement (L2 over the skin) and of stress (the worst vertex,
   * against the largest stress). NaN: not known, or nothing touches. */
  double stated_displacement_error;
  double stated_stress_error;
  /** V, Pa: how hard things press there; times the area around each vertex it adds up to their
   * forces. NULL before the first frame, and of a body that is pressed at its sites alone. */
  const float* contact_pressure;
} palpable_skin;

/** @param body  its number, from 0 on, as in palpable_open() */
PALPABLE_API palpable_status palpable_get_skin(const palpable_session* session, int32_t body,
                                               palpable_skin* skin);

/** The depth that was measured, and the camera that would see it. */
typedef struct palpable_depth {
  size_t size;   /**< sizeof(palpable_depth) */
  int32_t width; /**< px; for stereo half of the images', unless full_resolution */
  int32_t height;
  const float* depth;    /**< Z in m, NaN unknown; rows follow each other, top row first */
  double fx, fy, cx, cy; /**< px */
} palpable_depth;

/** Of the frame answered last. PALPABLE_NOT_POSSIBLE before the first, and without a camera. */
PALPABLE_API palpable_status palpable_get_depth(const palpable_session* session,
                                                palpable_depth* depth);

#ifdef __cplusplus
}
#endif

#endif /* PALPABLE_PALPABLE_H */
