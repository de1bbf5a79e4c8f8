// Mouse, touch and keys on the picture. What they mean is the page's business: see page.js.
//
// Everything in pixels of the device, as the view's.

// Pixels of CSS that a press may wander and still be a press; an arrow key's step.
const WANDER = 4, STEP = 40;
// Zoom by a wheel's pixel, by its line, and by a pinch on a touch pad (which comes as ctrl + wheel).
const BY_PIXEL = 0.0015, BY_LINE = 0.05, BY_PINCH = 5;

export function listen(canvas, { ratio, panBy, zoomBy, pointAt, press, leave, keys }) {
  const down = new Map();
  let began = null;
  const place = event => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * ratio(), (event.clientY - box.top) * ratio()];
  };

  canvas.addEventListener('pointerdown', event => {
    if (event.button > 0) return;
    canvas.setPointerCapture(event.pointerId);
    began = down.size ? null : place(event);
    down.set(event.pointerId, place(event));
  });
  canvas.addEventListener('pointermove', event => {
    const now = place(event), before = down.get(event.pointerId);
    if (before) {
      const other = [...down].find(([id]) => id !== event.pointerId)?.[1];
      if (other) pinch(before, now, other); else panBy(now[0] - before[0], now[1] - before[1]);
      down.set(event.pointerId, now);
      if (began && Math.hypot(now[0] - began[0], now[1] - began[1]) > WANDER * ratio()) began = null;
    }
    if (down.size < 2) pointAt(...now);
  });
  // Two fingers: the zoom is the quotient of their distances, the pan the way of their middle.
  const pinch = (before, now, other) => {
    const was = Math.hypot(before[0] - other[0], before[1] - other[1]);
    const is = Math.hypot(now[0] - other[0], now[1] - other[1]);
    if (was > 0 && is > 0) zoomBy(is / was, (before[0] + other[0]) / 2, (before[1] + other[1]) / 2);
    panBy((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
  };
  const release = event => {
    if (down.delete(event.pointerId) && began && event.type === 'pointerup') {
      pointAt(...place(event));
      press(...place(event));
    }
    began = null;
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('pointerleave', event => { if (event.pointerType === 'mouse' && !down.size) leave(); });
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    const rate = (event.deltaMode ? BY_LINE : BY_PIXEL) * (event.ctrlKey ? BY_PINCH : 1);
    zoomBy(Math.exp(-event.deltaY * rate), ...place(event));
  }, { passive: false });
  canvas.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = STEP * ratio(), moves = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (moves[event.key]) panBy(...moves[event.key], true);
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  });
}
