#version 450 core
// Draws a bright studio: a floor with a faint grid that fades into the backdrop.
in vec2 uv;

uniform vec4 pinhole;          // fx, fy, cx, cy in px
uniform mat3 body_from_camera; // directions
uniform vec3 eye;              // of the camera in the body frame, m; the floor is Z = 0
uniform float fade;            // m from the origin at which the floor has faded out

layout(location = 0) out vec4 color;  // sRGB

const vec3 kFloor = vec3(0.885, 0.893, 0.905);
const vec3 kHorizon = vec3(0.80, 0.82, 0.85);
const vec3 kTop = vec3(0.60, 0.64, 0.70);

/// The share of a pixel covered by grid lines at integers of x, 1 px wide. Fades out where lines
/// would be nearer than about 4 px to each other.
float line_share(vec2 x) {
  vec2 footprint = max(fwidth(x), vec2(1e-6));
  vec2 to_line = abs(fract(x - 0.5) - 0.5) / footprint;
  vec2 share = clamp(1.2 - to_line, 0.0, 1.0) * (1.0 - smoothstep(0.07, 0.25, footprint));
  return max(share.x, share.y);
}

void main() {
  vec3 ray = body_from_camera * vec3((gl_FragCoord.xy - 0.5 - pinhole.zw) / pinhole.xy, 1.0);
  float slope = ray.z / length(ray);
  vec3 backdrop = mix(kHorizon, kTop, smoothstep(-0.15, 0.55, slope));
  float t = -eye.z / ray.z;
  vec2 floor_at = eye.xy + t * ray.xy;
  float reach = t > 0.0 ? length(floor_at) / fade : 1e3;
  float there = 1.0 - smoothstep(0.25, 1.0, reach);
  vec3 ground = kFloor;
  float fine = line_share(floor_at / 0.01), coarse = line_share(floor_at / 0.05);
  ground -= vec3(0.05, 0.045, 0.038) * fine + vec3(0.11, 0.10, 0.085) * coarse;
  color = vec4(mix(backdrop, ground, there), 1.0);
}
