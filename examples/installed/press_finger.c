/* Presses a body without any camera, as a game or a haptic device does: a finger goes 4 mm into its
 * highest place. Prints the force.
 *
 *     press_finger out/demo/bunny.palpable
 */
#include <math.h>
#include <palpable/palpable.h>
#include <stdio.h>

static int fails(const char* what) {
  fprintf(stderr, "press_finger: %s: %s\n", what, palpable_last_error());
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 2) return fprintf(stderr, "usage: press_finger BODY\n"), 1;
  palpable_body* body;
  if (palpable_load_body(argv[1], 1, &body) != PALPABLE_OK) return fails("body");
  const palpable_setup setup = {.size = sizeof setup}; /* no camera */
  const palpable_body* bodies[] = {body};
  palpable_session* session;
  if (palpable_open(bodies, 1, &setup, &session) != PALPABLE_OK) return fails("session");

  /* The highest vertex at rest. */
  palpable_skin skin = {.size = sizeof skin};
  if (palpable_get_skin(session, 0, &skin) != PALPABLE_OK) return fails("skin");
  int top = 0;
  for (int v = 0; v < skin.vertex_count; ++v) {
    if (skin.vertices[3 * v + 2] > skin.vertices[3 * top + 2]) top = v;
  }
  const double x = skin.vertices[3 * top], y = skin.vertices[3 * top + 1];
  const double z = skin.vertices[3 * top + 2], radius = 0.008;

  double force = 0, half_way = 0, depth = 0;
  for (int step = 1; step <= 8; ++step) {
    const double tip = z - 0.0005 * step + radius; /* its middle */
    const palpable_capsule finger = {{x, y, tip}, {x, y, tip + 0.06}, radius, radius};
    if (palpable_press(session, &finger, 1) != PALPABLE_OK) return fails("press");
    palpable_frame frame = {.size = sizeof frame};
    if (palpable_get_frame(session, &frame) != PALPABLE_OK) return fails("frame");
    if (frame.answer != PALPABLE_REACHED) {
      return fprintf(stderr, "press_finger: %.1f mm left to go\n", 1e3 * frame.left_to_go), 1;
    }
    palpable_touch touch = {.size = sizeof touch};
    if (palpable_get_touch(session, 0, &touch) != PALPABLE_OK) return fails("touch");
    force = hypot(hypot(touch.force[0], touch.force[1]), touch.force[2]);
    depth = touch.depth;
    if (step == 4) half_way = force;
  }
  /* What moved farthest. */
  palpable_get_skin(session, 0, &skin);
  const double moved = z - skin.vertices[3 * top + 2];
  printf("%.2f N, the skin gives way by %.2f mm\n", force, 1e3 * moved);

  palpable_close(session);
  palpable_free_body(body);
  /* Twice as deep takes more than twice the force: a round finger touches more of the skin. */
  return fabs(depth - 0.004) < 0.0005 && moved > 0.003 && moved < 0.0045 && force > 2 * half_way
             ? 0
             : 1;
}
