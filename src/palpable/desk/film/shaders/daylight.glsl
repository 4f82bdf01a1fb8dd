// Linear light. The light of the window (the sun) comes from one direction, that of the room from all
// directions, more from above than from below.
const vec3 kSun = vec3(1.10, 1.04, 0.95);
const vec3 kSky = vec3(0.46, 0.50, 0.56);
const vec3 kGround = vec3(0.25, 0.21, 0.18);

vec3 room_light(vec3 normal) { return mix(kGround, kSky, 0.5 + 0.5 * normal.z); }
