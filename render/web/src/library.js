// What the page computes with, without the page: for tests and other programs.
export {Glb, readProgressiveGlb} from './glb.js';
export {Ladder} from './ladder.js';
export {Levels} from './levels.js';
export {LpmDecoder, crc32} from './lpm.js';
export {boxDistance, loadTileset, makeRadii, selectCells} from './tileset.js';
