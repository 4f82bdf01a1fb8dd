#version 450 core
// Makes one triangle that covers the viewport from gl_VertexID (draw three vertices).
out vec2 uv;  // 0..1 across the viewport, row 0 of the picture at 0

void main() {
  uv = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
