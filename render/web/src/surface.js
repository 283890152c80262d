// The properties of a material other than colour and normals: alpha, sides, emission, unlit, places of maps.

// KHR_texture_transform of a textureInfo: scaled, then turned, then moved. Rows of a matrix for (u, v, 1).
function placeOf(info) {
  const {offset: [x, y] = [0, 0], rotation = 0, scale: [u, v] = [1, 1]} = info?.extensions?.KHR_texture_transform ?? {};
  const c = Math.cos(rotation), s = Math.sin(rotation);
  return [c * u, s * v, x, -s * u, c * v, y, 0, 0, 1];
}

// From a material of glTF as JSON; source(textureInfo): the number of its image, or null.
export function surfaceOf(json, source) {
  const {extensions = {}} = json;
  return {alphaMode: json.alphaMode ?? 'OPAQUE', alphaCutoff: json.alphaCutoff ?? 0.5, doubleSided: json.doubleSided === true,
          emissive: json.emissiveFactor ?? [0, 0, 0], emissiveMap: source(json.emissiveTexture),
          emissivePlace: placeOf(json.emissiveTexture), normalPlace: placeOf(json.normalTexture),
          emissiveStrength: extensions.KHR_materials_emissive_strength?.emissiveStrength ?? 1,
          unlit: extensions.KHR_materials_unlit !== undefined};
}

// True if the picture shows the emissive map.
export const showsEmission = (surface) => surface?.emissiveMap != null && !surface.unlit && surface.emissive.some((x) => x > 0);
