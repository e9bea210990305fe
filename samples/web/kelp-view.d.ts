// SPDX-License-Identifier: MIT
import type {Description, Source, View} from './kelp.js';

/**
 * `<kelp-view src="plant.kelp" clip="sway">`. Says in words what goes wrong. Passes on the events of View:
 * progress, open, picture, fine, problem, restored, camera. Style its words by `::part(words)`.
 */
export class KelpView extends HTMLElement {
  /** Rejects where there is no WebGL 2. */
  readonly ready: Promise<View>;
  /** Undefined until it is ready. */
  readonly view?: View;
  load(source: Source): Promise<Description>;
  /** Shows words below the picture; '' takes them away. */
  say(words: string | Error | {message: string}, problem?: boolean): void;
}

declare global {
  interface HTMLElementTagNameMap {
    'kelp-view': KelpView;
  }
}
