/* Presses a body with two capsules for 300 frames through the C interface, and prints of each frame
 * a number that stands for its skin, stress, contact pressure and forces to the bit
 * (tools/compare_states.py).
 *
 *     capsule_states BODY
 */
#include <math.h>
#include <palpable/palpable.h>
#include <stdio.h>

enum { kFrames = 300 };

static int fails(const char* what) {
  fprintf(stderr, "capsule_states: %s: %s\n", what, palpable_last_error());
  return 1;
}

/* FNV-1a (Fowler, Noll, Vo), 64 bits. */
static uint64_t hashed(uint64_t hash, const void* bytes, size_t count) {
  const unsigned char* at = bytes;
  for (size_t k = 0; k < count; ++k) hash = (hash ^ at[k]) * 1099511628211u;
  return hash;
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: capsule_states BODY\n"), 1;
  palpable_body* body;
  if (palpable_load_body(argv[1], 1, &body) != PALPABLE_OK) return fails("body");
  const palpable_setup setup = {.size = sizeof setup}; /* no camera */
  const palpable_body* bodies[] = {body};
  palpable_session* session;
  if (palpable_open(bodies, 1, &setup, &session) != PALPABLE_OK) return fails("session");

  /* The box of the skin at rest, and its highest vertex. */
  palpable_skin skin = {.size = sizeof skin};
  if (palpable_get_skin(session, 0, &skin) != PALPABLE_OK) return fails("skin");
  double low[3], high[3];
  int top = 0;
  for (int k = 0; k < 3; ++k) low[k] = high[k] = skin.vertices[k];
  for (int v = 0; v < skin.vertex_count; ++v) {
    for (int k = 0; k < 3; ++k)
      low[k] = fmin(low[k], skin.vertices[3 * v + k]),
      high[k] = fmax(high[k], skin.vertices[3 * v + k]);
    if (skin.vertices[3 * v + 2] > skin.vertices[3 * top + 2]) top = v;
  }
  const double x = skin.vertices[3 * top], y = skin.vertices[3 * top + 1],
               z = skin.vertices[3 * top + 2];
  const double middle[3] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};

  int touched = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double t = frame / (double)kFrames;
    /* A finger comes down on the highest place, slides there, and leaves; a thick rod comes from
     * the side. */
    const double depth = 0.005 * sin(3.14159265 * t), aside = 0.004 * sin(12 * t);
    const double tip = z - depth + 0.008;
    const double beside = high[0] + 0.012 - 0.006 * (1 - cos(6.2831853 * 2 * t)) / 2;
    const palpable_capsule things[2] = {
        {{x + aside, y, tip}, {x + aside, y + 0.02, tip + 0.06}, 0.008, 0.009},
        {{beside, middle[1] - 0.03, middle[2]},
         {beside, middle[1] + 0.03, middle[2]},
         0.012,
         0.012}};
    if (palpable_press(session, things, 2) != PALPABLE_OK) return fails("press");
    palpable_frame answered = {.size = sizeof answered};
    if (palpable_get_frame(session, &answered) != PALPABLE_OK) return fails("frame");
    if (palpable_get_skin(session, 0, &skin) != PALPABLE_OK) return fails("skin");
    uint64_t hash = 14695981039346656037u;
    hash = hashed(hash, skin.vertices, sizeof(float) * 3 * (size_t)skin.vertex_count);
    hash = hashed(hash, skin.normals, sizeof(float) * 3 * (size_t)skin.vertex_count);
    hash = hashed(hash, skin.von_mises, sizeof(float) * (size_t)skin.vertex_count);
    if (skin.contact_pressure)
      hash = hashed(hash, skin.contact_pressure, sizeof(float) * (size_t)skin.vertex_count);
    double newtons = 0;
    for (int k = 0; k < answered.touch_count; ++k) {
      palpable_touch touch = {.size = sizeof touch};
      if (palpable_get_touch(session, k, &touch) != PALPABLE_OK) return fails("touch");
      hash = hashed(hash, touch.point, sizeof touch.point);
      hash = hashed(hash, touch.force, sizeof touch.force);
      hash = hashed(hash, &touch.depth, sizeof touch.depth);
      newtons += hypot(hypot(touch.force[0], touch.force[1]), touch.force[2]);
    }
    touched += answered.touch_count > 0;
    printf("%d %016llx %d touches %.6f N\n", frame, (unsigned long long)hash, answered.touch_count,
           newtons);
  }
  palpable_close(session);
  palpable_free_body(body);
  if (touched < kFrames / 2)
    return fprintf(stderr, "capsule_states: touched in %d frames only\n", touched), 1;
  return 0;
}
