// The view in the address: camera and choices, after the #, so that a link shows what its sender saw.

const round = (x) => Number(x.toPrecision(7));

// `view`: {camera: [position, target] | null, level, pixels, look, edges}; what is null or as it is by itself is left out.
export function toHash({camera, level, pixels, look, edges}) {
  const parts = [];
  if (camera) parts.push(`camera=${camera.flat().map(round).join()}`);
  if (pixels !== null) parts.push(`pixels=${pixels}`);
  else if (level !== null) parts.push(`level=${round(level)}`);
  if (look !== 'light') parts.push(`look=${look}`);
  if (edges) parts.push('edges');
  return parts.join('&');
}

// Strange values are as if they were not there.
export function fromHash(hash, looks) {
  const given = new URLSearchParams(hash.replace(/^#/, '')), numbers = (given.get('camera') ?? '').split(',').map(Number);
  const number = (key) => (given.has(key) && given.get(key) !== '' && Number.isFinite(Number(given.get(key))) ? Number(given.get(key)) : null);
  return {camera: numbers.length === 6 && numbers.every(Number.isFinite) ? [numbers.slice(0, 3), numbers.slice(3)] : null,
          level: number('level'), pixels: number('pixels'), look: looks.includes(given.get('look')) ? given.get('look') : 'light', edges: given.has('edges')};
}
