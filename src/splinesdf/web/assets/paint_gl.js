// The picture by WebGL2: for large windows on machines with a graphics processor.
//
// Few leaves in view: a quad for each, expanded about the view. Many: one triangle over the window,
// and a walk down the tree, which lies in textures; float32 is enough there, as the view is wide.
import { evaluate } from './evaluate.js';
import { expandLeaves, ROW } from './expand.js';
import { QUADS_FRAGMENT, QUADS_VERTEX, WALK_FRAGMENT, WALK_VERTEX } from './shaders.js';
import { visibleLeaves } from './tree.js';

// Leaves in view beyond which the walk is quicker than quads; words in a row of the textures, which
// WebGL2 always has; the mesh's share.
const MOST_QUADS = 6000, WIDE = 2048, MESH = 0.6;
// Pixels of the whole domain beyond which the walk's float32 is seen: its values are off by 1e-3
// pixels from some 10⁶ on.
const WIDEST = 1e5;
// The largest table of nodes that the search begins in, as a share of the cells.
const TABLE = 2;
// Renderers that are programs of the processor. Trying them would freeze the page for seconds.
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether there is WebGL2 that is no program of the processor; the context that was asked is let go. */
export function hasGraphics() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const told = gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return !SOFTWARE.test(renderer);
}

/** A painter on a canvas of its own; null without WebGL2. */
export function glPainter(canvas, tree) {
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  let made = null, rows = new Float32Array(ROW * 1024), lost = false;
  canvas.addEventListener('webglcontextlost', event => { event.preventDefault(); lost = true; made = null; });
  canvas.addEventListener('webglcontextrestored', () => { lost = false; });

  function draw(job, probe, only) {
    if (lost || gl.isContextLost()) return 0;
    made ??= { quads: program(gl, QUADS_VERTEX, QUADS_FRAGMENT), ...leafBuffer(gl), walk: null };
    gl.viewport(0, 0, job.width, job.height);
    gl.clearColor(...(probe ? [1, 1, 1, 1] : [...job.colors.ground, 1]));
    gl.clear(gl.COLOR_BUFFER_BIT);
    const wide = job.scale * Math.max(tree.xs[tree.m] - tree.xs[0], tree.ys[tree.n] - tree.ys[0]);
    const most = only === 'quads' || !tree.uniform || wide > WIDEST ? Infinity : MOST_QUADS;
    const leaves = only === 'walk' ? null : visibleLeaves(tree, job, 0, job.height, most);
    if (leaves) return drawQuads(job, probe, leaves);
    drawWalk(job, probe);
    return 0;
  }
  function drawQuads(job, probe, leaves) {
    const base = evaluate(tree, job.cx, job.cy)?.value ?? 0, u = made.quads.uniforms;
    if (rows.length < ROW * leaves.length) rows = new Float32Array(2 * ROW * leaves.length);
    expandLeaves(tree, job, leaves, base, job.mesh ? MESH : 0, rows);
    gl.useProgram(made.quads.program);
    setShade(gl, u, job, base, probe);
    gl.uniform2f(u.uHalf, job.width / 2, job.height / 2);
    gl.uniform1f(u.uUp, -job.down);
    gl.bindVertexArray(made.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, rows.subarray(0, ROW * leaves.length), gl.DYNAMIC_DRAW);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, leaves.length);
    return base;
  }
  function drawWalk(job, probe) {
    made.walk ??= { ...program(gl, WALK_VERTEX, WALK_FRAGMENT), ...treeTextures(gl, tree) };
    const { uniforms: u, enter, tableRows } = made.walk, { xs, ys, m, n, depth } = tree;
    const perX = m * 2 ** depth / (xs[m] - xs[0]), perY = n * 2 ** depth / (ys[n] - ys[0]);
    const x = (job.cx - xs[0]) * perX, y = (job.cy - ys[0]) * perY;
    gl.useProgram(made.walk.program);
    setShade(gl, u, job, 0, probe);
    gl.uniform1i(u.uCells, 0);
    gl.uniform1i(u.uTree, 1);
    gl.uniform2i(u.uAnchor, Math.floor(x), Math.floor(y));
    gl.uniform2f(u.uFraction, x - Math.floor(x), y - Math.floor(y));
    gl.uniform2f(u.uLattice, perX / job.scale, -job.down * perY / job.scale);
    gl.uniform2f(u.uHalf, job.width / 2, job.height / 2);
    gl.uniform2i(u.uSize, m * 2 ** depth, n * 2 ** depth);
    gl.uniform1i(u.uDepth, depth);
    gl.uniform1i(u.uEnter, enter);
    gl.uniform1i(u.uRows, tableRows);
    gl.uniform1i(u.uWide, WIDE);
    gl.uniform1f(u.uMeshShare, job.mesh ? MESH : 0);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
  function paint(job, only) {
    if (canvas.width !== job.width || canvas.height !== job.height) {
      canvas.width = job.width;
      canvas.height = job.height;
    }
    draw(job, false, only);
    // Waits for the graphics processor: without it a frame would be timed as its calls alone.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
  return {
    name: 'gl', paint, stop() {}, usable: () => !lost && !gl.isContextLost(),
    /** Values at pixels' centers as the shaders have them, NaN where nothing is painted. */
    values(job, only) {
      // Into a buffer of its own: a canvas without alpha would overwrite the exponents.
      const frame = gl.createFramebuffer(), store = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, store);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, job.width, job.height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, store);
      const base = draw(job, true, only), bytes = new Uint8Array(4 * job.width * job.height);
      gl.readPixels(0, 0, job.width, job.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.deleteFramebuffer(frame);
      gl.deleteRenderbuffer(store);
      const floats = new Float32Array(bytes.buffer), values = new Float64Array(floats.length);
      for (let y = 0; y < job.height; y++) for (let x = 0; x < job.width; x++) {
        values[y * job.width + x] = floats[(job.height - 1 - y) * job.width + x] + base;
      }
      return values;
    },
  };
}

function setShade(gl, u, job, base, probe) {
  const { colors } = job, phase = base / job.spacing;
  gl.uniform1f(u.uLevel, job.level - base);
  gl.uniform1f(u.uSpacing, job.spacing);
  gl.uniform1f(u.uBase, base);
  gl.uniform1f(u.uPhase, phase - Math.floor(phase));
  gl.uniform1f(u.uPixel, 1 / job.scale);
  gl.uniform1f(u.uRange, job.range);
  gl.uniform1f(u.uThick, job.thick);
  gl.uniform1i(u.uBands, job.bands ? 1 : 0);
  gl.uniform1i(u.uProbe, probe ? 1 : 0);
  gl.uniform3fv(u.uInside, colors.inside);
  gl.uniform3fv(u.uOutside, colors.outside);
  gl.uniform3fv(u.uLine, colors.line);
  gl.uniform3fv(u.uMesh, colors.mesh);
  gl.uniform3fv(u.uLevelColor, colors.level);
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(made));
  const uniforms = {};
  for (let i = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); i-- > 0;) {
    const { name } = gl.getActiveUniform(made, i);
    uniforms[name] = gl.getUniformLocation(made, name);
  }
  return { program: made, uniforms };
}

function leafBuffer(gl) {
  const array = gl.createVertexArray(), buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  for (let i = 0; i < 5; i++) {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, i < 4 ? 4 : 1, gl.FLOAT, false, 4 * ROW, 16 * i);
    gl.vertexAttribDivisor(i, 1);
  }
  return { array, buffer };
}

function treeTextures(gl, tree) {
  const { m, n, child, cellOf, cells, depth, power } = tree;
  let enter = 0;
  while (enter < depth && m * n * 4 ** (enter + 1) <= TABLE * cells) enter++;
  const columns = m << enter, tableRows = n << enter, start = columns * tableRows;
  const words = new Int32Array(Math.ceil((start + child.length) / WIDE) * WIDE);
  for (let i = 0; i < columns; i++) for (let j = 0; j < tableRows; j++) {
    let node = (i >> enter) * n + (j >> enter), up = enter;
    while (up > 0 && child[node] >= 0) { up--; node = child[node] + 2 * (i >> up & 1) + (j >> up & 1); }
    words[i * tableRows + j] = child[node] >= 0 ? start + child[node] : ~(32 * cellOf[node] + up);
  }
  child.forEach((first, node) => { words[start + node] = first >= 0 ? start + first : ~cellOf[node]; });
  const texels = new Float32Array(Math.ceil(2 * cells / WIDE) * WIDE * 4);
  texels.set(power);
  texture(gl, 0, gl.RGBA32F, gl.RGBA, gl.FLOAT, texels, texels.length / WIDE / 4);
  texture(gl, 1, gl.R32I, gl.RED_INTEGER, gl.INT, words, words.length / WIDE);
  return { enter, tableRows };
}

function texture(gl, unit, kind, format, type, data, height) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texImage2D(gl.TEXTURE_2D, 0, kind, WIDE, height, 0, format, type, data);
}
