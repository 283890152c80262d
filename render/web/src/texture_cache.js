// Textures that tiles share: one per file, for as long as a tile uses it. Where there is a thumbnail it is drawn until the
// image has come.
import * as THREE from 'three';
import {bitmapOf} from './bitmap.js';
import {wrapping} from './morph_material.js';
import {Problem} from './problem.js';
import {textureBytes} from './tileset.js';

export class TextureCache {
  // `thumbnails`: of a texture's address, that of its thumbnail. `say(error)` is called for an image that cannot be had
  // though its thumbnail could.
  constructor(request, anisotropy, {thumbnails = new Map(), say = () => {}} = {}) {
    Object.assign(this, {request, anisotropy, thumbnails, say, coming: 0});
    this.entries = new Map();
  }

  // Resolves to what can be drawn first. `wrap`: as image() of glb.js has it; `bytes`: of the image in memory, as far as
  // they are known. Each call wants a giveBack, also when it fails; what failed is asked for anew once all have given it
  // back.
  take(url, wrap, bytes = 0) {
    if (!this.entries.has(url)) {
      const entry = {users: 0, bytes, wrap, texture: null};
      entry.promise = this.fetch(entry, url);
      this.entries.set(url, entry);
    }
    const entry = this.entries.get(url);
    ++entry.users;
    return entry.promise;
  }

  async fetch(entry, url) {
    const thumbnail = entry.bytes > 0 ? this.thumbnails.get(url) : undefined;
    const drawn = thumbnail !== undefined && await this.draw(entry, thumbnail).catch(() => null);
    if (drawn) {
      this.replace(entry, url);
    } else {
      const {width, height} = await this.draw(entry, url);
      entry.bytes = textureBytes(width * height);
    }
    return entry.texture;
  }

  async replace(entry, url) {
    ++this.coming;
    await this.draw(entry, url).catch((error) => { if (error.name !== 'AbortError') this.say(error); });
    --this.coming;
  }

  async draw(entry, url) {
    const blob = new Blob([await this.request(url)]);
    const bitmap = await bitmapOf(blob).catch(() => { throw new Problem(`${url}: the image cannot be decoded`); });
    if (entry.users === 0) throw new DOMException('nobody wants it any more', 'AbortError');
    entry.texture?.image.close();
    entry.texture?.dispose();  // the size on the device is another
    entry.texture ??= Object.assign(new THREE.Texture(), {flipY: false, colorSpace: THREE.SRGBColorSpace, anisotropy: this.anisotropy,
                                                          ...wrapping(entry.wrap)});
    Object.assign(entry.texture, {image: bitmap, needsUpdate: true});
    return bitmap;
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
