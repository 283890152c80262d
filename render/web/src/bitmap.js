// The texels of an image file as they are stored: not times their alpha, not turned, not converted.
export const bitmapOf = (blob) => createImageBitmap(blob, {imageOrientation: 'none', premultiplyAlpha: 'none', colorSpaceConversion: 'none'});
