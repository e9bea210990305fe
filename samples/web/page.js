// SPDX-License-Identifier: MIT
// The page around <kelp-view>: files, clips, sliders, and a link that keeps file, pose and camera.
import './kelp-view.js';

const $ = (id) => document.getElementById(id);
const element = $('view'), axes = ['x', 'y', 'z'];
// source: the address of the pack, or null for a file of the visitor's; name: of either.
let view = null, source = null, name = '';

const megabytes = (bytes) => bytes < 1e5 ? `${Math.ceil(bytes / 1000)} KB` : `${(bytes / 1e6).toFixed(1)} MB`;
const say = (text) => { $('facts').textContent = text; };
const option = (text, value) => new Option(text, value);

// --- the link: #src=…&clip=…&time=…&yaw=…&pitch=…&zoom=…&pan=x,y&t=part:knot:x,y,z;… ----------------------
function linkOf() {
  const link = new URLSearchParams(), {yaw, pitch, zoom, pan} = view.camera;
  const round = (number) => String(Math.round(number * 1000) / 1000);
  if (source) link.set('src', source);
  if (view.clip) link.set('clip', view.clip);
  if (view.clip && !view.playing) link.set('time', round(view.time));
  for (const [key, value] of Object.entries({yaw, pitch, zoom})) link.set(key, round(value));
  link.set('pan', pan.map(round).join(','));
  const moved = view.pose().filter(({tangent}) => tangent);
  if (moved.length > 0)
    link.set('t', moved.map(({part, knot, tangent}) => `${part}:${knot}:${tangent.map(round).join(',')}`).join(';'));
  return `#${link}`;
}
let waiting = 0;
function keepLink() {
  clearTimeout(waiting);
  waiting = setTimeout(() => view?.description && history.replaceState(null, '', linkOf()), 200);
}

// Reads a link. Text in place of a number is left out: anybody can write a link.
function applyLink(link) {
  const number = (key) => link.has(key) && Number.isFinite(Number(link.get(key))) ? Number(link.get(key)) : null;
  const camera = {};
  for (const key of ['yaw', 'pitch', 'zoom']) if (number(key) !== null) camera[key] = number(key);
  const pan = (link.get('pan') ?? '').split(',').map(Number);
  if (pan.length === 2) camera.pan = pan;
  view.camera = camera;
  for (const word of (link.get('t') ?? '').split(';').filter(Boolean)) {
    const [part, knot, tangent] = word.split(':');
    try {
      view.pose({part: Number(part), knot: Number(knot), tangent: tangent.split(',').map(Number)});
    } catch {
      continue;
    }
  }
}

// --- the panel -----------------------------------------------------------------------------------
function showPack(description) {
  $('clip').replaceChildren(option('none', ''), ...description.clips.map((clip) => option(clip.name, clip.name)));
  $('part').replaceChildren(...description.parts.map((part, i) => option(part.name || `part ${i}`, i)));
  $('part_row').hidden = description.parts.length < 2;
  showKnots();
  const voxels = Math.max(...description.parts.flatMap(({size}) => size));
  say(`${megabytes(description.bytes)}, ${voxels} voxels along its longest side, ` +
      `${description.parts.length === 1 ? 'one part' : `${description.parts.length} parts`}`);
}
function showKnots() {
  const {knots} = view.description.parts[Number($('part').value) || 0];
  $('knot').replaceChildren(...knots.map(({at}, i) => option(`${i}, at ${at.toFixed(2)}`, i)));
  $('knot').value = String(knots.length - 1);
  showTangent();
}
function tangentNow() {
  const part = Number($('part').value) || 0, knot = Number($('knot').value) || 0;
  const moved = view.pose().find((k) => k.part === part && k.knot === knot);
  return {part, knot, tangent: moved?.tangent ?? view.description.parts[part].knots[knot]?.tangent ?? [0, 1, 0]};
}
function showTangent() {
  const {tangent} = tangentNow();
  axes.forEach((axis, i) => {
    $(axis).value = tangent[i];
    $(`${axis}_value`).value = tangent[i].toFixed(2);
  });
}
function slide() {
  const {part, knot} = tangentNow();
  view.pose({part, knot, tangent: axes.map((axis) => Number($(axis).value))});
  showTangent();
  keepLink();
}

// --- files ---------------------------------------------------------------------------------------
async function open(what, address = null) {
  $('retry').hidden = true;
  say('');
  source = address;
  name = (address ?? what.name).split('/').pop().replace(/[?#].*/, '').replace(/\.(kelp|vox)$/i, '');
  try {
    const description = await element.load(what);
    showPack(description);
    return true;
  } catch {
    return false;  // the element has said why
  }
}
async function openFile(file) {
  if (!file) return;
  element.removeAttribute('clip');
  $('model').value = '';
  if (await open(file)) {
    const clip = view.description.clips[0]?.name;
    if (clip) play(clip);
    keepLink();
  }
}
function play(clip, time) {
  $('clip').value = clip;
  view.play(clip || null, {time});
}
async function save() {
  let bytes = view.bytes;
  if (!bytes && source) {
    const answer = await fetch(source).catch(() => null);
    if (!answer?.ok) return say('The pack could not be downloaded.');
    bytes = await answer.arrayBuffer();
  }
  if (!bytes) return say('This pack is your own file already.');
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = `${name || 'model'}.kelp`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  say(`Saved ${link.download}, ${megabytes(bytes.byteLength)}.`);
}

function listen() {
  $('model').onchange = async () => {
    if ($('model').value && await open($('model').value, $('model').value)) startClip();
    keepLink();
  };
  $('file').onchange = () => openFile($('file').files[0]);
  $('clip').onchange = () => { play($('clip').value); keepLink(); };
  $('part').onchange = showKnots;
  $('knot').onchange = showTangent;
  for (const axis of axes) $(axis).oninput = slide;
  $('breeze').onclick = () => element.shadowRoot.querySelector('canvas').dispatchEvent(
      new KeyboardEvent('keydown', {key: 'b'}));
  $('reset').onclick = () => { view.pose(null); showTangent(); keepLink(); };
  $('retry').onclick = () => { $('retry').hidden = true; element.say(''); view.retry(); };
  $('save').onclick = save;
  $('link').onclick = async () => {
    history.replaceState(null, '', linkOf());
    const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    say((copied ? 'The link is copied.' : 'The link is in the address bar.') +
        (source ? '' : ' It keeps pose and camera; the file itself stays on your machine.'));
  };
  element.addEventListener('camera', keepLink);
  element.addEventListener('problem', ({detail}) => { $('retry').hidden = Boolean(detail.lost) || !source; });
  const over = (event) => { event.preventDefault(); element.classList.add('target'); };
  addEventListener('dragover', over);
  addEventListener('dragleave', () => element.classList.remove('target'));
  addEventListener('drop', (event) => {
    event.preventDefault();
    element.classList.remove('target');
    openFile(event.dataTransfer.files[0]);
  });
}

function startClip() {
  const clip = view.description.clips[0]?.name;
  if (clip && !matchMedia('(prefers-reduced-motion: reduce)').matches) play(clip);
}

async function main() {
  const link = new URLSearchParams(location.hash.slice(1));
  try {
    view = await element.ready;
  } catch {
    $('panel').inert = true;  // the element has said why
    return;
  }
  performance.mark('ready');
  for (const type of ['picture', 'fine']) element.addEventListener(type, () => performance.mark(type));
  listen();
  const address = link.get('src') ?? $('model').options[0].value;
  $('model').value = [...$('model').options].some((o) => o.value === address) ? address : '';
  if (!await open(address, address)) return;
  if (!link.has('clip')) startClip();
  else if (view.description.clips.some((clip) => clip.name === link.get('clip'))) {
    play(link.get('clip'), Number(link.get('time')) || 0);
    if (link.has('time')) view.pause();
  }
  applyLink(link);
  showTangent();
}
main();
