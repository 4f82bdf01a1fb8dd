/* Presses a body with the capsules of a file and writes what palpable.h returns, for web/test.mjs.
 *
 *     press_lines BODY.palpable FRAMES RESULTS
 *
 * FRAMES   for each frame: a double, how many things; for each thing two doubles, its id and how
 * many capsules, and then 8 doubles for each RESULTS  for each frame: 4 doubles of palpable_frame,
 * then 12 for each touch, then the floats of the skin
 */
#include <palpable/palpable.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static void check(palpable_status status) {
  if (status == PALPABLE_OK) return;
  fprintf(stderr, "press_lines: %s\n", palpable_last_error());
  exit(1);
}

static void write_doubles(const double* from, size_t count, FILE* to) {
  fwrite(from, sizeof *from, count, to);
}

static void write_touch(const palpable_session* session, int32_t index, FILE* to) {
  palpable_touch touch = {.size = sizeof touch};
  check(palpable_get_touch(session, index, &touch));
  write_doubles(touch.point, 3, to);
  write_doubles(touch.normal, 3, to);
  write_doubles(touch.force, 3, to);
  const double rest[3] = {touch.depth, touch.area, (double)touch.thing};
  write_doubles(rest, 3, to);
}

static void write_results(const palpable_session* session, FILE* to) {
  palpable_frame frame = {.size = sizeof frame};
  check(palpable_get_frame(session, &frame));
  const double numbers[4] = {frame.left_to_go, frame.inside, frame.passed_through,
                             frame.touch_count};
  write_doubles(numbers, 4, to);
  for (int32_t k = 0; k < frame.touch_count; ++k) write_touch(session, k, to);
  palpable_skin skin = {.size = sizeof skin};
  check(palpable_get_skin(session, 0, &skin));
  const size_t vertices = (size_t)skin.vertex_count;
  fwrite(skin.vertices, sizeof(float), 3 * vertices, to);
  fwrite(skin.normals, sizeof(float), 3 * vertices, to);
  fwrite(skin.von_mises, sizeof(float), vertices, to);
  fwrite(skin.contact_pressure, sizeof(float), vertices, to);
}

/* Returns 0 at the end of the file. */
static int read_doubles(double* to, size_t count, FILE* from) {
  return fread(to, sizeof *to, count, from) == count;
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  palpable_body* body;
  check(palpable_load_body(argv[1], 1, &body));
  palpable_session* session;
  const palpable_setup setup = {.size = sizeof setup};
  check(palpable_open((const palpable_body* const*)&body, 1, &setup, &session));
  FILE* frames = fopen(argv[2], "rb");
  FILE* results = fopen(argv[3], "wb");
  if (frames == NULL || results == NULL) return 1;
  static palpable_capsule capsules[4096];
  static palpable_thing things[256];
  double count, header[2];
  for (int frame = 1; read_doubles(&count, 1, frames); ++frame) {
    palpable_capsule* next = capsules;
    for (size_t k = 0; k < (size_t)count; ++k) {
      if (!read_doubles(header, 2, frames)) return 1;
      things[k] = (palpable_thing){sizeof *things, (int64_t)header[0], next, (size_t)header[1]};
      if (fread(next, sizeof *next, things[k].count, frames) != things[k].count) return 1;
      next += things[k].count;
    }
    check(palpable_press_at(session, things, (size_t)count, frame / 30.0));
    write_results(session, results);
  }
  palpable_close(session);
  palpable_free_body(body);
  return fclose(results) != 0;
}
