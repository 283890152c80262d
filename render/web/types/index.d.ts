import type {Box3, Group, PerspectiveCamera, Vector3} from 'three';

export interface LoadOptions {
  /** Error on the screen that levels may have, in pixels; 1 by default. */
  pixels?: number;
  /** Memory for the tiles of a tileset, in MiB; 512 by default. Other files are held as a whole. */
  megabytes?: number;
  /** Called when there is something new to draw though the camera rests. */
  onChange?: () => void;
  /** Called for what fails after the first picture; the default writes its message to the console. */
  onError?: (error: Error) => void;
}

/** A model in the coordinates of its file. */
export interface Model {
  /** To be added to a scene; its position and scale carry the coordinates, its parents may have any similarity. */
  readonly object: Group;
  /** The model's box in its coordinates; it may grow while the model arrives. */
  readonly box: Box3;
  /** The direction that is up in the model's coordinates, of unit length. */
  readonly up: Vector3;
  /** Triangles that are drawn now. */
  readonly triangleCount: number;
  /** What has come of what is on its way, in bytes; `all` is 0 if unknown. Null if nothing is on its way. */
  readonly arrived: {bytes: number; all: number} | null;
  /** As in LoadOptions; may be changed at any time. */
  pixels: number;
  /** From 0, coarsest, to 1, finest; null (the default) follows `pixels` and the camera. */
  level: number | null;
  /**
   * To be called before each frame, with the camera that it is drawn with and the height of the picture in pixels. Returns
   * true if the next frame may differ though the camera rests.
   */
  update(camera: PerspectiveCamera, height: number): boolean;
  /** Ends what is on its way, and gives back all memory, also that of the device. */
  dispose(): void;
}

/**
 * Loads a progressive mesh (`.lpm`, `.glb` of `lodestone progressive`) or a tileset (`tileset.json` or `.3tz` of
 * `lodestone export --tiles --morph`). Resolves when there is something to draw; the rest follows. Rejects with one line that says
 * what is wrong with the file.
 */
export function load(url: string, options?: LoadOptions): Promise<Model>;
