// Normals as three grey images below one another, x, y and z (core/spherical/resample/octahedral_codec.h), as colours.

// Other images are returned as they are.
export function unstacked(image) {
  const n = image.width;
  if (image.height !== 3 * n) return image;
  const pen = new OffscreenCanvas(n, 3 * n).getContext('2d', {willReadFrequently: true});
  pen.drawImage(image, 0, 0);
  const {data} = pen.getImageData(0, 0, n, 3 * n), out = new ImageData(n, n);
  for (let p = 0; p < n * n; ++p) {
    for (let k = 0; k < 3; ++k) out.data[4 * p + k] = data[4 * (k * n * n + p)];
    out.data[4 * p + 3] = 255;
  }
  const canvas = new OffscreenCanvas(n, n);
  canvas.getContext('2d').putImageData(out, 0, 0);
  return canvas;
}
