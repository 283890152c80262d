// Files that the page accepts, and one clear line about files that it cannot read.
import {readProgressiveGlb} from './glb.js';
import {LpmDecoder} from './lpm.js';
import {Problem} from './problem.js';

export async function ask(url, signal) {
  let answer;
  try {
    answer = await fetch(url, {signal});
  } catch (error) {
    if (error.name === 'AbortError') throw error;
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
    throw new Problem(error.message.startsWith(name) ? error.message : `${name}: the file is damaged (${error.message})`);
  }
}

// Feeds the decoder and lets the page live meanwhile; returns whether there is more of the mesh than before.
async function feed(decoder, bytes) {
  const before = decoder.groups + decoder.textures.length;
  let begin = performance.now();
  for (const _ of decoder.steps(bytes)) {
    if (performance.now() - begin < 12) continue;
    await new Promise((go) => setTimeout(go));
    begin = performance.now();
  }
  return decoder.groups + decoder.textures.length > before;
}

const isGlb = (bytes) => String.fromCharCode(...bytes.subarray(0, 4)) === 'glTF';

export const readMesh = (bytes, name) => reading(name, async () => {
  if (isGlb(bytes)) return readProgressiveGlb(bytes, name);
  const decoder = new LpmDecoder(name);
  await feed(decoder, bytes);
  if (!decoder.complete) throw new Problem(`${name}: the file ends early`);
  return decoder.mesh();
});

// A progressive mesh as it arrives: `show(mesh, share)` is called and awaited with what there is, each time half as many
// vertices again have come; at last with all of it and a share of 1.
export async function streamMesh(url, name, show) {
  const reader = (await ask(url)).body.getReader(), decoder = new LpmDecoder(name);
  let head = null, shown = 0;
  const next = async () => {
    try {
      return await reader.read();
    } catch {
      throw new Problem(`${name}: the connection broke off`);
    }
  };
  for (let part = await next(); !part.done; part = await next()) {
    if (head === null && isGlb(part.value)) head = [];  // no prefix of which can be drawn
    if (head !== null) {
      head.push(part.value);
      continue;
    }
    head = null;
    const more = await reading(name, () => feed(decoder, part.value));
    if (!more || (!decoder.complete && decoder.groups < 1.5 * shown)) continue;
    shown = decoder.groups;
    await show(decoder.mesh(), decoder.complete ? 1 : 0.99 * decoder.groups / decoder.header.groups);
    await new Promise((go) => setTimeout(go));
  }
  if (head !== null) await show(await readMesh(new Uint8Array(await new Blob(head).arrayBuffer()), name), 1);
  else if (!decoder.complete) throw new Problem(`${name}: the file ends early`);
}
