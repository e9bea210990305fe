// SPDX-License-Identifier: MIT
// kelp in a page: voxel models that bend, on WebGL 2. Errors are KelpErrors with a sentence for the visitor.

export class KelpError extends Error {}

export type Vector = [number, number, number];
/** A model to show: an address, which streams by HTTP ranges, or bytes. A `.vox` file is baked first. */
export type Source = string | URL | Blob | ArrayBuffer | ArrayBufferView;

export interface Options {
  /** Memory of the graphics card for voxels, allocated at once; at least 256 KiB. Default: 64 MiB. */
  gpuBytes?: number;
  /**
   * Pixels of the canvas for each CSS pixel. Default: the screen's, at most 2, and fewer for the first picture and
   * while something moves and frames are slow.
   */
  pixelRatio?: number;
}

export interface Knot {
  /** Place along the part's axis, 0 to 1. */
  at: number;
  /** In heights of the part. */
  position: Vector;
  /** dS/d(at), in heights of the part. */
  tangent: Vector;
}
export interface Part {
  name: string;
  kind: 'solid' | 'fog' | 'empty';
  /** cage: with the nodes of a lattice, which follow the spline. */
  bend: 'shear' | 'sweep' | 'cage';
  levels: number;
  /** Voxels of the finest level. */
  size: Vector;
  /** At rest. */
  knots: Knot[];
}
export interface Description {
  /** Of the pack. */
  bytes: number;
  /** The model at rest, in meters. */
  min: Vector;
  max: Vector;
  /** True if the pack holds distances. */
  distances: boolean;
  parts: Part[];
  clips: {name: string; duration: number}[];
  joints: Joint[];
}

/** Of the skin that a pack was made of; parents come first. */
export interface Joint {
  name: string;
  /** Number of an earlier joint; null: none. */
  parent: number | null;
  /** Meters at rest -> joint space: 16 numbers, column by column. */
  inverseBind: number[];
}

/** A knot that was moved. Lengths are in heights of the part, y along its axis. */
export interface KnotPose {
  /** Default: 0. */
  part?: number;
  knot: number;
  /** Replaces the tangent. */
  tangent?: Vector;
  /** Moves the knot, on top of the clip; automatic tangents follow. */
  offset?: Vector;
}
/** Looks at the middle of the model. */
export interface Camera {
  /** Degrees to the right of the model's front. Default: 30. */
  yaw: number;
  /** Degrees from which the camera looks down, -89 to 89. Default: 15. */
  pitch: number;
  /** 1: all of the model at rest is seen. 0.2 to 50. */
  zoom: number;
  /** Moves the picture right and up, in heights of the canvas. */
  pan: [number, number];
}
export interface Hit {
  part: number;
  /** 0 is the finest. */
  level: number;
  /** Index in the palette. */
  material: number;
  /** In voxels of `level`. */
  voxel: Vector;
  /** World, meters. */
  position: Vector;
  normal: Vector;
  /** The same point of the undeformed model, meters. */
  rest: Vector;
}
export interface Sizes {
  /** Bytes of the pack, and how many of them are here. */
  total: number;
  arrived: number;
  /** Bytes of decoded voxels in memory, and of voxels on the GPU. */
  memory: number;
  gpu: number;
  /** Bytes of the module's memory: 16 MiB to 768 MiB. */
  heap: number;
}

interface Events {
  /** Bytes came; or, with stage 'bake', a `.vox` file is being baked. */
  progress: CustomEvent<{stage: 'load' | 'bake'; arrived: number; total: number}>;
  open: CustomEvent<Description>;
  /** The first picture of a pack. */
  picture: CustomEvent<Sizes>;
  /** The picture is as fine as it gets. */
  fine: CustomEvent<Sizes>;
  /** An error after load(), in words. `lost`: the graphics context; it comes back by itself. */
  problem: CustomEvent<{message: string; lost?: boolean}>;
  restored: CustomEvent<null>;
  camera: CustomEvent<Camera>;
}

/** One canvas with one model. Frames are drawn when something changes. */
export interface View extends EventTarget {
  readonly canvas: HTMLCanvasElement;
  /** Of the pack that is shown. */
  readonly description: Description | null;
  /** The pack that a `.vox` file was baked to, to save it. */
  readonly bytes: Uint8Array | null;

  /** Shows a pack in place of the one before. Resolves when it is open; then pictures come, coarse to fine. */
  load(source: Source): Promise<Description>;
  /** Goes on after a download that broke off. */
  retry(): void;
  sizes(): Sizes;

  /**
   * Moves the joints of the pack's skin as your own animation says, one matrix for each of `description.joints`:
   * 16 numbers, column by column, meters at rest -> meters now. If M takes joint space to meters, that is
   * M * inverseBind. It is affine; it may scale, shear, mirror and flatten. Clips no longer move the joints, until
   * null or pose(null).
   */
  setJoints(matrices: ArrayLike<number>[] | null): void;
  /**
   * Where the nodes of a part's finest cage were in the last frame, a copy: three numbers each, voxels in part
   * space. None without a cage. Part: default 0.
   */
  nodes(part?: number): Float32Array;
  /** Puts them where you say; nothing else moves them, until null or pose(null). */
  setNodes(part: number, nodes: ArrayLike<number> | null): void;
  /** Moves knots; null: back to rest, joints and nodes too. Returns what is moved. */
  pose(changes?: KnotPose | KnotPose[] | null): KnotPose[];
  /** Plays a clip by name or number; null: none. speed 0 shows one moment. */
  play(clip: string | number | null, options?: {time?: number; speed?: number}): void;
  pause(paused?: boolean): void;
  readonly playing: boolean;
  readonly clip: string | null;
  readonly time: number;
  /** An acceleration in the world, m/s², from now on: it leans the model. [0, 0, 0]: it swings back. */
  wind(acceleration: Vector): void;
  get camera(): Camera;
  set camera(camera: Partial<Camera>);
  /** A camera of the host's: world to eye, eye to clip, 16 numbers each, column by column. null: `camera`. */
  matrices(toEye: ArrayLike<number> | null, toClip?: ArrayLike<number>): void;

  /** The voxel that is seen there. x and y, here and below: CSS pixels from the canvas's top left corner. */
  pick(x: number, y: number): Hit | null;
  /** Takes hold of the model, then drags and lets go. false: there is nothing. */
  grab(x: number, y: number): boolean;
  drag(x: number, y: number): void;
  release(): void;
  /** Brushes over the model, in so many seconds. */
  stroke(fromX: number, fromY: number, x: number, y: number, seconds: number): void;

  /** Asks for a frame. */
  invalidate(): void;
  readonly frames: number;
  readonly isFine: boolean;
  /** Draws now and reads the picture: RGBA, from the bottom row up, premultiplied. */
  pixels(): {width: number; height: number; bytes: Uint8Array};
  /** Draws now: the picture as PNG. */
  picture(): Promise<Blob>;
  /** Frees everything. The canvas can be used again by create(). */
  close(): void;

  addEventListener<K extends keyof Events>(type: K, listener: (event: Events[K]) => void,
                                           options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject,
                   options?: boolean | AddEventListenerOptions): void;
}

/** Throws a KelpError where there is no WebGL 2. */
export function create(canvas: HTMLCanvasElement, options?: Options): Promise<View>;
