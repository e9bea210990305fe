// SPDX-License-Identifier: MIT
// Bakes a MagicaVoxel file in a worker, which is ended afterwards. Loaded when a file is dropped.
import {KelpError} from './stream.js';

const LARGEST = 64 << 20;
const SECONDS = 120;

// The bytes of a pack. Throws KelpError.
export async function bakeVox(blob) {
  if (blob.size > LARGEST)
    throw new KelpError(`The file has ${Math.round(blob.size / 1e6)} MB; a page bakes at most ` +
                        `${LARGEST >> 20} MB. kelp-bake takes more.`);
  const bytes = await blob.arrayBuffer();
  const worker = new Worker(new URL('./bake_worker.js', import.meta.url), {type: 'module'});
  let timer;
  try {
    const answer = await new Promise((done, failed) => {
      timer = setTimeout(() => failed(new KelpError('The file takes too long to bake in a page; use kelp-bake.')),
                         SECONDS * 1000);
      worker.onmessage = ({data}) => done(data);
      worker.onerror = () => failed(new KelpError('The baker did not start, or ran out of memory.'));
      worker.postMessage({name: blob.name ?? 'model.vox', bytes}, [bytes]);
    });
    if (!answer.bytes) throw new KelpError(answer.words);
    return answer.bytes;
  } finally {
    clearTimeout(timer);
    worker.terminate();
  }
}
