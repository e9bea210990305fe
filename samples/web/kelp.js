// SPDX-License-Identifier: MIT
// kelp in a page: voxel models that bend, on WebGL 2. Types and comments for users: kelp.d.ts.
import createModule from './kelp_viewer.js';
import {BlobSource, KelpError, Streamer, UrlSource} from './stream.js';

export {KelpError};

const MOVES = 1, CHANGED = 2, WAITS = 4, DRAWN = 8, FINE = 16;  // as in src/viewer.h
const STAGING = 65536;
// While the model moves, slow frames are drawn with fewer pixels: these shares of the canvas's width and height.
const SCALES = [1, 0.75, 0.5, 0.35];
const FIRST = 2;  // of SCALES; how slow frames are is not known yet
const SLOW = 100, FAST = 35;  // milliseconds a frame
const STIRS = 250;            // milliseconds that the camera counts as moving
const NO_WEBGL = 'This browser shows no WebGL 2, which kelp draws with. Try a newer browser, or switch on ' +
    'hardware acceleration in its settings.';

let compiled;  // WebAssembly.Module: compiled once for all canvases of a page

function compile() {
  const url = new URL('./kelp_viewer.wasm', import.meta.url);
  compiled ??= WebAssembly.compileStreaming(fetch(url)).catch(async () => {  // a server without its MIME type
    const answer = await fetch(url);
    if (!answer.ok) throw new KelpError(`kelp_viewer.wasm cannot be downloaded: ${answer.status}`);
    return WebAssembly.compile(await answer.arrayBuffer());
  });
  compiled.catch(() => { compiled = undefined; });
  return compiled;
}

async function instantiate() {
  const module = await compile();
  return createModule({
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then((instance) => done(instance, module));
      return {};
    },
  });
}

export async function create(canvas, options = {}) {
  if (typeof canvas?.getContext !== 'function') throw new KelpError('create() takes a canvas of a page');
  const attributes = {alpha: true, antialias: false, depth: true, stencil: false, premultipliedAlpha: true,
                      powerPreference: 'high-performance'};
  const gl = canvas.getContext('webgl2', attributes);
  if (!gl) throw new KelpError(NO_WEBGL);
  return new View(canvas, gl, attributes, await instantiate(), options);
}

export class View extends EventTarget {
  #module; #gl; #attributes; #handle = 0; #options;
  #streamer = null; #asked = 0; #frame = 0; #last = null; #resize;
  #staging; #lost = false; #ended = false; #loads = 0; #opening = null;
  #clip = -1; #time = 0; #speed = 1; #playing = false;
  #camera = {yaw: 30, pitch: 15, zoom: 1, pan: [0, 0]};
  #pose = new Map();
  #shown = {picture: false, fine: false};
  #scale = 0; #pace = 0; #drawn = 1; #stirred = -STIRS;

  constructor(canvas, gl, attributes, module, options) {
    super();
    this.canvas = canvas;
    this.description = null;
    this.bytes = null;
    this.#gl = gl;
    this.#attributes = attributes;
    this.#module = module;
    this.#options = {gpuBytes: 64 << 20, pixelRatio: null, ...options};
    this.#staging = module._malloc(STAGING);
    this.#start();
    canvas.addEventListener('webglcontextlost', this.#onLost);
    canvas.addEventListener('webglcontextrestored', this.#onRestored);
    this.#resize = new ResizeObserver(() => this.invalidate());
    this.#resize.observe(canvas);
  }

  #start() {
    const GL = this.#module.GL;
    this.#handle = GL.registerContext(this.#gl, {...this.#attributes, majorVersion: 2, minorVersion: 0});
    GL.makeContextCurrent(this.#handle);
    if (!this.#module._kelp_start(this.#options.gpuBytes)) throw new KelpError(this.#takeProblem());
  }

  // --- files ---------------------------------------------------------------------------------------
  async load(source) {
    const number = ++this.#loads;
    this.#streamer?.stop();
    this.#opening?.failed(new KelpError('another file was loaded meanwhile'));
    this.#opening = null;
    let bytes = typeof source === 'string' || source instanceof URL ? new UrlSource(source) : asBlob(source);
    let baked = null;
    if (bytes instanceof Blob && await startsWith(bytes, 'VOX ')) {
      this.#tell('progress', {stage: 'bake', arrived: 0, total: bytes.size});
      const {bakeVox} = await import('./bake.js');
      baked = await bakeVox(bytes);
      bytes = new Blob([baked]);
    }
    if (bytes instanceof Blob) bytes = new BlobSource(bytes);
    if (number !== this.#loads) throw new KelpError('another file was loaded meanwhile');
    const streamer = new Streamer(this.#heap(), bytes, {
      fed: () => streamer === this.#streamer && this.#fed(),
      failed: (error) => streamer === this.#streamer && this.#fail(error),
    });
    this.#streamer = streamer;
    await streamer.open();
    if (streamer.stopped) throw new KelpError('another file was loaded meanwhile');
    if (!this.#module._kelp_begin(bytes.size)) throw new KelpError(this.#takeProblem());
    return new Promise((done, failed) => {
      this.#opening = {done, failed, baked};
      streamer.start();
      this.#fed();
    });
  }

  #heap() {
    const module = this.#module;
    return {
      take: (most) => {
        const at = module._kelp_take(most) >> 3;
        const [offset, length] = module.HEAPF64.subarray(at, at + 2);
        return length > 0 ? {offset, length} : null;
      },
      feed: (offset, bytes) => {
        for (let i = 0; i < bytes.length; i += STAGING) {
          const piece = bytes.subarray(i, i + STAGING);
          module.HEAPU8.set(piece, this.#staging);
          module._kelp_feed(offset + i, this.#staging, piece.length);
        }
      },
      expect: ({offset, length}) => module._kelp_expect(offset, length),
      giveUp: ({offset, length}) => module._kelp_give_up(offset, length),
      arrived: () => this.sizes().arrived,
    };
  }

  // Bytes came, or may be asked for: opens what is being opened, else draws.
  #fed() {
    if (this.#ended) return;
    const {arrived, total} = this.sizes();
    this.#tell('progress', {stage: 'load', arrived, total});
    if (!this.#opening) {
      // Between frames, too: where those are slow, what comes is decoded, and more is asked for.
      this.#guard(() => this.#module._kelp_load(4), 0);
      this.#streamer.pull();
      return this.invalidate();
    }
    const opened = this.#guard(() => this.#module._kelp_open(), -1);
    if (opened > 0) {
      this.description = JSON.parse(this.#module.UTF8ToString(this.#module._kelp_description()));
      this.bytes = this.#opening.baked;
      this.#pose.clear();
      this.#clip = -1;
      this.#time = 0;
      this.#playing = false;
      this.#shown = {picture: false, fine: false};
      const {done} = this.#opening;
      this.#opening = null;
      done(this.description);
      this.#tell('open', this.description);
      this.invalidate();
    } else if (opened < 0) {
      this.#streamer.stop();
      this.#fail(new KelpError(this.#takeProblem()));
    }
    this.#streamer.pull();
  }

  #fail(error) {
    const opening = this.#opening;
    this.#opening = null;
    if (opening) return opening.failed(error);
    this.#tell('problem', {message: error.message});
  }
  retry() {
    this.#streamer?.retry();
  }
  sizes() {
    const at = this.#module._kelp_sizes() >> 3;
    const [total, arrived, memory, gpu] = this.#module.HEAPF64.subarray(at, at + 4);
    return {total, arrived, memory, gpu, heap: this.#module.HEAPU8.length};
  }

  // --- pose, clips, camera -------------------------------------------------------------------------
  pose(changes) {
    if (changes === null) {
      this.#pose.clear();
      this.#module._kelp_reset_pose();
    }
    for (const change of [changes ?? []].flat()) {
      const {part = 0, knot, tangent, offset} = change;
      const key = `${part}:${knot}`, old = this.#pose.get(key) ?? {part, knot};
      if (tangent && !this.#module._kelp_tangent(part, knot, ...tangent) ||
          offset && !this.#module._kelp_offset(part, knot, ...offset))
        throw new KelpError(`there is no knot ${knot} of part ${part}, or its numbers are not finite`);
      this.#pose.set(key, {...old, ...(tangent && {tangent: [...tangent]}), ...(offset && {offset: [...offset]})});
    }
    this.invalidate();
    return [...this.#pose.values()];
  }
  setJoints(matrices) {
    (matrices ?? []).forEach(({length}, i) => {
      if (length !== 16) throw new KelpError(`the matrix of joint ${i} has 16 numbers, not ${length}`);
    });
    this.#lend([...matrices ?? []].flatMap((matrix) => [...matrix]),
               (at, count) => this.#module._kelp_joints(at, count / 16));
  }
  nodes(part = 0) {
    const at = this.#module._kelp_nodes(part) >> 3, [count, address] = this.#module.HEAPF64.subarray(at, at + 2);
    if (count < 0) throw new KelpError(`there is no part ${part}`);
    return this.#module.HEAPF32.slice(address >> 2, (address >> 2) + 3 * count);
  }
  setNodes(part, nodes) {
    const count = this.nodes(part).length;
    if (nodes && nodes.length !== count)
      throw new KelpError(`the nodes of part ${part} have ${count} numbers, not ${nodes.length}`);
    this.#lend(nodes ?? [], (at) => this.#module._kelp_set_nodes(part, at, (nodes ?? []).length / 3));
  }
  // Calls call(address, how many) for numbers in the module's memory; false: it says why.
  #lend(numbers, call) {
    const at = this.#module._malloc(4 * numbers.length + 4);
    if (!at) throw new KelpError('there is no memory for so many numbers');
    this.#module.HEAPF32.set(numbers, at >> 2);
    const taken = this.#guard(() => call(at, numbers.length), 0);
    if (!this.#ended) this.#module._free(at);
    if (!taken) throw new KelpError(this.#takeProblem());
    this.invalidate();
  }
  wind(acceleration) {
    this.#module._kelp_wind(...acceleration);
    this.invalidate();
  }
  play(clip, {time = 0, speed = 1} = {}) {
    const clips = this.description?.clips ?? [];
    const index = typeof clip === 'number' ? clip : clips.findIndex(({name}) => name === clip);
    if (clip !== null && clip !== undefined && !clips[index])
      throw new KelpError(`there is no clip '${clip}'; there are: ${clips.map((c) => c.name).join(', ') || 'none'}`);
    this.#clip = clips[index] ? index : -1;
    this.#time = time;
    this.#speed = speed;
    this.#playing = this.#clip >= 0 && speed !== 0;
    this.invalidate();
  }
  pause(paused = true) {
    this.#playing = !paused && this.#clip >= 0;
    this.invalidate();
  }
  get playing() {
    return this.#playing;
  }
  get clip() {
    return this.#clip < 0 ? null : this.description.clips[this.#clip].name;
  }
  get time() {
    return this.#time;
  }
  get camera() {
    return {...this.#camera, pan: [...this.#camera.pan]};
  }
  set camera(camera) {
    const all = {...this.#camera, ...camera};
    all.pitch = Math.min(Math.max(all.pitch, -89), 89);
    all.zoom = Math.min(Math.max(all.zoom, 0.2), 50);
    if (![all.yaw, all.pitch, all.zoom, ...all.pan].every(Number.isFinite)) return;
    this.#camera = all;
    this.#module._kelp_orbit(all.yaw, all.pitch, all.zoom, ...all.pan);
    this.#stirred = performance.now();
    this.invalidate();
    this.#tell('camera', this.camera);
  }
  // World to eye, and eye to clip: 16 numbers each, column by column. null: the camera again.
  matrices(toEye, toClip) {
    this.#module.HEAPF32.set([...toEye ?? [], ...toClip ?? []], this.#staging >> 2);
    this.#module._kelp_matrices(toEye ? this.#staging : 0);
    this.invalidate();
  }

  // --- pointer; x and y in CSS pixels of the canvas ------------------------------------------------
  #place(x, y) {
    return [2 * x / this.canvas.clientWidth - 1, 1 - 2 * y / this.canvas.clientHeight];
  }
  pick(x, y) {
    const at = this.#module._kelp_pick(...this.#place(x, y)) >> 3;
    const n = [...this.#module.HEAPF64.subarray(at, at + 16)];
    return n[0] === 0 ? null : {
      part: n[1], level: n[2], material: n[3],
      voxel: n.slice(4, 7), position: n.slice(7, 10), normal: n.slice(10, 13), rest: n.slice(13, 16),
    };
  }
  grab(x, y) {
    return this.#module._kelp_grab(...this.#place(x, y)) !== 0;
  }
  drag(x, y) {
    this.#module._kelp_drag(...this.#place(x, y));
    this.invalidate();
  }
  release() {
    this.#module._kelp_release();
    this.invalidate();
  }
  stroke(fromX, fromY, x, y, seconds) {
    this.#module._kelp_stroke(...this.#place(fromX, fromY), ...this.#place(x, y), seconds);
    this.invalidate();
  }

  // --- frames --------------------------------------------------------------------------------------
  invalidate() {
    if (this.#asked || this.#ended) return;
    this.#asked = requestAnimationFrame((now) => {
      this.#asked = 0;
      const moves = this.#last?.moves || this.#playing || now - this.#stirred < STIRS;
      if (this.#last?.moves) this.#keepPace(now - this.#last.at);
      const fewer = !this.#shown.picture ? FIRST : moves ? this.#scale : 0;
      const flags = this.#draw(this.#last ? Math.min((now - this.#last.at) / 1000, 0.5) : 1 / 60, SCALES[fewer]);
      const still = !(flags & MOVES) && !this.#playing && now - this.#stirred >= STIRS;
      this.#last = still && !(flags & CHANGED) ? null : {at: now, moves: !still};
      if (this.#last || this.#drawn < 1 && this.#shown.picture) this.invalidate();
    });
  }

  // Chooses the scale of what moves by what its frames take: more or fewer pixels after three that are too fast
  // or too slow.
  #keepPace(milliseconds) {
    const way = milliseconds > SLOW ? 1 : milliseconds < FAST ? -1 : 0;
    this.#pace = way === 0 || way * this.#pace < 0 ? way : this.#pace + way;
    if (Math.abs(this.#pace) < 3) return;
    this.#scale = Math.min(Math.max(this.#scale + way, 0), SCALES.length - 1);
    this.#pace = 0;
  }

  #draw(seconds, scale = 1) {
    if (this.#lost || this.#ended) return 0;
    this.#drawn = this.#fit(scale);
    if (this.#playing) this.#time += seconds * this.#speed;
    const flags = this.#guard(
        () => this.#module._kelp_frame(this.canvas.width, this.canvas.height, this.#clip, this.#time, seconds), 0);
    const problem = this.#takeProblem();
    if (problem) this.#tell('problem', {message: problem});
    if (flags & WAITS) this.#streamer?.pull();
    if (flags & DRAWN && !this.#shown.picture) {
      this.#shown.picture = true;
      this.#tell('picture', this.sizes());
    }
    if (flags & FINE && !this.#shown.fine) this.#tell('fine', this.sizes());
    this.#shown.fine = (flags & FINE) !== 0;
    ++this.#frame;
    return flags;
  }
  get frames() {
    return this.#frame;
  }
  get isFine() {
    return this.#shown.fine;
  }

  // The share of the pixels' width and height that is drawn: 1 if the host says how many there are.
  #fit(wanted) {
    const scale = this.#options.pixelRatio === null ? wanted : 1;
    const ratio = (this.#options.pixelRatio ?? Math.min(devicePixelRatio, 2)) * scale;
    const width = Math.max(Math.round(this.canvas.clientWidth * ratio), 1);
    const height = Math.max(Math.round(this.canvas.clientHeight * ratio), 1);
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    return scale;
  }

  // Draws now, and reads the picture: RGBA, from the bottom row up, premultiplied.
  pixels() {
    this.#draw(0);
    const {width, height} = this.canvas, bytes = new Uint8Array(4 * width * height);
    this.#gl.readPixels(0, 0, width, height, this.#gl.RGBA, this.#gl.UNSIGNED_BYTE, bytes);
    return {width, height, bytes};
  }
  picture() {
    this.#draw(0);
    return new Promise((done) => this.canvas.toBlob(done));
  }

  // --- what can go wrong ---------------------------------------------------------------------------
  // A module that ran out of memory stops at once; it must not be called again.
  #guard(call, otherwise) {
    try {
      return call();
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      this.#ended = true;
      this.#streamer?.stop();
      this.#fail(new KelpError('kelp ran out of memory in this page, and stopped; load the page again'));
      return otherwise;
    }
  }
  #takeProblem() {
    return this.#ended ? '' : this.#module.UTF8ToString(this.#module._kelp_problem());
  }
  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
  #onLost = (event) => {
    event.preventDefault();  // so that the browser gives it back
    this.#lost = true;
    this.#module._kelp_lose();
    this.#tell('problem', {message: 'The browser took the graphics card away from this page. The picture comes ' +
                                    'back as soon as the browser allows it.', lost: true});
  };
  #onRestored = () => {
    try {
      this.#start();
    } catch (error) {
      return this.#fail(error);
    }
    this.#lost = false;
    this.#tell('restored', null);
    this.invalidate();
  };

  close() {
    if (this.#ended) return;
    this.#ended = true;
    this.#streamer?.stop();
    cancelAnimationFrame(this.#asked);
    this.#resize.disconnect();
    this.canvas.removeEventListener('webglcontextlost', this.#onLost);
    this.canvas.removeEventListener('webglcontextrestored', this.#onRestored);
    if (!this.#lost) this.#module._kelp_end();
  }
}

function asBlob(source) {
  if (source instanceof Blob) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return new Blob([source]);
  throw new KelpError('load takes an address, a File, a Blob or bytes');
}

async function startsWith(blob, text) {
  return await blob.slice(0, text.length).text() === text;
}
