// SPDX-License-Identifier: MIT
// Brings the bytes of a pack into the module: HTTP ranges, or slices of a file. The module says which ranges it
// wants, the most urgent first; a few requests are on their way at a time.

const FIRST_BYTES = 65536;  // hold a first picture of any pack that kelp-bake writes
const IN_FLIGHT = 3;
const TRIES = 3;
const LARGEST_WHOLE = 64 << 20;  // of a server without ranges; what the module keeps

export class KelpError extends Error {
  name = 'KelpError';
}

const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

// A file, or bytes that are here.
export class BlobSource {
  ranges = true;
  constructor(blob) {
    this.blob = blob;
    this.size = blob.size;
    this.name = blob.name ?? 'the file';
  }
  async open() {}
  async read(offset, length, signal, feed) {
    feed(offset, new Uint8Array(await this.blob.slice(offset, offset + length).arrayBuffer()));
  }
}

// A file of a server. With ranges if the server has them; else all of it is downloaded.
export class UrlSource {
  constructor(url) {
    this.url = url;
    this.name = String(url).split(/[?#]/)[0].split('/').pop() || String(url);
  }

  // Asks for the first bytes. Then `size` and `ranges` are known, and `first` is the answer.
  async open(signal) {
    this.first = await this.#fetch({Range: `bytes=0-${FIRST_BYTES - 1}`}, signal);
    this.size = sizeIn(this.first);
    this.ranges = this.first.status === 206 && this.size !== null;
    if (this.ranges) return;
    if (this.first.status === 206) {  // another origin, which does not show Content-Range
      await this.first.body?.cancel();
      this.first = await this.#fetch({}, signal);
    }
    const encoded = this.first.headers.has('Content-Encoding');
    const length = this.first.headers.get('Content-Length');
    this.size = length === null || encoded ? null : Number(length);
    if (this.size > LARGEST_WHOLE)
      throw new KelpError(`${this.name} has ${megabytes(this.size)}, and its server does not serve ranges of ` +
                          `files; it would have to be at most ${megabytes(LARGEST_WHOLE)}`);
    if (this.size !== null) return;
    const bytes = await wholeOf(this.first, this.name);  // only its end says how large it is
    this.size = bytes.length;
    this.first = new Response(bytes);
  }

  // The body of the first answer, from its begin.
  async readFirst(feed) {
    await feedBody(this.first, 0, feed);
  }

  async read(offset, length, signal, feed) {
    const answer = await this.#fetch({Range: `bytes=${offset}-${offset + length - 1}`}, signal);
    if (answer.status !== 206 || sizeIn(answer) !== this.size)
      throw new KelpError(`${this.name} changed on its server while it was loaded; load it again`);
    const got = await feedBody(answer, offset, feed);
    if (got < length) throw new KelpError('the connection broke off');
  }

  async #fetch(headers, signal) {
    let answer;
    try {
      answer = await fetch(this.url, {headers, signal});
    } catch (error) {
      if (signal?.aborted) throw error;
      throw new KelpError(`${this.name} cannot be downloaded: no connection to its server, or the server does ` +
                          'not allow this page to read it');
    }
    if (!answer.ok) {
      const error = new KelpError(`${this.name} cannot be downloaded: the server answers ${answer.status} ` +
                                  answer.statusText);
      error.final = answer.status < 500;
      throw error;
    }
    return answer;
  }
}

function sizeIn(answer) {
  const size = /\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '');
  return size ? Number(size[1]) : null;
}

async function feedBody(answer, offset, feed) {
  let got = 0;
  for (const reader = answer.body.getReader();;) {
    const {done, value} = await reader.read();
    if (done) return got;
    feed(offset + got, value);
    got += value.length;
  }
}

async function wholeOf(answer, name) {
  const parts = [];
  let size = 0;
  await feedBody(answer, 0, (offset, bytes) => {
    size += bytes.length;
    if (size > LARGEST_WHOLE)
      throw new KelpError(`${name} has more than ${megabytes(LARGEST_WHOLE)}, and its server does not serve ` +
                          'ranges of files');
    parts.push(bytes);
  });
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

// Runs until it is stopped: fetches what the module wants. `fed` is called when bytes came, `failed` with what
// went wrong. After a failure nothing is fetched until retry().
export class Streamer {
  #stop = new AbortController();
  #running = 0;
  #failed = false;
  #rate = 0;  // bytes a second

  constructor(heap, source, {fed, failed}) {
    Object.assign(this, {heap, source, fed, failed});
  }

  stop() {
    this.#stop.abort();
  }
  get stopped() {
    return this.#stop.signal.aborted;
  }

  // Size and first bytes. Throws KelpError. What follows the first bytes goes on by itself.
  async open() {
    await this.source.open(this.#stop.signal);
  }
  start() {
    if (!this.source.first) return this.pull();
    const first = {offset: 0, length: this.source.ranges ? FIRST_BYTES : this.source.size, first: true};
    this.heap.expect(first);
    this.#run(first);
  }
  retry() {
    this.#failed = false;
    if (!this.source.ranges) return this.failed(new KelpError('load the file again'));
    this.pull();
  }

  // Fetches what is wanted now.
  pull() {
    if (!this.source.ranges) return;
    while (this.#running < IN_FLIGHT && !this.#failed && !this.stopped) {
      // A request takes about a quarter of a second: its begin comes soon, and few are needed.
      const most = Math.min(Math.max(this.#rate / 4, 32768), 1 << 20);
      const range = this.heap.take(most);
      if (!range) return;
      this.#run(range);
    }
  }

  async #run(range) {
    ++this.#running;
    let at = range.offset;
    const end = range.offset + range.length, began = performance.now();
    const feed = (offset, bytes) => {
      if (this.stopped) return;
      this.heap.feed(offset, bytes);
      at = offset + bytes.length;
      this.fed();
    };
    for (let tries = 1; !this.stopped; ++tries) {
      try {
        if (range.first && tries === 1) {
          await this.source.readFirst(feed);
          if (at < Math.min(end, this.source.size)) throw new KelpError('the connection broke off');
        } else {
          if (!this.source.ranges) throw new KelpError('the connection broke off');
          await this.source.read(at, Math.min(end, this.source.size) - at, this.#stop.signal, feed);
        }
        break;
      } catch (error) {
        if (this.stopped) break;
        if (tries < TRIES && !error.final && this.source.ranges) {
          await new Promise((done) => setTimeout(done, 250 * tries * tries));
          continue;
        }
        this.#failed = true;
        const message = error instanceof KelpError ? error.message : 'the connection broke off';
        this.failed(new KelpError(`The download stopped at ${megabytes(this.heap.arrived())} of ` +
                                  `${megabytes(this.source.size)}: ${message}`));
        break;
      }
    }
    if (!range.first || this.source.ranges) {
      const rate = 1000 * (at - range.offset) / Math.max(performance.now() - began, 1) * this.#running;
      this.#rate = this.#rate === 0 ? rate : 0.7 * this.#rate + 0.3 * rate;
    }
    --this.#running;
    if (this.stopped) return;
    this.heap.giveUp(range);
    this.fed();
    this.pull();
  }
}
