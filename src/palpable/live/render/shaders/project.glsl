// Maps the camera frame (X right, Y down, Z forward) to clip space, such that the centre of pixel
// (u, v) of the picture is the centre of window pixel (u, v): row 0 of the framebuffer is the top
// row of the picture. Needs depth.glsl.

uniform vec4 pinhole;  // fx, fy, cx, cy in px; pixel (0, 0) is the centre of the first pixel
uniform vec2 size;     // width, height in px
uniform float near;    // m

vec4 clip_of_camera(vec3 x) {
  // ndc = 2 (u + 1/2) / width - 1  with  u = fx X / Z + cx, times w = Z
  vec2 ndc_w = 2.0 * (pinhole.xy * x.xy + (pinhole.zw + 0.5) * x.z) / size - x.z;
  return vec4(ndc_w, window_depth(x.z, near) * x.z, x.z);
}
