// Pictures of modes on the body, to be turned by hand: one WebGL context draws them all.
"use strict";

// Base64 of little-endian numbers.
function numbers(text, Type) {
  const raw = atob(text);
  const all = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) all[i] = raw.charCodeAt(i);
  return new Type(all.buffer);
}

const VERTEX_SHADER = `
attribute vec3 position, moved, normal;
attribute float shade;
uniform mat3 turn;
uniform vec3 middle;
uniform float size, aspect, deform;
varying vec3 n;
varying float s;
void main() {
  vec3 x = turn * (position + deform * moved - middle) / size;
  gl_Position = vec4(x.x / aspect, x.y, -0.4 * x.z, 1.0);
  n = turn * normal;
  s = shade;
}`;
const FRAGMENT_SHADER = `
precision mediump float;
varying vec3 n;
varying float s;
uniform bool diverging;
uniform vec3 ramp[5];
void main() {
  float t = diverging ? 0.5 + 0.5 * clamp(s, -1.0, 1.0) : clamp(s, 0.0, 1.0);
  vec3 c = mix(ramp[0], ramp[1], clamp(4.0 * t, 0.0, 1.0));
  c = mix(c, ramp[2], clamp(4.0 * t - 1.0, 0.0, 1.0));
  c = mix(c, ramp[3], clamp(4.0 * t - 2.0, 0.0, 1.0));
  c = mix(c, ramp[4], clamp(4.0 * t - 3.0, 0.0, 1.0));
  vec3 m = normalize(n);
  float light = 0.56 + 0.36 * max(0.0, dot(m, normalize(vec3(0.4, 0.7, 0.8)))) + 0.12 * max(0.0, m.z);
  gl_FragColor = vec4(c * light, 1.0);
}`;
// Perceptually even: a magnitude from pale to deep, a signed value from blue over white to red.
const SEQUENTIAL = [[0.93, 0.94, 0.95], [0.99, 0.85, 0.55], [0.96, 0.58, 0.32], [0.80, 0.24, 0.32], [0.36, 0.08, 0.33]];
const DIVERGING = [[0.13, 0.33, 0.64], [0.53, 0.71, 0.87], [0.95, 0.95, 0.94], [0.95, 0.64, 0.49], [0.69, 0.11, 0.17]];
const css = (ramp) => `linear-gradient(90deg, ${ramp.map((c) => `rgb(${c.map((v) => Math.round(255 * v)).join(" ")})`).join(", ")})`;

class ModePictures {
  constructor(mesh) {
    const quantised = numbers(mesh.vertices, Uint16Array);
    this.vertices = new Float32Array(quantised.length);
    for (let i = 0; i < quantised.length; ++i) this.vertices[i] = mesh.low[i % 3] + (quantised[i] / 65535) * mesh.size[i % 3];
    this.triangles = numbers(mesh.triangles, mesh.wide ? Uint32Array : Uint16Array);
    this.middle = mesh.low.map((low, k) => low + mesh.size[k] / 2);
    this.size = Math.max(mesh.size[2], Math.hypot(mesh.size[0], mesh.size[1])) * 0.58;
    this.height = Math.max(...mesh.size);
    this.azimuth = 0.5;
    this.elevation = 0.3;
    this.zoom = 1;
    this.tiles = [];
    this.canvas = document.createElement("canvas");
    const gl = this.canvas.getContext("webgl", { antialias: true, alpha: true, premultipliedAlpha: true, preserveDrawingBuffer: true });
    this.gl = gl;
    if (!gl || (mesh.wide && !gl.getExtension("OES_element_index_uint"))) { this.gl = null; return; }
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.program = program;
    this.index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, this.triangles, gl.STATIC_DRAW);
    this.indexType = mesh.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
    gl.enable(gl.DEPTH_TEST);
    this.position = this.buffer(this.vertices);
  }
  buffer(values) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, values, this.gl.STATIC_DRAW);
    return buffer;
  }
  // Area-weighted normals of the body moved by `scale` times `moved`.
  normals(moved, scale) {
    const x = this.vertices.slice(), n = new Float32Array(x.length), t = this.triangles;
    if (moved) for (let i = 0; i < x.length; ++i) x[i] += scale * moved[i];
    for (let k = 0; k < t.length; k += 3) {
      const a = 3 * t[k], b = 3 * t[k + 1], c = 3 * t[k + 2];
      const ux = x[b] - x[a], uy = x[b + 1] - x[a + 1], uz = x[b + 2] - x[a + 2];
      const vx = x[c] - x[a], vy = x[c + 1] - x[a + 1], vz = x[c + 2] - x[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const i of [a, b, c]) { n[i] += nx; n[i + 1] += ny; n[i + 2] += nz; }
    }
    for (let i = 0; i < n.length; i += 3) {
      const length = Math.hypot(n[i], n[i + 1], n[i + 2]) || 1;
      n[i] /= length; n[i + 1] /= length; n[i + 2] /= length;
    }
    return n;
  }
  // The azimuth from which a tile's largest values are seen, a little from the side.
  front(shade) {
    let x = 0, y = 0;
    for (let v = 0; v < shade.length; ++v) {
      const weight = shade[v] * shade[v];
      x += weight * (this.vertices[3 * v] - this.middle[0]);
      y += weight * (this.vertices[3 * v + 1] - this.middle[1]);
    }
    return Math.atan2(x, -y) + 0.6;
  }
  // moved: (3V) m or null; exaggerate: factor on it; shade: (V); top: value of full colour;
  // facing: seen from where it is largest, else as all others.
  add(canvas, tile) {
    const entry = { canvas, ...tile };
    this.tiles.push(entry);
    if (!this.gl) return entry;
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!(event.buttons & 1)) return;
      this.azimuth -= event.movementX * 0.01;
      this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + event.movementY * 0.01));
      this.draw();
    });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      this.zoom = Math.max(0.5, Math.min(8, this.zoom * Math.exp(-0.0015 * (event.deltaY || event.deltaX))));
      this.draw();
    }, { passive: false });
    canvas.addEventListener("dblclick", () => { this.azimuth = 0.5; this.elevation = 0.3; this.zoom = 1; this.draw(); });
    entry.azimuth = tile.facing ? this.front(entry.shade) - this.azimuth : 0;
    this.prepare(entry);
    return entry;
  }
  prepare(entry) {
    const shade = new Float32Array(entry.shade.length);
    for (let i = 0; i < shade.length; ++i) shade[i] = entry.top > 0 ? entry.shade[i] / entry.top : 0;
    for (const old of ["moved_", "normal_", "shade_"]) if (entry[old]) this.gl.deleteBuffer(entry[old]);
    entry.moved_ = this.buffer(entry.moved || new Float32Array(this.vertices.length));
    entry.normal_ = this.buffer(this.normals(entry.moved, entry.exaggerate));
    entry.shade_ = this.buffer(shade);
  }
  draw() {
    const gl = this.gl;
    if (!gl || this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      for (const entry of this.tiles) this.drawTile(entry);
    });
  }
  drawTile(entry) {
    const gl = this.gl, canvas = entry.canvas, ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    if (this.canvas.width !== width || this.canvas.height !== height) { this.canvas.width = width; this.canvas.height = height; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const at = (name) => gl.getUniformLocation(this.program, name);
    const azimuth = this.azimuth + entry.azimuth;
    const ca = Math.cos(azimuth), sa = Math.sin(azimuth), ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    // Body frame, Z up. Rows: to the right, up, towards the eye; GL reads columns.
    const right = [ca, sa, 0], up = [-se * sa, se * ca, ce], eye = [ce * sa, -ce * ca, se];
    const turn = [0, 1, 2].flatMap((k) => [right[k], up[k], eye[k]]);
    gl.uniformMatrix3fv(at("turn"), false, turn);
    gl.uniform3fv(at("middle"), this.middle);
    gl.uniform1f(at("size"), this.size / this.zoom);
    gl.uniform1f(at("aspect"), width / height);
    gl.uniform1f(at("deform"), entry.moved ? entry.exaggerate : 0);
    gl.uniform1i(at("diverging"), entry.signed ? 1 : 0);
    gl.uniform3fv(at("ramp"), (entry.signed ? DIVERGING : SEQUENTIAL).flat());
    for (const [name, buffer, count] of [["position", this.position, 3], ["moved", entry.moved_, 3], ["normal", entry.normal_, 3], ["shade", entry.shade_, 1]]) {
      const place = gl.getAttribLocation(this.program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    gl.drawElements(gl.TRIANGLES, this.triangles.length, this.indexType, 0);
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, width, height);
    context.drawImage(this.canvas, 0, 0);
  }
}
