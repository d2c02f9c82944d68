// Lines: all moves of a record on the graphics processor.
//
// The vertex shader reads a move's two places from a texture by the number of the vertex. So there is one small shader,
// no copy of a place, and no instances: a software renderer (SwiftShader) draws these 40 times faster than instances.
// What cannot be drawn within a frame is drawn over the next ones, and the picture is whole when all is drawn.

const WIDE = 2048;
const VERTEX = `#version 300 es
precision highp float; precision highp int;
uniform highp sampler2D points; uniform highp usampler2D codes; uniform mediump sampler2D palette;
uniform mat3 turn; uniform vec3 centre; uniform vec2 size; uniform float scale, reach, thin; uniform uint hidden; uniform vec4 only;
flat out vec3 colour; out float across;
void main() {
  int move = gl_VertexID / 6, corner = gl_VertexID - move * 6;
  corner = corner < 3 ? corner : 6 - corner;
  int next = move + 1;
  uvec2 code = texelFetch(codes, ivec2(move & 2047, move >> 11), 0).rg;
  if (code.g > 31u || (hidden >> code.g & 1u) == 1u) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  vec4 from = texelFetch(points, ivec2(move & 2047, move >> 11), 0);
  vec3 a = turn * (from.xyz - centre), b = turn * (texelFetch(points, ivec2(next & 2047, next >> 11), 0).xyz - centre);
  float side = float(corner >> 1) * 2.0 - 1.0, end = float(corner & 1);
  vec2 along = b.xy - a.xy;
  float way = length(along);
  along = way > 0.0 ? along / way : vec2(1.0, 0.0);
  float half_px = max(from.w * scale, thin) * 0.5;
  vec3 place = end > 0.5 ? b : a;
  // A wide line goes on for a part of its width, so that corners are closed.
  vec2 off = vec2(-along.y, along.x) * side + along * (end * 2.0 - 1.0) * (half_px > 1.0 ? 0.7 : 0.0);
  gl_Position = vec4((place.xy * scale + off * half_px) * 2.0 / size, -place.z / reach, 1.0);
  colour = only.a > 0.5 ? only.rgb : texelFetch(palette, ivec2(int(code.r), 0), 0).rgb;
  across = half_px > 1.5 ? side : 0.0;
}`;
const FRAGMENT = `#version 300 es
precision mediump float;
flat in vec3 colour; in float across; out vec4 result;
void main() { result = vec4(colour * (1.0 - 0.3 * across * across), 1.0); }`;

class Lines {
  constructor(canvas) {
    const gl = this.gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true, powerPreference: "high-performance" });
    if (!gl) throw new Error("this browser has no WebGL 2");
    const info = gl.getExtension("WEBGL_debug_renderer_info"), name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    this.isSoftware = /swiftshader|llvmpipe|software|basic render/i.test(name);
    this.program = this.compile();
    this.bodies = [];
    this.queue = [];
    /** Lines that are drawn in one frame; it follows the time that they take. */
    this.batch = this.isSoftware ? 4000 : 400000;
    this.fence = null;
  }
  compile() {
    const { gl } = this, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader); gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "the graphics driver refused the shader");
    const names = ["points", "codes", "palette", "turn", "centre", "size", "scale", "reach", "thin", "hidden", "only"];
    this.at = Object.fromEntries(names.map(name => [name, gl.getUniformLocation(program, name)]));
    gl.useProgram(program);
    gl.uniform1i(this.at.points, 0); gl.uniform1i(this.at.codes, 1); gl.uniform1i(this.at.palette, 2);
    gl.enable(gl.DEPTH_TEST); gl.depthFunc(gl.LEQUAL); gl.clearColor(0, 0, 0, 0);
    return program;
  }
  texture(unit, inner, width, height, format, type, pixels) {
    const { gl } = this, texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit); gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, format, type, pixels);
    for (const what of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, what, gl.NEAREST);
    return texture;
  }
  /** Takes the moves of a record; `only` is the one colour that they have, if any, and `thin` their least width in px. */
  add(moves, only = null, thin = 0) {
    const { gl } = this, rows = Math.ceil((moves.n + 1) / WIDE);
    const points = new Float32Array(4 * WIDE * rows);
    points.set(moves.points.subarray(0, 4 * (moves.n + 1)));
    const body = { moves, rows, only, thin, points: this.texture(0, gl.RGBA32F, WIDE, rows, gl.RGBA, gl.FLOAT, points) };
    const codes = new Uint8Array(2 * WIDE * rows);
    for (let i = 0; i < moves.n; i++) codes[2 * i + 1] = moves.type[i];
    body.bytes = codes;
    body.codes = this.texture(1, gl.RG8UI, WIDE, rows, gl.RG_INTEGER, gl.UNSIGNED_BYTE, codes);
    body.palette = this.texture(2, gl.RGBA8, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(1024));
    this.bodies.push(body);
    return body;
  }
  remove(body) {
    for (const name of ["points", "codes", "palette"]) this.gl.deleteTexture(body[name]);
    this.bodies = this.bodies.filter(other => other !== body);
    this.queue = [];
  }
  /** Gives the graphics memory back. */
  end() { this.isEnded = true; this.gl.getExtension("WEBGL_lose_context")?.loseContext(); }
  paint(body, { codes, palette }) {
    const { gl } = this;
    for (let i = 0; i < codes.length; i++) body.bytes[2 * i] = codes[i];
    gl.activeTexture(gl.TEXTURE1); gl.bindTexture(gl.TEXTURE_2D, body.codes);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDE, body.rows, gl.RG_INTEGER, gl.UNSIGNED_BYTE, body.bytes);
    gl.activeTexture(gl.TEXTURE2); gl.bindTexture(gl.TEXTURE_2D, body.palette);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, palette);
  }
  /** Sets what is seen: the camera, a bit for each type of line that is hidden, px of the thinnest line. */
  look(camera, hidden, ratio) {
    const { gl, at } = this, rows = camera.rows();
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.uniformMatrix3fv(at.turn, false, [0, 1, 2].flatMap(i => rows.map(row => row[i])));
    gl.uniform3fv(at.centre, camera.centre);
    gl.uniform2f(at.size, camera.width, camera.height);
    gl.uniform1f(at.scale, camera.scale);
    gl.uniform1f(at.reach, 4000);
    this.thin = ratio > 1 ? 0.8 : 1;
    gl.uniform1ui(at.hidden, hidden);
  }
  clear() { this.queue = []; this.gl.clear(this.gl.COLOR_BUFFER_BIT | this.gl.DEPTH_BUFFER_BIT); }
  /** Draws runs [body, first, end] now. */
  draw(runs) {
    const { gl, at } = this;
    let bound = null, sum = 0;
    for (const [body, first, end] of runs) {
      if (body !== bound) {
        bound = body;
        [body.points, body.codes, body.palette].forEach((texture, unit) => { gl.activeTexture(gl.TEXTURE0 + unit); gl.bindTexture(gl.TEXTURE_2D, texture); });
        gl.uniform1f(at.thin, Math.max(this.thin, body.thin));
        gl.uniform4fv(at.only, body.only ? [...body.only.map(v => v / 255), 1] : [0, 0, 0, 0]);
      }
      gl.drawArrays(gl.TRIANGLES, 6 * first, 6 * (end - first));
      sum += end - first;
    }
    this.mark(sum);
  }
  mark(lines) {
    const { gl } = this;
    if (this.fence) gl.deleteSync(this.fence.sync);
    this.fence = { sync: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), begin: performance.now(), lines };
    gl.flush();
  }
  /** Whether the last batch is done; sets the size of the next one by its time. */
  isReady() {
    if (!this.fence) return true;
    const { gl, fence } = this, state = gl.getSyncParameter(fence.sync, gl.SYNC_STATUS);
    if (state !== gl.SIGNALED) return false;
    const ms = performance.now() - fence.begin;
    gl.deleteSync(fence.sync); this.fence = null;
    // A software renderer needs 40 ms for a frame without any line.
    const most = this.isSoftware ? 90 : 24;
    if (ms > 1.6 * most) this.batch = Math.max(3000, this.batch * clamp(most / ms, 0.3, 1));
    else if (ms < most && fence.lines >= this.batch * 0.9) this.batch = Math.min(4e6, this.batch * 1.6);
    return true;
  }
  /** Draws the next part of the queue. */
  work() {
    const runs = [];
    for (let left = this.batch; left > 0 && this.queue.length;) {
      const run = this.queue[this.queue.length - 1], [body, first, end] = run;
      const to = Math.min(end, first + Math.ceil(left));
      runs.push([body, first, to]);
      left -= to - first;
      if (to < end) run[1] = to; else this.queue.pop();
    }
    if (runs.length) this.draw(runs);
  }
}

/**
 * A part of runs with at most `most` lines: the end of them whole, and slices of the rest; and a queue of all. Lines at one
 * depth cover those before them, so all are drawn again in their order: body by body, the highest layer first.
 */
function thinned(runs, most) {
  // Many short slices show the shape better than few long ones.
  const SLICE = clamp(Math.round(most / 128), 12, 256), sum = runs.reduce((n, [, first, end]) => n + end - first, 0);
  if (sum <= most) return [runs, []];
  const taken = [];
  let top = most / 3;
  const every = Math.max(2, Math.ceil((sum - top) / (most - top)));
  let slice = 0;
  for (let k = runs.length - 1; k >= 0; k--) {
    let [body, first, end] = runs[k];
    while (end > first) {
      const from = Math.max(first, end - SLICE);
      if (top > 0 || slice++ % every === 0) taken.push([body, from, end]);
      top -= end - from;
      end = from;
    }
  }
  const bodies = [...new Set(runs.map(([body]) => body))].reverse();
  return [taken, bodies.flatMap(body => runs.filter(run => run[0] === body).map(run => [...run]))];
}
