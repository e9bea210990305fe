// SPDX-License-Identifier: MIT
import createModule from './kelp_baker.js';

onmessage = async ({data: {name, bytes}}) => {
  const module = await createModule();
  const path = '/' + name.replace(/[^\w.-]/g, '_').replace(/(\.vox)?$/i, '.vox');
  module.FS.writeFile(path, new Uint8Array(bytes));
  const baked = module.ccall('kelp_bake', 'number', ['string'], [path]);
  const words = module.UTF8ToString(module._kelp_baked_words(baked));
  const size = module._kelp_baked_size(baked), at = module._kelp_baked_bytes(baked);
  if (size === 0) return postMessage({words: words.replaceAll(path, name)});
  const pack = module.HEAPU8.slice(at, at + size);
  postMessage({bytes: pack, words}, [pack.buffer]);
};
