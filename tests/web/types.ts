// SPDX-License-Identifier: MIT
// Uses kelp-view as README.md of samples/web does; tests/web/package.py has TypeScript check it against
// kelp.d.ts and kelp-view.d.ts.
import {create, KelpError, type Camera, type Hit, type View} from 'kelp-view';
import 'kelp-view/kelp-view.js';

async function show(canvas: HTMLCanvasElement): Promise<View> {
  const view = await create(canvas, {pixelRatio: 1, gpuBytes: 1 << 24});
  const {parts, clips} = await view.load('plant.kelp');
  const names: string[] = [...parts, ...clips].map(({name}) => name);
  await view.load(new Blob([names.join()]));
  await view.load(new Uint8Array(4));
  await view.load(new URL('plant.kelp', 'https://example.org'));
  view.play('sway', {speed: 0.5});
  view.play(null);
  view.pose({knot: 3, tangent: [0.8, 0.6, 0]});
  view.pose([{part: 1, knot: 3, offset: [0, 0.1, 0]}]);
  view.pose(null);
  view.setJoints(view.description!.joints.map(({inverseBind}) => inverseBind));
  view.setNodes(0, view.nodes().map((place) => 2 * place));
  view.camera = {yaw: 75};
  const camera: Camera = view.camera;
  const hit: Hit | null = view.pick(120, 80);
  if (hit) console.log(hit.part, hit.voxel[0] + hit.material, hit.position, camera.pan[1]);
  view.addEventListener('problem', ({detail}) => console.log(detail.message, detail.lost));
  view.addEventListener('picture', ({detail}) => console.log(detail.arrived / detail.total));
  return view;
}

const element = document.querySelector('kelp-view')!;
element.ready.then((view) => view.pause());
element.load('plant.kelp').catch((error: unknown) => {
  element.say(error instanceof KelpError ? error.message : String(error), true);
});
void show(document.createElement('canvas'));

export async function mistakes(view: View) {
  // @ts-expect-error: nothing to load
  await view.load(7);
  // @ts-expect-error: a knot has a number
  view.pose({tangent: [0, 1, 0]});
  // @ts-expect-error: three numbers
  view.pose({knot: 1, tangent: [0, 1]});
  // @ts-expect-error: a list of matrices
  view.setJoints([1, 0, 0, 0]);
  // @ts-expect-error: it is only read
  view.frames = 0;
  // @ts-expect-error: there is no such thing
  view.dance();
}
