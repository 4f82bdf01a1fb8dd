/* Feeds depth images: a made-up camera looks down on a desk on which a body of about 10 cm stands,
 * and after two seconds a finger comes down onto its highest place. Prints the force.
 *
 *     touch_depth out/demo/bunny.palpable
 */
#include <math.h>
#include <palpable/palpable.h>
#include <stdio.h>

enum { kWidth = 320, kHeight = 240 };
static const double kFocal = 300; /* px */

typedef struct {
  double x, y, z;
} vec;
static vec plus(vec a, double s, vec b) {
  return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec unit(vec a) { return plus((vec){0, 0, 0}, 1 / sqrt(dot(a, a)), a); }

/* m, from the surface of a finger of 8 mm with a hand at its end. @param end  its lowest point */
static double to_hand(vec p, vec end) {
  const vec tip = plus(end, 0.008, (vec){0, 0, 1}), knuckle = plus(end, 1, (vec){0.01, 0.03, 0.08});
  const vec bone = plus(knuckle, -1, tip), from = plus(p, -1, tip), hand = plus(p, -1, knuckle);
  const double along = fmin(1, fmax(0, dot(from, bone) / dot(bone, bone)));
  const vec beside = plus(from, -along, bone);
  return fmin(sqrt(dot(beside, beside)) - 0.008, sqrt(dot(hand, hand)) - 0.03);
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: touch_depth BODY\n"), 1;
  /* The camera's axes and place, in the frame of the desk, which is the body's: Z is up. */
  const vec eye = {0, -0.32, 0.32}, up = {0, 0, 1};
  const vec ahead = unit(plus((vec){0, 0, 0.05}, -1, eye)), right = unit(cross(ahead, up));
  const vec down = cross(ahead, right);
  const double camera_from_body[16] = {right.x, right.y, right.z, -dot(right, eye), /* */
                                       down.x,  down.y,  down.z,  -dot(down, eye),  /* */
                                       ahead.x, ahead.y, ahead.z, -dot(ahead, eye), /* */
                                       0,       0,       0,       1};

  palpable_body* body;
  palpable_session* session;
  const palpable_setup setup = {.size = sizeof setup,
                                .camera = PALPABLE_COLOR_DEPTH,
                                .width = kWidth,
                                .height = kHeight,
                                .fx = kFocal,
                                .fy = kFocal,
                                .cx = (kWidth - 1) / 2.0,
                                .cy = (kHeight - 1) / 2.0};
  if (palpable_load_body(argv[1], 1, &body) != PALPABLE_OK ||
      palpable_place_body(body, camera_from_body) != PALPABLE_OK || /* the camera's is the world */
      palpable_open((const palpable_body* const*)&body, 1, &setup, &session) != PALPABLE_OK) {
    return fprintf(stderr, "touch_depth: %s\n", palpable_last_error()), 1;
  }

  palpable_skin skin = {.size = sizeof skin};
  palpable_get_skin(session, 0, &skin);
  vec top = {0, 0, 0};
  for (int v = 0; v < skin.vertex_count; ++v) {
    const float* x = skin.vertices + 3 * v;
    if (x[2] > top.z) top = (vec){x[0], x[1], x[2]};
  }

  static float depth[kHeight][kWidth];
  double force[3] = {0, 0, 0};
  int before = 0;
  for (int frame = 0; frame < 100; ++frame) {
    /* From 15 cm above the body down to 6 mm in it. */
    const vec end = plus(top, fmax(-0.006, 0.15 - 0.004 * fmax(0, frame - 55)), up);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const double a = (u - setup.cx) / kFocal, b = (v - setup.cy) / kFocal;
        const vec ray = plus(plus(ahead, a, right), b, down); /* as long as Z is 1 */
        const double length = sqrt(dot(ray, ray)), desk = -eye.z / ray.z;
        double Z = 0;
        for (int n = 0; frame >= 45 && n < 60 && Z < desk; ++n) {
          const double away = to_hand(plus(eye, Z, ray), end);
          Z += away / length;
          if (away < 1e-5) break;
        }
        depth[v][u] = (float)(frame >= 45 && Z < desk ? Z : desk);
      }
    }
    const palpable_image image = {sizeof image, depth, kWidth, kHeight, PALPABLE_DEPTH_F32, 0};
    if (palpable_feed_depth(session, &image, NULL, NULL, frame / 30.0) != PALPABLE_OK) {
      return fprintf(stderr, "touch_depth: %s\n", palpable_last_error()), 1;
    }
    palpable_frame told = {.size = sizeof told};
    palpable_get_frame(session, &told);
    if (frame < 80) before += told.touch_count;
    force[0] = force[1] = force[2] = 0;
    for (int k = 0; k < told.touch_count; ++k) {
      palpable_touch touch = {.size = sizeof touch};
      palpable_get_touch(session, k, &touch);
      for (int i = 0; i < 3; ++i) force[i] += touch.force[i];
    }
  }
  printf("%.2f N, downwards %.2f N\n", hypot(hypot(force[0], force[1]), force[2]), -force[2]);
  palpable_close(session);
  palpable_free_body(body);
  return before == 0 && -force[2] > 2 * hypot(force[0], force[1]) ? 0 : 1;
}
