// SPDX-License-Identifier: MIT
// <kelp-view src="plant.kelp" clip="sway"></kelp-view>: a pack in any page. It streams, plays, and bends under
// the pointer; what goes wrong is said in words below the picture.
import {control} from './controls.js';
import {create, KelpError} from './kelp.js';

const STYLE = `
  :host { display: block; position: relative; min-height: 8rem; overflow: hidden; contain: content; }
  :host([hidden]) { display: none; }
  canvas { display: block; width: 100%; height: 100%; touch-action: none; outline-offset: -3px; }
  p { position: absolute; inset: auto 0 0 0; margin: 0; padding: 0.5rem 0.75rem; font: 0.9rem/1.4 system-ui, sans-serif;
      color: canvastext; background: color-mix(in srgb, canvas 85%, transparent); }
  p:empty { display: none; }
  p.problem { border-top: 3px solid #c62828; }
  progress { position: absolute; inset: 0 0 auto 0; width: 100%; height: 4px; border: 0; appearance: none;
             background: transparent; accent-color: #2e9e5b; }
  progress::-moz-progress-bar { background: #2e9e5b; }
  progress[hidden] { display: none; }
`;

// Where there are no elements (a page that is rendered on a server) it can be imported, and does nothing.
export class KelpView extends (globalThis.HTMLElement ?? Object) {
  static observedAttributes = ['src', 'clip'];
  #words; #progress; #canvas; #ready = null; #problem = '';

  constructor() {
    super();
    const root = this.attachShadow({mode: 'open'});
    root.innerHTML = `<style>${STYLE}</style><canvas tabindex="0" role="img"></canvas>
      <progress max="1" hidden aria-label="download"></progress><p role="status" part="words"></p>`;
    this.#canvas = root.querySelector('canvas');
    this.#words = root.querySelector('p');
    this.#progress = root.querySelector('progress');
    this.#canvas.ariaLabel = this.ariaLabel ?? 'a model that bends; arrow keys turn it, space plays';
  }

  connectedCallback() {
    this.ready.catch(() => {});
  }
  disconnectedCallback() {
    const closing = this.#ready;
    queueMicrotask(() => {
      if (this.isConnected) return;  // it only moved in the page
      this.#ready = null;
      closing?.then((view) => view.close(), () => {});
    });
  }

  // The View of kelp.js. It rejects where there is no WebGL 2.
  get ready() {
    return this.#ready ??= this.#begin();
  }

  async #begin() {
    let view;
    try {
      view = await create(this.#canvas);
    } catch (error) {
      this.say(error, true);
      throw error;
    }
    control(view);
    for (const type of ['progress', 'open', 'picture', 'fine', 'problem', 'restored', 'camera'])
      view.addEventListener(type, ({detail}) => this.dispatchEvent(new CustomEvent(type, {detail})));
    view.addEventListener('problem', ({detail}) => this.say(detail, true));
    for (const type of ['open', 'restored'])  // an earlier error is over
      view.addEventListener(type, () => this.say(''));
    view.addEventListener('progress', ({detail}) => this.#showProgress(detail));
    view.addEventListener('fine', () => { this.#progress.hidden = true; });
    this.view = view;
    if (this.hasAttribute('src')) this.load(this.getAttribute('src')).catch(() => {});
    return view;
  }

  attributeChangedCallback(name, before, now) {
    if (!this.view || before === now) return;
    if (name === 'src' && now !== null) this.load(now).catch(() => {});
    if (name === 'clip') this.#play();
  }

  // An address, a File, a Blob or bytes. What goes wrong is shown, and thrown.
  async load(source) {
    const view = this.view ?? await this.ready;
    this.say('');
    try {
      const description = await view.load(source);
      this.#play();
      return description;
    } catch (error) {
      this.#progress.hidden = true;
      this.say(error, true);
      throw error;
    }
  }

  #play() {
    const clip = this.getAttribute('clip');
    try {
      this.view.play(clip || null);
    } catch (error) {
      this.say(error, true);
    }
  }

  #showProgress({stage, arrived, total}) {
    this.#progress.hidden = false;
    if (stage === 'bake') {
      this.#progress.removeAttribute('value');
      this.say('Baking the file into a pack …');
    } else {
      this.#progress.value = total > 0 ? arrived / total : 0;
      if (!this.#problem) this.say('');
    }
  }

  // Words below the picture; '' takes them away.
  say(what, problem = false) {
    const text = typeof what === 'string' ? what
        : what instanceof KelpError || !(what instanceof Error) ? what.message
        : `Something went wrong in the page: ${what.message}`;
    this.#problem = problem ? text : '';
    this.#words.textContent = text;
    this.#words.classList.toggle('problem', problem);
  }
}

globalThis.customElements?.define('kelp-view', KelpView);
