// A 3D Tiles archive (.3tz), a ZIP of stored files, read part by part: its list of files first, then files as they are asked
// for. A server that gives no parts of files sends all of it, which then is held.
import {ask} from './files.js';
import {crc32} from './lpm.js';
import {Problem} from './problem.js';

const TAIL = 65536;       // of the end of the archive, which has the list of most of them
const WIDE = 0xffffffff;  // see the ZIP64 field
const HEADER = 30;        // of a file, before its name

const viewOf = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

export class Archive {
  static async open(url) {
    const archive = new Archive(url), tail = await archive.fetch(`bytes=-${TAIL}`);
    try {
      await archive.list(tail);
    } catch (error) {
      throw error instanceof RangeError ? archive.damaged('its list of files cannot be read') : error;
    }
    return archive;
  }

  constructor(url) { Object.assign(this, {url, size: 0, whole: null, files: new Map()}); }

  damaged(what) { return new Problem(`${this.url}: ${what}; the archive is damaged`); }

  async fetch(range, signal) {
    const answer = await ask(this.url, signal, {range}), bytes = new Uint8Array(await answer.arrayBuffer());
    if (answer.status === 206) this.size = Number(answer.headers.get('content-range')?.split('/')[1]);
    else Object.assign(this, {whole: bytes, size: bytes.length});
    if (!(this.size >= 0)) throw new Problem(`${this.url}: the server does not let pages see Content-Range; name it in Access-Control-Expose-Headers`);
    return bytes;
  }

  // Fewer bytes at the end of the archive.
  async part(from, to, signal) {
    if (this.whole === null) {
      const bytes = await this.fetch(`bytes=${from}-${to - 1}`, signal);
      if (this.whole === null) return bytes;
    }
    return this.whole.subarray(from, to);
  }

  async list(tail) {
    const at = this.size - tail.length, view = viewOf(tail);
    let end = tail.length - 22;
    while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) --end;
    if (end < 0) throw this.damaged('it has no list of files');
    let [bytes, from] = [view.getUint32(end + 12, true), view.getUint32(end + 16, true)];
    if (end >= 20 && view.getUint32(end - 20, true) === 0x07064b50) {
      const last = Number(view.getBigUint64(end - 12, true)) - at;
      [bytes, from] = [40, 48].map((k) => Number(view.getBigUint64(last + k, true)));
    }
    if (!(from + bytes <= this.size)) throw this.damaged('its list of files lies beyond its end');
    this.read(from >= at ? tail.subarray(from - at, from - at + bytes) : await this.part(from, from + bytes));
  }

  read(list) {
    const view = viewOf(list), text = new TextDecoder();
    for (let at = 0; at < list.length;) {
      if (view.getUint32(at, true) !== 0x02014b50) throw this.damaged('its list of files cannot be read');
      const [name, extra, comment] = [28, 30, 32].map((k) => view.getUint16(at + k, true)), path = text.decode(list.subarray(at + 46, at + 46 + name));
      const file = {stored: view.getUint16(at + 10, true) === 0, crc: view.getUint32(at + 16, true), size: view.getUint32(at + 24, true),
                    offset: view.getUint32(at + 42, true)};
      if (file.offset === WIDE) file.offset = Number(view.getBigUint64(at + 46 + name + 4, true));
      this.files.set(path, {...file, name});
      at += 46 + name + extra + comment;
    }
  }

  // A file by its address: that of the archive as if it were a folder.
  async get(address, signal) {
    const path = decodeURIComponent(address.slice(this.url.length + 1)), file = this.files.get(path), fail = (what) => { throw this.damaged(`${path}: ${what}`); };
    if (!file) fail('is not in the archive');
    if (!file.stored) throw new Problem(`${this.url}: ${path} is compressed; pack it without compression`);
    const begin = file.offset + HEADER + file.name, bytes = await this.part(file.offset, begin + file.size, signal);
    // Most writers have nothing between name and content.
    if (bytes.length < HEADER || viewOf(bytes).getUint32(0, true) !== 0x04034b50) fail('is not where the list says');
    const extra = viewOf(bytes).getUint16(28, true);
    const content = extra === 0 ? bytes.subarray(HEADER + file.name) : await this.part(begin + extra, begin + extra + file.size, signal);
    if (content.length !== file.size) fail('lies beyond the end');
    if (crc32(content) !== file.crc) fail('the checksum is wrong');
    return content;
  }
}
