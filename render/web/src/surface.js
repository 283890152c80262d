// The properties of a material other than colour and normals: alpha, sides, emission, unlit.

// From a material of glTF as JSON; source(textureInfo): the number of its image, or null.
export function surfaceOf(json, source) {
  const {extensions = {}} = json;
  return {alphaMode: json.alphaMode ?? 'OPAQUE', alphaCutoff: json.alphaCutoff ?? 0.5, doubleSided: json.doubleSided === true,
          emissive: json.emissiveFactor ?? [0, 0, 0], emissiveMap: source(json.emissiveTexture),
          emissiveStrength: extensions.KHR_materials_emissive_strength?.emissiveStrength ?? 1,
          unlit: extensions.KHR_materials_unlit !== undefined};
}

// True if the picture shows the emissive map.
export const showsEmission = (surface) => surface?.emissiveMap != null && !surface.unlit && surface.emissive.some((x) => x > 0);
