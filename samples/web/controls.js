// SPDX-License-Identifier: MIT
// Mouse, touch and keyboard for a view. Where the pointer is on the model, it bends it; beside it, it turns the
// camera. Two fingers, the wheel, + and - zoom. The keys are in README.md.

const TURN = 0.4;  // degrees a CSS pixel
const STEP = 10;   // degrees a key
const BREEZE = 6;  // m / s^2

export function control(view) {
  const {canvas} = view;
  const pointers = new Map();
  let mode = null, last = null, spread = 0;

  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top, time: event.timeStamp};
  };
  const turn = (dx, dy) => {
    const {yaw, pitch} = view.camera;
    view.camera = {yaw: yaw - dx * TURN, pitch: pitch + dy * TURN};
  };
  const pan = (dx, dy) => {
    const [x, y] = view.camera.pan;
    view.camera = {pan: [x + dx / canvas.clientHeight, y - dy / canvas.clientHeight]};
  };
  const zoom = (factor) => { view.camera = {zoom: view.camera.zoom * factor}; };
  const middle = () => {
    const [a, b] = pointers.values();
    return {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, spread: Math.hypot(a.x - b.x, a.y - b.y)};
  };

  function down(event) {
    canvas.setPointerCapture(event.pointerId);
    const at = place(event);
    pointers.set(event.pointerId, at);
    if (pointers.size === 1) {
      if (event.button !== 0 || event.shiftKey) mode = 'pan';
      else mode = view.grab(at.x, at.y) ? 'bend' : 'turn';
      last = at;
    } else if (pointers.size === 2) {
      view.release();
      mode = 'pinch';
      last = middle();
      spread = last.spread;
    }
  }

  function move(event) {
    const at = place(event);
    if (!pointers.has(event.pointerId)) {
      if (last && event.pointerType === 'mouse')
        view.stroke(last.x, last.y, at.x, at.y, (at.time - last.time) / 1000);
      last = at;
      return;
    }
    pointers.set(event.pointerId, at);
    if (mode === 'bend') view.drag(at.x, at.y);
    if (mode === 'turn') turn(at.x - last.x, at.y - last.y);
    if (mode === 'pan') pan(at.x - last.x, at.y - last.y);
    if (mode === 'pinch' && pointers.size === 2) {
      const now = middle();
      if (spread > 0 && now.spread > 0) zoom(now.spread / spread);
      pan(now.x - last.x, now.y - last.y);
      spread = now.spread;
      last = now;
      return;
    }
    last = at;
  }

  function up(event) {
    if (!pointers.delete(event.pointerId)) return;
    if (mode === 'bend') view.release();
    mode = null;
    last = null;
    for (const at of pointers.values()) {  // one finger of two stays: it turns
      mode = 'turn';
      last = at;
    }
  }

  function wheel(event) {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)));
  }

  function breeze(strength) {
    const angle = view.camera.yaw * Math.PI / 180;
    view.wind([strength * Math.cos(angle), 0, -strength * Math.sin(angle)]);
    setTimeout(() => view.wind([0, 0, 0]), 350);
  }

  const keys = {
    ArrowLeft: (shift) => shift ? pan(-20, 0) : turn(STEP / TURN, 0),
    ArrowRight: (shift) => shift ? pan(20, 0) : turn(-STEP / TURN, 0),
    ArrowUp: (shift) => shift ? pan(0, -20) : turn(0, STEP / TURN),
    ArrowDown: (shift) => shift ? pan(0, 20) : turn(0, -STEP / TURN),
    '+': () => zoom(1.2),
    '=': () => zoom(1.2),
    '-': () => zoom(1 / 1.2),
    0: () => { view.camera = {yaw: 30, pitch: 15, zoom: 1, pan: [0, 0]}; },
    ' ': () => view.playing ? view.pause() : view.clip ? view.pause(false) : view.description?.clips.length && view.play(0),
    b: () => breeze(BREEZE),
    B: () => breeze(-BREEZE),
  };
  function key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key](event.shiftKey);
  }

  const listeners = {pointerdown: down, pointermove: move, pointerup: up, pointercancel: up, wheel, keydown: key,
                     contextmenu: (event) => event.preventDefault(), pointerleave: () => { if (!mode) last = null; }};
  for (const [type, listener] of Object.entries(listeners))
    canvas.addEventListener(type, listener, {passive: false});
}
