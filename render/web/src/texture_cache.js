// Textures that tiles share: one per file, for as long as a tile uses it.
import * as THREE from 'three';
import {textureBytes} from './tileset.js';

export class TextureCache {
  constructor(request, anisotropy) {
    Object.assign(this, {request, anisotropy});
    this.entries = new Map();
  }

  // Each call wants a giveBack, also when it fails; what failed is asked for anew once all have given it back.
  take(url) {
    if (!this.entries.has(url)) {
      const entry = {users: 0, bytes: 0, texture: null};
      entry.promise = this.fetch(entry, url);
      this.entries.set(url, entry);
    }
    const entry = this.entries.get(url);
    ++entry.users;
    return entry.promise;
  }

  async fetch(entry, url) {
    const bitmap = await createImageBitmap(new Blob([await this.request(url)]), {colorSpaceConversion: 'none'});
    if (entry.users === 0) throw new DOMException('nobody wants it any more', 'AbortError');
    entry.texture = new THREE.Texture(bitmap);
    Object.assign(entry.texture, {flipY: false, colorSpace: THREE.SRGBColorSpace, anisotropy: this.anisotropy,
                                  wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping, needsUpdate: true});
    entry.bytes = textureBytes(bitmap.width * bitmap.height);
    return entry.texture;
  }

  bytesOf(url) { return this.entries.get(url)?.bytes ?? 0; }

  giveBack(url) {
    const entry = this.entries.get(url);
    if (!entry || --entry.users > 0) return;
    entry.texture?.dispose();
    entry.texture?.image.close();
    this.entries.delete(url);
  }
}
