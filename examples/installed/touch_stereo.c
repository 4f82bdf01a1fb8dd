/* Feeds stereo pairs: made-up pictures of a rough wall 44 cm away, in which a body stands, so that
 * the wall presses it. Prints how far away the wall is.
 *
 *     touch_stereo out/demo/bunny.palpable
 */
#include <math.h>
#include <palpable/palpable.h>
#include <stdint.h>
#include <stdio.h>

enum { kWidth = 320, kHeight = 180, kDisparity = 25 };

/* Grey squares of 2 px. */
static void draw(uint8_t* pixels, int shift) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      uint32_t h = (uint32_t)((x + shift) / 2) * 0x9E3779B1u ^ (uint32_t)(y / 2) * 0x85EBCA77u;
      h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
      pixels[y * kWidth + x] = (uint8_t)(20 + (h ^ (h >> 12)) % 200);
    }
  }
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: touch_stereo BODY\n"), 1;
  const palpable_setup setup = {.size = sizeof setup,
                                .camera = PALPABLE_STEREO,
                                .width = kWidth,
                                .height = kHeight,
                                .fx = 175,
                                .fy = 175,
                                .cx = 159.5,
                                .cy = 89.5,
                                .baseline = 0.063,
                                .press_static = 1};
  /* It stands upright, 42 cm before the camera and 4 cm below its axis. */
  const double camera_from_body[16] = {1, 0, 0, 0, 0, 0, -1, 0.04, 0, 1, 0, 0.42, 0, 0, 0, 1};
  palpable_body* body;
  palpable_session* session;
  if (palpable_load_body(argv[1], 1, &body) != PALPABLE_OK ||
      palpable_place_body(body, camera_from_body) != PALPABLE_OK ||
      palpable_open((const palpable_body* const*)&body, 1, &setup, &session) != PALPABLE_OK) {
    return fprintf(stderr, "touch_stereo: %s\n", palpable_last_error()), 1;
  }

  static uint8_t left[kWidth * kHeight], right[kWidth * kHeight];
  draw(left, 0);
  draw(right, kDisparity); /* what lies at x in the left eye lies at x - 25 in the right one */
  palpable_frame told = {.size = sizeof told};
  for (int frame = 0; frame < 5; ++frame) {
    const palpable_image l = {sizeof l, left, kWidth, kHeight, PALPABLE_GRAY8, 0};
    const palpable_image r = {sizeof r, right, kWidth, kHeight, PALPABLE_GRAY8, 0};
    if (palpable_feed_stereo(session, &l, &r, NULL, frame / 30.0) != PALPABLE_OK) {
      return fprintf(stderr, "touch_stereo: %s\n", palpable_last_error()), 1;
    }
    palpable_get_frame(session, &told);
  }

  palpable_depth seen = {.size = sizeof seen};
  if (palpable_get_depth(session, &seen) != PALPABLE_OK) return 1;
  double sum = 0;
  int known = 0;
  for (int i = 0; i < seen.width * seen.height; ++i) {
    if (isnan(seen.depth[i])) continue;
    sum += seen.depth[i];
    ++known;
  }
  const double mean = sum / known, wall = setup.fx * setup.baseline / kDisparity;
  printf("%.3f m, touches: %d\n", mean, told.touch_count);
  palpable_close(session);
  palpable_free_body(body);
  return 2 * known > seen.width * seen.height && fabs(mean - wall) < 0.04 * wall &&
                 told.touch_count > 0
             ? 0
             : 1;
}
