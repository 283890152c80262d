// Mip levels of octahedral images without a seam (core/spherical/octahedron): symmetric along each side
// (octahedral_image.h), or atlases of squares with margins (square_atlas.h).

const toLight = Float32Array.from({length: 256}, (_, k) => (k <= 10 ? k / 255 / 12.92 : ((k / 255 + 0.055) / 1.055) ** 2.4));
const toByte = Uint8ClampedArray.from({length: 4097}, (_, k) => 255 * (k <= 12 ? 12.92 * k / 4096 : 1.055 * (k / 4096) ** (1 / 2.4) - 0.055));

// The pairs of texels that mirror each other along the sides of n x n texels, the one that counts first.
function* mirrored(n) {
  const last = n - 1, at = (x, y) => y * n + x;
  for (let i = 1; 2 * i < last; ++i) {
    yield [at(i, 0), at(last - i, 0)];
    yield [at(0, i), at(0, last - i)];
    yield [at(i, last), at(last - i, last)];
    yield [at(last, i), at(last, last - i)];
  }
}
const corners = (n) => [0, n - 1, n * (n - 1), n * n - 1];

// A lossy code has altered both copies of a texel: the first one counts.
function copyBorder(data, n) {
  const copy = (from, to) => data.copyWithin(4 * to, 4 * from, 4 * from + 4);
  for (const [from, to] of mirrored(n)) copy(from, to);
  for (const corner of corners(n)) copy(0, corner);
}

const isPower = (n) => Number.isInteger(n) && n >= 1 && n <= 32768 && (n & (n - 1)) === 0;

// How a file says that the images of a material lie over octahedral squares: true, or the squares of an atlas.
export function isLayout(layout) {
  if (layout == null || layout === true) return true;
  const {side, squares} = layout;
  if (!isPower(side) || !Array.isArray(squares) || squares.length === 0) return false;
  let area = 0, before = side;
  for (const [size, count] of squares) {
    if (!isPower(size) || size > before || !Number.isInteger(count) || count < 0) return false;
    before = size;
    area += size * size * count;
  }
  return area <= side * side;
}

const everySecondBit = (code) => {
  let bits = 0;
  for (let k = 0; code > 0; ++k, code = Math.floor(code / 4)) bits += (code % 2) * 2 ** k;
  return bits;
};

// The squares in an image of n texels along a side, those of at least 8 texels there, along a Morton curve.
function* squaresOf({side, squares}, n) {
  let texels = 0;
  for (const [size, count] of squares)
    for (let k = 0; k < count && size * n / side >= 8; ++k, texels += size * size)
      yield {x: everySecondBit(texels) * n / side, y: everySecondBit(Math.floor(texels / 2)) * n / side, size: size * n / side};
}

// A lossy code has altered the margins of squares: they continue the images within again.
function continueSquares(data, n, layout) {
  const texels = new Uint32Array(data.buffer, data.byteOffset, n * n);
  for (const {x, y, size} of squaresOf(layout, n)) {
    const margin = size >> 3, inner = size - 2 * margin;
    for (let j = 0; j < size; ++j)
      for (let i = 0; i < size; ++i) {
        let [a, b] = [i - margin, j - margin];
        if (a < 0) [a, b] = [-1 - a, inner - 1 - b];
        if (a >= inner) [a, b] = [2 * inner - 1 - a, inner - 1 - b];
        if (b < 0) [a, b] = [inner - 1 - a, -1 - b];
        if (b >= inner) [a, b] = [inner - 1 - a, 2 * inner - 1 - b];
        texels[(y + j) * n + x + i] = texels[(y + b + margin) * n + x + a + margin];
      }
  }
}

// Halving averages texels at the side with ones within, which are not mirrored: the mean of both copies counts.
function averageBorder(values, n) {
  if (n === 1) return;
  for (let c = 0; c < 4; ++c) {
    for (const [a, b] of mirrored(n)) values[4 * a + c] = values[4 * b + c] = (values[4 * a + c] + values[4 * b + c]) / 2;
    const mean = corners(n).reduce((sum, k) => sum + values[4 * k + c], 0) / 4;
    for (const k of corners(n)) values[4 * k + c] = mean;
  }
}

// The sum of four is the same, to the last bit, for a square turned by half a turn, as margins turn it.
function halve(values, n) {
  const half = n >> 1, out = new Float32Array(4 * half * half);
  for (let y = 0, to = 0; y < half; ++y)
    for (let x = 0; x < half; ++x)
      for (let c = 0, from = 4 * (2 * y * n + 2 * x); c < 4; ++c, ++from, ++to)
        out[to] = ((values[from] + values[from + 4]) + (values[from + 4 * n] + values[from + 4 * n + 4])) / 4;
  return out;
}

// Colours as light, other values as vectors; alpha is linear.
function toLinear(data, colours) {
  const values = new Float32Array(data.length);
  for (let k = 0; k < data.length; ++k)
    values[k] = k % 4 === 3 ? data[k] / 255 : colours ? toLight[data[k]] : data[k] / 127.5 - 1;
  return values;
}

function toBytes(values, colours) {
  const out = new Uint8ClampedArray(values.length);
  for (let k = 0; k < values.length; k += 4) {
    const [x, y, z] = [values[k], values[k + 1], values[k + 2]], scale = colours ? 4096 : 1 / (Math.sqrt(x * x + y * y + z * z) || 1);
    for (let c = 0; c < 3; ++c) {
      const v = values[k + c] * scale;
      out[k + c] = colours ? toByte[Math.round(v)] : 127.5 + 127.5 * v;
    }
    out[k + 3] = 255 * values[k + 3];
  }
  return new Uint8Array(out.buffer);
}

// Levels of an image of n x n texels, four bytes each, down to one texel; n is a power of two. `colours`: in sRGB,
// otherwise vectors as bytes.
export function seamlessLevels(data, n, colours, layout) {
  const atlas = layout.squares !== undefined;
  atlas ? continueSquares(data, n, layout) : copyBorder(data, n);
  const levels = [{data: new Uint8Array(data.buffer), width: n, height: n}];
  for (let values = toLinear(data, colours), size = n; size > 1; size >>= 1) {
    values = halve(values, size);
    if (!atlas) averageBorder(values, size >> 1);
    levels.push({data: toBytes(values, colours), width: size >> 1, height: size >> 1});
  }
  return levels;
}
