// Files that the page accepts, and one clear line about files that it cannot read.
import {GlbDecoder} from './glb.js';
import {LpmDecoder} from './lpm.js';
import {Problem} from './problem.js';

export async function ask(url, signal, headers = {}) {
  let answer;
  try {
    answer = await fetch(url, {signal, headers});
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    // Browsers let a page from the disk read no other file.
    if (globalThis.location?.protocol === 'file:')
      throw new Problem('This page needs a web server: run `python3 -m http.server` in its folder and open http://localhost:8000, or drop files here');
    throw new Problem(`${url}: cannot be reached`);
  }
  if (!answer.ok) throw new Problem(`${url}: cannot be loaded (${answer.status} ${answer.statusText})`);
  return answer;
}

// Errors inside a reader are errors of the file.
export async function reading(name, work) {
  try {
    return await work();
  } catch (error) {
    if (error instanceof Problem || error.name === 'AbortError') throw error;
    if (error.message.startsWith(name)) throw new Problem(error.message);
    // Messages of JavaScript's own errors name parts of the program, which tells a reader of the page nothing.
    throw new Problem(error.constructor === Error ? `${name}: the file is damaged (${error.message})` : `${name}: the file is damaged`);
  }
}

// Feeds the decoder and lets the page live meanwhile.
async function feed(decoder, bytes) {
  let begin = performance.now();
  for (const _ of decoder.steps(bytes)) {
    if (performance.now() - begin < 12) continue;
    await new Promise((go) => setTimeout(go));
    begin = performance.now();
  }
}

const isGlb = (bytes) => String.fromCharCode(...bytes.subarray(0, 4)) === 'glTF';
const decoderFor = (bytes, name) => (isGlb(bytes) ? new GlbDecoder(name) : new LpmDecoder(name));

export const readMesh = (bytes, name) => reading(name, async () => {
  const decoder = decoderFor(bytes, name);
  await feed(decoder, bytes);
  if (!decoder.complete) throw new Problem(`${name}: the file ends early`);
  return decoder.mesh();
});

// A progressive mesh as it arrives: `show(mesh)` is called and awaited with what there is, each time half as many vertices
// again or another image have come, at last with all of it. `count(bytes, all)` is called with what has come, `all` is 0
// where the server does not tell.
export async function streamMesh(url, name, {show, count, signal}) {
  const answer = await ask(url, signal), reader = answer.body.getReader();
  const all = answer.headers.has('content-encoding') ? 0 : Number(answer.headers.get('content-length'));  // of what is sent
  let decoder = null, shown = {groups: 0, textures: 0}, come = 0;
  const next = async () => {
    try {
      return await reader.read();
    } catch (error) {
      if (error.name === 'AbortError') throw error;
      throw new Problem(`${name}: the connection broke off`);
    }
  };
  for (let part = await next(); !part.done; part = await next()) {
    decoder ??= decoderFor(part.value, name);
    come += part.value.length;
    count(come, all);
    const mesh = await reading(name, async () => {
      await feed(decoder, part.value);
      const {groups, complete, textures: {length: textures}} = decoder;
      if (!complete && groups < Math.max(1.5 * shown.groups, 1) && textures === shown.textures) return null;
      if (groups === shown.groups && textures === shown.textures) return null;
      shown = {groups, textures};
      return decoder.mesh();
    });
    if (mesh === null) continue;
    await show(mesh);
    await new Promise((go) => setTimeout(go));
  }
  if (!decoder?.complete) throw new Problem(`${name}: the file ends early`);
}
