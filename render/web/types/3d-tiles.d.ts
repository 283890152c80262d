/**
 * A plugin of 3DTilesRendererJS that morphs the tiles of `lodestone export --tiles --morph`: `tiles.registerPlugin(new
 * MorphPlugin())` before the first `tiles.update()`. `tiles.errorTarget` is the error on the screen in pixels that
 * levels may have; the viewpoint is that of the renderer's first camera, a perspective one.
 */
export class MorphPlugin {
  readonly name: string;
}
