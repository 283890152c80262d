// The computations of the page without the page, for tests and other programs.
export {Archive} from './archive.js';
export {Tally, chooseFamilies, excess} from './family_choice.js';
export {readMesh, reading} from './files.js';
export {Glb, GlbDecoder, readProgressiveGlb} from './glb.js';
export {Ladder} from './ladder.js';
export {Levels} from './levels.js';
export {LimitTracker, limitedBoxDistance, limitedPointDistance, limitsNear} from './limits.js';
export {LpmDecoder, crc32} from './lpm.js';
export {makeRadii, radiusOf} from './radii.js';
export {Residency} from './residency.js';
export {ResidentTiles} from './resident_tiles.js';
export {FrameLambdas} from './signatures.js';
export {boxDistance, distanceIn, loadTileset, selectCells} from './tileset.js';
