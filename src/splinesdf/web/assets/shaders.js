// The picture's shaders (WebGL2): the same fill, lines and mesh as paint_canvas.js.
//
// float32 all of it: what must be exact is brought near zero by JavaScript first, see expand.js.
// Precisions are written out: samplers are low by default, and some phones then halve texels.

// d: the value less `uBase`; g: its change a pixel; edge: pixels to the nearest line of the mesh.
const SHADE = `
uniform float uLevel, uSpacing, uBase, uPhase, uPixel, uRange, uThick;
uniform bool uBands;
uniform int uProbe;
uniform vec3 uInside, uOutside, uLine, uMesh, uLevelColor;
out vec4 result;
void shade(float d, vec2 g, float edge, float meshShare) {
  if (uProbe > 0) {
    uint bits = floatBitsToUint(d);
    result = vec4(bits & 255u, (bits >> 8) & 255u, (bits >> 16) & 255u, bits >> 24) / 255.0;
    return;
  }
  float slope = clamp(length(g), 0.25 * uPixel, 1.25 * uPixel), v = d + uBase, f = d / uSpacing + uPhase;
  vec3 color = v < 0.0 ? uInside : uOutside;
  color = mix(color, vec3((color.r + color.g + color.b) / 3.0), 0.55 * min(1.0, abs(v) / uRange));
  if (edge < 1.1) color = mix(color, uMesh, meshShare * min(1.0, 1.1 - edge));
  float band = abs(f - round(f)) * uSpacing;
  if (uBands) color = mix(color, uLine, 0.45 * clamp(0.5 + uThick / 2.0 - band / slope, 0.0, 1.0));
  color = mix(color, uLine, clamp(1.1 * uThick + 0.5 - abs(v) / slope, 0.0, 1.0));
  color = mix(color, uLevelColor, clamp(1.3 * uThick + 0.5 - abs(d - uLevel) / slope, 0.0, 1.0));
  result = vec4(color, 1.0);
}
// st from the middle of a part of a cell, of -½ to ½; e: the two diagonals' offsets, and the part's
// sides as shares of the larger one; inv: parts a pixel.
void leaf(vec4 a, vec4 b, vec4 e, vec2 st, vec2 inv, float meshShare) {
  float s = st.x, t = st.y, p = s * e.z, q = t * e.w;
  vec2 diagonal = vec2(e.x + p - q, e.y + p + q);
  float r = max(diagonal.x, 0.0), l = max(diagonal.y, 0.0);
  vec2 g = vec2(a.y + 2.0 * a.w * s + b.x * t + 2.0 * e.z * (b.z * r + b.w * l),
                a.z + b.x * s + 2.0 * b.y * t + 2.0 * e.w * (b.w * l - b.z * r)) * inv;
  vec2 side = (0.5 - abs(st)) / abs(inv), across = abs(diagonal) / length(e.zw * inv);
  float edge = min(min(side.x, side.y), 1.5 * min(across.x, across.y));
  float d = a.x + s * (a.y + a.w * s + b.x * t) + t * (a.z + b.y * t) + b.z * r * r + b.w * l * l;
  shade(d, g, edge, meshShare);
}`;

const HEAD = '#version 300 es\nprecision highp float; precision highp int;\n';

// Vertices are snapped to 1/16 of a pixel by software, so that a pixel near a side could get the
// neighbor's quadratic. Quads are grown by more than that, and a pixel's own place decides which
// cell it is in: SLACK, in pixels, is more than float32 loses there, so that no crack opens.
const GROWN = '0.125', SLACK = '0.001';

export const QUADS_VERTEX = `${HEAD}
layout(location = 0) in vec4 box; layout(location = 1) in vec4 a; layout(location = 2) in vec4 b;
layout(location = 3) in vec4 e; layout(location = 4) in float share;
uniform vec2 uHalf;
uniform float uUp;
flat out vec4 va, vb, ve, vi;
flat out float vm;
void main() {
  // Pixels from the view's center; sides are the neighbor's own numbers, so that no crack opens.
  vec2 corner = vec2((gl_VertexID & 1) == 1 ? box.z + ${GROWN} : box.x - ${GROWN},
                     (gl_VertexID >> 1) == 1 ? box.w + ${GROWN} : box.y - ${GROWN});
  vec2 turned = vec2(1.0, uUp);
  gl_Position = vec4(corner * turned / uHalf, 0.0, 1.0);
  va = a; vb = b; ve = e; vm = share;
  vi = vec4(turned / (box.zw - box.xy), 0.5 * (box.xy + box.zw) * turned + uHalf);
}`;

// s, t from gl_FragCoord: varyings are off by what vertices are snapped by, 1/16 of a pixel.
export const QUADS_FRAGMENT = `${HEAD}
flat in vec4 va, vb, ve, vi;
flat in float vm;
${SHADE}
void main() {
  vec2 st = (gl_FragCoord.xy - vi.zw) * vi.xy, beyond = (abs(st) - 0.5) / abs(vi.xy);
  if (max(beyond.x, beyond.y) > ${SLACK}) discard;
  leaf(va, vb, ve, st, vi.xy, vm);
}`;

export const WALK_VERTEX = `${HEAD}
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

// The tree in a texture: an entry is a node's first child, or ~ of its cell. The search begins in a
// table of all nodes of level uEnter (~(32 cell + levels up), if a leaf is above it).
export const WALK_FRAGMENT = `${HEAD}
precision highp sampler2D; precision highp isampler2D;
uniform sampler2D uCells; uniform isampler2D uTree;
uniform ivec2 uAnchor, uSize; uniform vec2 uFraction, uLattice, uHalf;
uniform int uDepth, uEnter, uRows, uWide; uniform float uMeshShare;
${SHADE}
int entry(int i) { return texelFetch(uTree, ivec2(i & (uWide - 1), i / uWide), 0).x; }
void main() {
  vec2 f = uFraction + (gl_FragCoord.xy - uHalf) * uLattice, whole = floor(f);
  ivec2 at = uAnchor + ivec2(whole);
  f -= whole;
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, uSize))) discard;
  int shift = uDepth - uEnter, word = entry((at.x >> shift) * uRows + (at.y >> shift)), cell = 0;
  if (word < 0) { word = ~word; shift += word & 31; cell = word >> 5; }
  else for (int n = 0; n < 32; n++) {
    shift--;
    word = entry(word + 2 * ((at.x >> shift) & 1) + ((at.y >> shift) & 1));
    if (word < 0) { cell = ~word; break; }
  }
  float part = 1.0 / float(1 << shift);
  vec2 st = (vec2(at & ((1 << shift) - 1)) + f) * part - 0.5, inv = uLattice * part;
  int x = (2 * cell) & (uWide - 1), y = (2 * cell) / uWide;
  float least = 1.0 / max(abs(inv.x), abs(inv.y));
  leaf(texelFetch(uCells, ivec2(x, y), 0), texelFetch(uCells, ivec2(x + 1, y), 0),
       vec4(0.0, 0.0, 1.0, 1.0), st, inv, uMeshShare * clamp((least - 3.0) / 3.0, 0.0, 1.0));
}`;
